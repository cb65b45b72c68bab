// BiSS C on the pins of the emulated adapter: edge times against the reference (protocol/biss.md 1 to 3), frames with any
// line delay, registers, streams. All figures are emulated.

import assert from 'node:assert/strict';
import test from 'node:test';
import { BissEncoder, frame } from '../src/biss-encoder.mjs';
import { Client, OP, u16, u32 } from '../src/client.mjs';
import { Control, Registers } from '../src/registers.mjs';

const OK = 0, STUCK_LOW = 2, STUCK_HIGH = 3;
/** Frames of the reference, section 2. */
const FRAMES = [0x000000000fan, 0x0000000007cn, 0x000020000d8n, 0x000018000c2n, 0x024698000cfn, 0x001feabcdf0n, 0x14b4b55552dn, 0x1fffffffff5n];

function bench(options = {}) {
  const client = new Client();
  const encoder = new BissEncoder(client.pico, { word: FRAMES[4], ...options });
  return { client, encoder, nanos: (cycles) => cycles * client.pico.cycleNanos };
}

function configure(client, hz, { data = 35, crc = 6, timeout = 20 } = {}) {
  return client.ask(OP.bissConfig, [...u32(hz), data, crc, ...u16(timeout)]).readUInt32LE(0);
}

function read(client) {
  const body = client.ask(OP.bissRead);
  return { timeUs: Number(body.readBigUInt64LE(0)), status: body[8], raw: body.readBigUInt64LE(9) };
}

// Section 2: MA is high at rest, latches with its first falling edge, and runs until the last bit has arrived. Section 1:
// 80 kHz to 10 MHz. The line delays the last bit, so that clocks follow it.
for (const hz of [80e3, 400e3, 1e6, 2e6, 5e6, 10e6]) {
  test(`frames at ${hz / 1e3} kHz have the edges of the reference, with any delay of the line`, () => {
    for (const delayNanos of [0, 48, 104, 200, 400, 1000]) {
      for (const busyNanos of [5_000, 7_000]) {
        const { client, encoder, nanos } = bench({ delayNanos, busyNanos });
        assert.equal(configure(client, hz), hz);
        for (const word of FRAMES) {
          encoder.word = word;
          encoder.edges.length = 0;
          const { status, raw } = read(client);
          assert.deepEqual([status, raw], [OK, word], `${delayNanos} ns`);
        }
        const { edges } = encoder, half = 1e9 / hz / 2;
        edges.slice(1).forEach(([cycle], at) => assert.ok(Math.abs(nanos(cycle - edges[at][0]) - half) < 1e-3));
        assert.equal(edges[0][1], false);
        assert.equal(edges.at(-1)[1], true, 'high at rest');
        // Start bit, control bit and 41 bits need a rising edge each, the busy time and the acknowledgement some more.
        const rising = edges.length / 2, least = 1 + Math.ceil(busyNanos * hz / 1e9) + 2 + 41;
        const surplus = 3 + Math.ceil(delayNanos * hz / 1e9);
        assert.ok(rising >= least && rising <= least + 1 + surplus, `${rising} clocks for ${least}`);
        assert.ok(encoder.surplus <= surplus, `${encoder.surplus} surplus clocks`);
      }
    }
  });
}

test('the next frame begins after the time-out, and a frame has the time at which it was latched', () => {
  const { client, encoder, nanos } = bench();
  configure(client, 5e6, { timeout: 18 });
  encoder.edges.length = 0;
  const ends = [];
  for (let time = 0; time < 4; time++) {
    const { timeUs } = read(client);
    assert.ok(Math.abs(timeUs - encoder.latched.at(-1) / 1000) < 2);
    ends.push(encoder.edges.length);
  }
  for (const end of ends.slice(0, -1)) assert.ok(nanos(encoder.edges[end][0] - encoder.edges[end - 1][0]) >= 18_000);
});

test('frames of other widths are read', () => {
  for (const [data, crc] of [[1, 0], [19, 6], [26, 6], [31, 1], [48, 16], [58, 6]]) {
    const bits = data + crc, word = 0xa5c3f0e187964b2dn & ((1n << BigInt(bits)) - 1n);
    const { client } = bench({ bits, word, delayNanos: 300 });
    for (const hz of [1e6, 10e6]) {
      configure(client, hz, { data, crc });
      assert.deepEqual([read(client).status, read(client).raw], [OK, word], `${bits} bits`);
    }
  }
});

