// SSI on the pins of the emulated adapter: edge times against the reference (protocol/ssi.md 1), words, streams. All
// figures are emulated.

import assert from 'node:assert/strict';
import test from 'node:test';
import { Client, OP, u32 } from '../src/client.mjs';
import { SsiEncoder } from '../src/ssi-encoder.mjs';

const microseconds = (nanos) => BigInt(Math.floor(nanos / 1000)) & 0x1ffffffn;

function bench(options = {}) {
  const client = new Client();
  const encoder = new SsiEncoder(client.pico, { bits: 25, word: 0x0b4b234n, ...options });
  return { client, encoder, nanos: (cycles) => cycles * client.pico.cycleNanos };
}

test('the adapter is identified over USB and by HELLO', () => {
  const { client } = bench();
  assert.deepEqual(client.host.texts, { manufacturer: 'encoder-studio.example', product: 'Encoder adapter', serial: client.host.texts.serial });
  assert.deepEqual(client.host.id, [0x16c0, 0x27dd]);
  assert.equal(client.pico.mcu.clkSys, 120e6);
  const hello = client.ask(OP.hello);
  assert.equal(hello[0], 1);
  assert.equal(hello.readUInt32LE(1) & 7, 7, 'SSI, BiSS and registers');
  const name = hello.subarray(14, 14 + hello[13]).toString();
  assert.equal(name, 'Encoder adapter');
});

// Section 1: clock high at rest, n falling and n rising edges, the value is latched at the first falling edge, a burst of
// n / f. A word of 25 bits takes 62.5 µs at 400 kHz, 25 µs at 1 MHz and 16.67 µs at 1.5 MHz; 33 bits take 82.5 µs at 400 kHz.
for (const [clocks, hz, burstMicros] of [
  [25, 400e3, 62.5], [25, 1e6, 25], [25, 1.5e6, 16.667], [33, 400e3, 82.5], [1, 50e3, 20], [25, 100e3, 250], [13, 2e6, 6.5], [64, 4e6, 16],
]) {
  test(`${clocks} clocks at ${hz / 1e3} kHz have the edges of the reference`, () => {
    const { client, encoder, nanos } = bench({ bits: clocks, word: (1n << BigInt(clocks)) - 1n });
    assert.equal(client.configureSsi(clocks, hz), hz);
    assert.equal(client.pico.mcu.gpio[2].value, 1, 'high at rest');
    encoder.edges.length = 0;
    assert.equal(client.readSsi().raw, (1n << BigInt(clocks)) - 1n);
    const { edges } = encoder;
    assert.equal(edges.length, 2 * clocks);
    assert.ok(edges.every(([, level], at) => level === (at % 2 === 1)), 'falling and rising in turn');
    const half = 1e9 / hz / 2;
    edges.slice(1).forEach(([cycle], at) => assert.ok(Math.abs(nanos(cycle - edges[at][0]) - half) < 1e-3));
    const burst = nanos(edges.at(-1)[0] - edges[0][0]) + half;
    assert.ok(Math.abs(burst / 1000 - burstMicros) < 0.001, `${burst} ns`);
  });
}

test('words of every length and clock are right', () => {
  for (const [clocks, word] of [
    [1, 1n], [13, 0x1abcn], [24, 0xfffffen], [25, 0x0b4b234n], [31, 0x091a2b40n], [32, 0xa5a55a5an], [33, 0x0b4b55e68n], [64, 0x8123456789abcdefn],
  ]) {
    const { client } = bench({ bits: clocks, word, delayNanos: 100 });
    for (const hz of [50e3, 400e3, 1e6, 1.5e6, 2e6]) {
      client.configureSsi(clocks, hz);
      for (let time = 0; time < 3; time++) assert.equal(client.readSsi().raw, word, `${clocks} clocks at ${hz} Hz`);
    }
  }
});

// The reference has a delay of less than half a clock from the rising edge to the bit. Bits are sampled half a clock after
// that edge, so that any shorter delay is right. The synchroniser of the pin delays the level by 17 ns.
test('a bit is sampled half a clock after its rising edge', () => {
  for (const hz of [1e6, 2e6, 4e6]) {
    const half = 1e9 / hz / 2;
    for (const [delayNanos, right] of [[0, true], [half - 30, true], [half + 10, false]]) {
      const { client } = bench({ delayNanos });
      client.configureSsi(25, hz);
      assert.equal(client.readSsi().raw === 0x0b4b234n, right, `${delayNanos} ns at ${hz} Hz`);
    }
  }
});

test('a word is followed by its pause, and has the time of its first edge', () => {
  const { client, encoder, nanos } = bench({ word: microseconds });
  for (const [hz, pause] of [[1e6, 30], [400e3, 500]]) {
    client.configureSsi(25, hz, pause);
    encoder.edges.length = 0;
    encoder.latched.length = 0;
    for (let time = 0; time < 5; time++) {
      const { timeUs, raw } = client.readSsi();
      assert.ok(Math.abs(timeUs - encoder.latched.at(-1) / 1000) < 2);
      assert.ok(Math.abs(timeUs - Number(raw)) <= 2);
    }
    for (let word = 1; word < 5; word++) {
      const gap = nanos(encoder.edges[50 * word][0] - encoder.edges[50 * word - 1][0]) / 1000;
      assert.ok(gap >= pause, `${gap} µs`);
    }
  }
});

