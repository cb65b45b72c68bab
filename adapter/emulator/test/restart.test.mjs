// Restarts of the emulated adapter, and what keeps it running. All figures are emulated.

import assert from 'node:assert/strict';
import test from 'node:test';
import { connectBoard } from '../src/board.mjs';
import { Client, OP, u32 } from '../src/client.mjs';
import { Pico } from '../src/pico.mjs';
import { UsbHost } from '../src/usb-host.mjs';

const RESTART = 8, POWER = 1, WATCHDOG = 3;

test('a processor that hangs is restarted after two seconds', () => {
  const client = new Client(), { pico } = client, { core } = pico.mcu;
  assert.equal(client.ask(OP.status)[RESTART], POWER);
  // It sleeps without an interrupt that could wake it: WFI, and a jump back to it.
  pico.mcu.writeUint16(0x2003f000, 0xbf30);
  pico.mcu.writeUint16(0x2003f002, 0xe7fd);
  core.enabledInterrupts = 0;
  core.PC = 0x2003f000;
  const hung = pico.nanos;
  assert.throws(() => pico.run(2500e6), /watchdog/);
  const took = pico.nanos - hung;
  assert.ok(took > 1800e6 && took < 2100e6, `${took / 1e6} ms`);
});

test('the reason for a restart is told', () => {
  const client = Object.create(Client.prototype);
  const pico = new Pico();
  // What the chip keeps during a restart by the watchdog: the timer has expired.
  pico.mcu.peripherals[0x40058].reason = 1;
  pico.load(process.env.ADAPTER_UF2);
  connectBoard(pico);
  Object.assign(client, new Client(), { pico, host: new UsbHost(pico), seq: 0 });
  client.host.fetch((bytes) => client.receiver.push(bytes));
  client.until(() => client.host.isReady, 'no enumeration', 100e6);
  assert.equal(client.ask(OP.status)[RESTART], WATCHDOG);
});

test('neither silence nor the slowest transfer lets the watchdog restart it', () => {
  const client = new Client();
  client.pico.mcu.gpio[9].setInputValue(true);
  client.pico.run(10e9);
  client.configureUart(300);
  // A hundred characters take 3.7 s, and the time-out two seconds more.
  const body = client.ask(OP.uartTransfer, [...u32(2e6), ...u32(5e5), ...Array(100).fill(0x55)], 10e9);
  assert.equal(body.length, 8);
  assert.ok(client.pico.nanos > 15e9);
  assert.equal(client.ask(OP.status)[RESTART], POWER);
});

test('damaged and malformed packets are counted', () => {
  const client = new Client();
  assert.equal(client.refused(0x50), 1);
  assert.equal(client.refused(OP.ssiConfig, [1, 2, 3]), 2);
  client.host.send([1, 2, 3, 4, 5, 0]);
  client.pico.run(5e6);
  const status = client.ask(OP.status);
  assert.deepEqual([status.readUInt32LE(12), status.readUInt32LE(16)], [1, 2]);
});