test('a line that stays at one level is reported, and an encoder is read afterwards', () => {
  for (const [level, status] of [[false, STUCK_LOW], [true, STUCK_HIGH]]) {
    const client = new Client();
    client.pico.mcu.gpio[3].setInputValue(level);
    for (const hz of [80e3, 1e6, 10e6]) {
      configure(client, hz);
      for (let time = 0; time < 3; time++) assert.deepEqual([read(client).status, read(client).raw], [status, 0n]);
    }
    new BissEncoder(client.pico, { word: FRAMES[6] });
    assert.deepEqual([read(client).status, read(client).raw], [OK, FRAMES[6]]);
  }
});

test('registers are read and written, at any clock and delay', () => {
  for (const [hz, delayNanos] of [[80e3, 0], [1e6, 1000], [2e6, 300], [10e6, 1000]]) {
    const registers = new Registers(), control = new Control(registers);
    const { client } = bench({ control, delayNanos });
    configure(client, hz);
    const register = (address) => client.ask(OP.registerRead, [0, address])[0];
    const write = (address, value) => client.ask(OP.registerWrite, [0, address, value])[0];
    for (const [address, value] of [[0x42, 0x61], [0x43, 0x29], [0x66, 0x4b], [0x7e, 0x46], [0x7f, 0x72]]) {
      assert.equal(register(address), value);
    }
    assert.equal(write(0x40, 2), 2);
    assert.equal(register(0x05), 0x1c);
    assert.equal(write(0x6b, 0x2a), 0x2a);
    assert.deepEqual([registers.direct[0x40], registers.direct[0x6b], control.accesses], [2, 0x2a, 8]);
    assert.equal(read(client).raw, FRAMES[4], 'frames are as before');
  }
});

test('a register of an absent encoder or of none is refused, and nothing is written', () => {
  const registers = new Registers(), control = new Control(registers);
  const { client } = bench({ control });
  assert.equal(client.refused(OP.registerRead, [0, 0x66]), 2, 'not configured');
  configure(client, 2e6);
  assert.equal(client.refused(OP.registerWrite, [1, 0x40, 3]), 4);
  assert.equal(client.refused(OP.registerWrite, [0, 0x80, 3]), 2);
  assert.equal(registers.direct[0x40], 0);
  assert.equal(client.ask(OP.registerRead, [0, 0x66])[0], 0x4b, 'the next access works');
  const none = new Client();
  none.pico.mcu.gpio[3].setInputValue(true);
  configure(none, 2e6);
  assert.equal(none.refused(OP.registerRead, [0, 0x66]), 4);
});

test('a damaged answer of a control frame is reported', () => {
  const control = new Control(new Registers()), { cds } = control;
  // The lowest bit of the value is inverted.
  control.cds = function () { return cds.call(this) ^ (this.bits?.length === 27 ? 1 : 0); };
  const { client } = bench({ control });
  configure(client, 2e6);
  assert.equal(client.refused(OP.registerRead, [0, 0x66]), 5);
});

test('streams have every frame at its time', () => {
  let count = 0;
  const word = () => frame(0x1234, count++ % 2 ** 17);
  const { client, encoder } = bench({ word, delayNanos: 200 });
  for (const [hz, period, millis, actual] of [[2e6, 1000, 1000, 1000], [10e6, 100, 300, 100], [10e6, 1, 100, 35]]) {
    configure(client, hz);
    encoder.latched.length = 0;
    count = 0;
    assert.equal(client.ask(OP.bissStream, u32(period)).readUInt32LE(0), actual);
    client.pico.run(millis * 1e6);
    client.ask(OP.bissStream, u32(0));
    let next = 0;
    for (const { first, lost, timeUs, periodUs, values } of client.stream(OP.bissData)) {
      assert.deepEqual([first, lost, periodUs], [next, 0, actual]);
      values.forEach(({ status, raw }, at) => {
        assert.deepEqual([status, raw], [OK, frame(0x1234, next + at)]);
        assert.ok(Math.abs(encoder.latched[next + at] / 1000 - timeUs - at * periodUs) <= 1);
      });
      next += values.length;
    }
    assert.ok(next >= millis * 1000 / actual - 200, `${next} frames`);
  }
});

test('SSI and BiSS take turns', () => {
  const { client } = bench();
  configure(client, 2e6);
  client.configureSsi(25, 1e6, 40);
  for (let time = 0; time < 3; time++) {
    client.readSsi();
    assert.equal(read(client).raw, FRAMES[4]);
  }
});
