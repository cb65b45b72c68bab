// The serial line on the pins of the emulated adapter: HIPERFACE (protocol/hiperface.md 1 to 3) and UBICOM (ubicom.md). All
// figures are emulated.

import assert from 'node:assert/strict';
import test from 'node:test';
import { Client, OP, u32 } from '../src/client.mjs';
import { SerialDevice } from '../src/serial-device.mjs';
import { SineCosine } from '../src/sine-cosine.mjs';

/** HIPERFACE: a position is read with 42h; the checksum is the exclusive or of the bytes. */
const REQUEST = [0x40, 0x42, 0x02], REPLY = [0x40, 0x42, 0x00, 0x0e, 0x05, 0x31, 0x38];
const hiperface = (bytes) => (String(bytes) === String(REQUEST) ? REPLY : []);

for (const baud of [600, 1200, 2400, 4800, 9600, 19200, 38400]) {
  test(`a HIPERFACE position at ${baud} baud, 8E1`, () => {
    const client = new Client(), scale = 9600 / baud;
    const device = new SerialDevice(client.pico, { baud, reply: hiperface, delayNanos: 3e6 * scale, silenceNanos: 4.6e6 * scale });
    assert.equal(client.configureUart(baud), baud);
    const idle = 5_000 * scale;
    const { timeUs, rx } = client.transfer(REQUEST, 200_000, Math.round(idle));
    assert.deepEqual(rx, REPLY);
    assert.equal(device.errors, 0);
    assert.deepEqual(device.heard.map(([, byte]) => byte), REQUEST);
    // A bit has eight cycles; the time of the first start edge is known to a half of one.
    const [[on, high], [off, low]] = device.direction.slice(-2), bit = 1e9 / baud;
    assert.ok(Math.abs(timeUs - device.replied / 1000) < bit / 16 / 1000 + 1.5, `${timeUs} µs for ${device.replied} ns`);
    // The driver is on from the start bit to the end of the last stop bit: three characters of 11 bits, with less than a bit
    // between them.
    assert.deepEqual([high, low], [1, 0]);
    assert.ok(Math.abs(on - device.heard[0][0]) < bit / 4);
    assert.ok(off - on >= 33 * bit * 0.999 && off - on < 35 * bit, `${(off - on) / bit} bits`);
    // Edges are at whole bits from the start edge of their character.
    const character = device.edges.filter(([time]) => time >= device.heard[0][0] && time < device.heard[0][0] + 10.9 * bit);
    for (const [time] of character) {
      const place = (time - device.heard[0][0]) / bit;
      assert.ok(Math.abs(place - Math.round(place)) < 0.01, `an edge at ${place} bits`);
    }
  });
}

test('UBICOM at 115200 baud, 8N1', () => {
  // Read of the temperature, protocol/ubicom.md 6.
  const request = [0x80, 0x01, 0x01, 0x02, 0x00, 0x26, 0x00, 0x55], reply = [0x80, 0x01, 0x01, 0x01, 0x00, 0x4b, 0x31];
  const client = new Client();
  const device = new SerialDevice(client.pico, { baud: 115200, parity: 'none', reply: () => reply, delayNanos: 1e5, silenceNanos: 2e5 });
  client.configureUart(115200, 0);
  for (let time = 0; time < 5; time++) assert.deepEqual(client.transfer(request, 100_000, 2_000).rx, reply);
  assert.equal(device.errors, 0);
});

test('every byte value is sent and received, with each parity', () => {
  for (const [code, parity] of [[0, 'none'], [1, 'odd'], [2, 'even']]) {
    const client = new Client();
    const device = new SerialDevice(client.pico, { baud: 38400, parity, reply: (bytes) => bytes.map((byte) => byte ^ 0xff), delayNanos: 2e5, silenceNanos: 5e5 });
    client.configureUart(38400, code);
    const all = Array.from({ length: 256 }, (_, byte) => byte);
    assert.deepEqual(client.transfer(all, 100_000, 2_000).rx, all.map((byte) => byte ^ 0xff));
    assert.equal(device.errors, 0, parity);
  }
});

test('without a device the time-out ends the wait, and the next transfer works', () => {
  const client = new Client();
  client.pico.mcu.gpio[9].setInputValue(true);
  client.configureUart(9600);
  const start = client.pico.nanos;
  assert.deepEqual(client.transfer(REQUEST, 40_000, 5_000).rx, []);
  const took = (client.pico.nanos - start) / 1e6;
  assert.ok(took > 43 && took < 46, `${took} ms`);
  new SerialDevice(client.pico, { reply: hiperface });
  assert.deepEqual(client.transfer(REQUEST).rx, REPLY);
  assert.equal(client.refused(OP.uartTransfer, [...u32(3e6), ...u32(1), 1]), 2);
});

test('sine and cosine stream without a loss during a transfer', () => {
  const client = new Client();
  new SineCosine(client.pico, { hz: 1000 });
  new SerialDevice(client.pico, { reply: hiperface });
  client.configureUart(9600);
  client.ask(OP.analogConfig, u32(100e3));
  client.ask(OP.analogStream, [1]);
  for (let time = 0; time < 5; time++) assert.deepEqual(client.transfer(REQUEST).rx, REPLY);
  client.ask(OP.analogStream, [0]);
  let next = 0;
  for (const { first, lost, values } of client.stream(OP.analogData)) {
    assert.deepEqual([first, lost], [next, 0]);
    next += values.length;
  }
  assert.ok(next > 10_000, `${next} samples`);
});