function stream(client, periodUs, millis) {
  const actual = client.ask(OP.ssiStream, u32(periodUs)).readUInt32LE(0);
  client.pico.run(millis * 1e6);
  client.ask(OP.ssiStream, u32(0));
  return { actual, packets: client.stream(OP.ssiData) };
}

/** Checks that a stream has no gap and that each word was latched at its time. Returns the number of words. */
function check({ actual, packets }, encoder) {
  let next = 0;
  for (const { first, lost, timeUs, periodUs, values } of packets) {
    assert.deepEqual([first, lost, periodUs], [next, 0, actual]);
    values.forEach((value, at) => {
      const time = timeUs + at * periodUs;
      assert.ok(Math.abs(Number(value) - time) <= 1, `word ${first + at} at ${time}: ${value}`);
    });
    next += values.length;
  }
  // The hardware paces: distances are exact to the cycle.
  const distances = encoder.latched.slice(1).map((time, at) => time - encoder.latched[at]);
  assert.ok(distances.every((distance) => Math.abs(distance - actual * 1000) < 0.1));
  return next;
}

test('a stream at 1 kHz has every word at its time', () => {
  const { client, encoder } = bench({ word: microseconds });
  client.configureSsi(25, 1e6);
  const result = stream(client, 1000, 2000);
  assert.equal(result.actual, 1000);
  assert.ok(check(result, encoder) > 1980);
});

test('a stream at 20 kHz has every word at its time', () => {
  const { client, encoder } = bench({ word: microseconds });
  client.configureSsi(25, 2e6, 25);
  const result = stream(client, 50, 500);
  assert.equal(result.actual, 50);
  assert.ok(check(result, encoder) > 9900);
});

test('an interval that is too short is lengthened to a burst and its pause', () => {
  const { client, encoder } = bench({ word: microseconds });
  client.configureSsi(25, 4e6, 20);
  const result = stream(client, 1, 100);
  // 25 clocks at 4 MHz take 6.25 µs.
  assert.equal(result.actual, 29);
  assert.ok(check(result, encoder) > 3300);
});

test('a host that does not fetch loses words and learns how many; a word is right where its index says', () => {
  const { client } = bench({ word: microseconds });
  client.configureSsi(25, 2e6, 25);
  client.ask(OP.ssiStream, u32(50));
  client.pico.run(50e6);
  const { onData } = client.host;
  client.host.fetch(null);
  client.pico.run(1200e6);
  client.host.fetch(onData);
  client.pico.run(100e6);
  client.ask(OP.ssiStream, u32(0));
  let next = 0, lost = 0;
  for (const packet of client.stream(OP.ssiData)) {
    assert.equal(packet.first - next, packet.lost);
    lost += packet.lost;
    packet.values.forEach((value, at) => assert.ok(Math.abs(Number(value) - packet.timeUs - 50 * at) <= 1));
    next = packet.first + packet.values.length;
  }
  assert.ok(lost > 10_000 && next > 26_000, `${lost} lost of ${next}`);
});

test('a stream ends with its host', () => {
  // The port is closed.
  const closed = bench();
  closed.client.configureSsi(25, 1e6);
  closed.client.ask(OP.ssiStream, u32(1000));
  closed.client.pico.run(20e6);
  closed.client.host.open(false);
  closed.client.pico.run(20e6);
  const edges = closed.encoder.edges.length;
  closed.client.pico.run(50e6);
  assert.equal(closed.encoder.edges.length, edges);
  closed.client.host.open(true);
  closed.client.pico.run(20e6);
  closed.client.receiver.rest = [];
  assert.equal(closed.client.readSsi().raw, 0x0b4b234n, 'it works for the next host');
  // The port stays open, and nothing is fetched for two seconds.
  const stuck = bench();
  stuck.client.configureSsi(25, 1e6);
  stuck.client.ask(OP.ssiStream, u32(1000));
  stuck.client.pico.run(20e6);
  stuck.client.host.fetch(null);
  stuck.client.pico.run(2600e6);
  const after = stuck.encoder.edges.length;
  stuck.client.pico.run(50e6);
  assert.equal(stuck.encoder.edges.length, after);
});

test('invalid requests are refused, and the adapter goes on', () => {
  const { client } = bench();
  assert.equal(client.refused(OP.ssiRead), 2, 'not configured');
  assert.equal(client.refused(OP.ssiConfig, [0, ...u32(1e6), 30, 0, 1]), 2);
  assert.equal(client.refused(OP.ssiConfig, [25, ...u32(1000), 30, 0, 1]), 2);
  assert.equal(client.refused(0x50), 1);
  client.configureSsi(25, 1e6);
  client.ask(OP.ssiStream, u32(1000));
  assert.equal(client.refused(OP.ssiRead), 3, 'a stream is running');
  client.ask(OP.hello);
  assert.equal(client.readSsi().raw, 0x0b4b234n);
});
