// The supply of the encoder, the parts of a build, and restarts of the emulated adapter. All figures are emulated.

import assert from 'node:assert/strict';
import test from 'node:test';
import { Client, OP, u16, u32 } from '../src/client.mjs';
import { SineCosine } from '../src/sine-cosine.mjs';

const ENABLE = 14, FAULT = 15, DRIVER = 4, SUPPLIED = 1 << 6;

/** The voltage before the switch, behind a divider by six. */
function bench(volts) {
  const client = new Client(), source = new SineCosine(client.pico, { hz: 1000, inputs: [volts / 6, 0, 0] });
  const supply = (on, millivolt) => client.ask(OP.supply, [on ? 1 : 0, ...u16(millivolt)]);
  return { client, source, supply, enable: () => client.pico.mcu.gpio[ENABLE].value };
}

test('the supply is off from the start on, and on for a request with the connected voltage', () => {
  const { client, supply, enable } = bench(8.1);
  assert.equal(enable(), 0);
  const reply = supply(true, 8000);
  assert.equal(enable(), 1);
  assert.ok(Math.abs(reply.readUInt16LE(1) - 8100) <= 5, `${reply.readUInt16LE(1)} mV`);
  assert.ok(client.ask(OP.hello).readUInt32LE(1) & SUPPLIED);
  client.host.open(false);
  client.pico.run(100e6);
  assert.equal(enable(), 1, 'the end of a host does not switch it off');
  client.host.open(true);
  client.pico.run(20e6);
  supply(false, 0);
  assert.equal(enable(), 0);
  assert.equal(client.ask(OP.hello).readUInt32LE(1) & SUPPLIED, 0);
});

test('another voltage is refused before the switch is on', () => {
  for (const [volts, millivolt] of [[12, 5000], [5, 8000], [0, 8000], [18, 15000]]) {
    const { client, enable } = bench(volts), states = [];
    client.pico.mcu.gpio[ENABLE].addListener((value) => states.push(value));
    assert.equal(client.refused(OP.supply, [1, ...u16(millivolt)]), 2);
    assert.deepEqual([enable(), states], [0, []]);
  }
});

test('the voltage is measured while sine and cosine stream', () => {
  const { client, supply } = bench(5.0);
  client.ask(OP.analogConfig, u32(100e3));
  client.ask(OP.analogStream, [1]);
  client.pico.run(20e6);
  const status = client.ask(OP.status);
  assert.ok(Math.abs(status.readUInt16LE(10) - 5000) <= 5, `${status.readUInt16LE(10)} mV`);
  assert.ok(Math.abs(supply(true, 5000).readUInt16LE(1) - 5000) <= 5);
  client.ask(OP.analogStream, [0]);
});

test('an overload switches the supply off and is told', () => {
  const { client, supply, enable } = bench(8.0);
  supply(true, 8000);
  client.pico.mcu.gpio[FAULT].setInputValue(false);
  client.pico.run(150e6);
  assert.equal(enable(), 0);
  client.pico.mcu.gpio[FAULT].setInputValue(true);
  client.pico.run(150e6);
  assert.equal(enable(), 0);
  assert.equal(client.ask(OP.status)[9], 1);
});

test('a build announces only its parts and refuses the others', () => {
  const capabilities = (parts) => { const client = new Client({ parts }); return [client, client.ask(OP.hello).readUInt32LE(1)]; };
  const [digital, word] = capabilities([]);
  assert.equal(word, 0b1_0000_0111);
  for (const [op, body] of [[OP.supply, [1, ...u16(8000)]], [OP.analogConfig, u32(1000)], [OP.analogSkew, []], [OP.uartConfig, [...u32(9600), 2, 0, 0]]]) {
    assert.equal(digital.refused(op, body), 1);
  }
  assert.equal(capabilities(['serial', 'supply'])[1], 0b1_0011_0111);
  assert.equal(capabilities(['analogue'])[1], 0b1_1000_1111);
});

test('the driver of the clock is enabled with the clock high', () => {
  const client = new Client();
  assert.deepEqual([client.pico.mcu.gpio[DRIVER].value, client.pico.mcu.gpio[2].value], [1, 1]);
});
