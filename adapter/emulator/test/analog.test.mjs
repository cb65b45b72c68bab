// Sine and cosine at the inputs of the emulated adapter. Nothing analogue is modelled, so these tests show the order and
// the times of the conversions, the arithmetic, and that nothing is lost. All figures are emulated.

import assert from 'node:assert/strict';
import test from 'node:test';
import { Client, OP, u32 } from '../src/client.mjs';
import { SineCosine } from '../src/sine-cosine.mjs';
import { SsiEncoder } from '../src/ssi-encoder.mjs';

/** A step of the converter, whose reference is 3.3 V behind an amplifier of 2.2. */
const STEP_V = 3.3 / 4096 / 2.2;

function capture(client, hz, millis) {
  const config = client.ask(OP.analogConfig, u32(hz)), actual = config.readUInt32LE(0), fullScale = config.readUInt32LE(4) * 1e-6;
  assert.equal(config[8], 12, 'bits');
  client.ask(OP.analogStream, [1]);
  client.pico.run(millis * 1e6);
  client.ask(OP.analogStream, [0]);
  let next = 0;
  const samples = [];
  for (const { first, lost, timeUs, values } of client.stream(OP.analogData)) {
    assert.deepEqual([first, lost], [next, 0]);
    values.forEach(([sine, cosine], at) => samples.push({ time: (timeUs + at * 1e6 / actual) * 1e-6, sine: sine / 32767 * fullScale, cosine: cosine / 32767 * fullScale }));
    next += values.length;
  }
  return { actual, samples };
}

test('inputs are converted in turn, 2 µs each, and a pair is back to back', () => {
  const client = new Client(), source = new SineCosine(client.pico, { hz: 1000 });
  source.conversions = [];
  capture(client, 100e3, 5);
  const { conversions } = source;
  assert.ok(conversions.length > 2400);
  conversions.slice(0, 2400).forEach(([time, input], at) => {
    assert.equal(input, at % 5);
    if (at) assert.ok(Math.abs(time - conversions[at - 1][0] - 2000) < 10);
  });
  assert.equal(client.ask(OP.analogSkew).readUInt16LE(0), 2000);
});

for (const [hz, actual, frequency] of [[100e3, 100e3, 1000], [100e3, 100e3, 20e3], [30e3, 25e3, 1000], [1e3, 1e3, 10]]) {
  test(`samples at ${actual / 1e3} kHz of ${frequency} Hz have their values at their times, and none is lost`, () => {
    const client = new Client();
    const signal = { hz: frequency, sine: 0.5, cosine: 0.45, sineOffset: 0.02, cosineOffset: -0.03 };
    new SineCosine(client.pico, signal);
    const result = capture(client, hz, 300);
    assert.equal(result.actual, actual);
    assert.ok(result.samples.length >= 0.27 * actual, `${result.samples.length} samples`);
    // The time of the first conversion is known to a microsecond; the phase shows the rest, which is the same for all.
    const angle = (time) => 2 * Math.PI * frequency * time;
    const errors = (late) => Math.max(...result.samples.map(({ time, sine, cosine }) => Math.max(
      Math.abs(sine - signal.sineOffset - signal.sine * Math.sin(angle(time + late))),
      Math.abs(cosine - signal.cosineOffset - signal.cosine * Math.cos(angle(time + late + 2e-6))))));
    const least = Math.min(...Array.from({ length: 301 }, (_, at) => errors((at - 150) * 1e-8)));
    // Half a step of the converter, and 5 ns of the phase.
    assert.ok(least <= 0.51 * STEP_V + 2 * Math.PI * frequency * 0.5 * 6e-9, `${least} V`);
  });
}

test('values beyond the range are limited', () => {
  const client = new Client();
  new SineCosine(client.pico, { hz: 1000, sine: 2, cosine: 2 });
  const { samples } = capture(client, 100e3, 20);
  const sines = samples.map(({ sine }) => sine);
  assert.ok(Math.abs(Math.max(...sines) - 0.75) < 0.001 && Math.abs(Math.min(...sines) + 0.75) < 0.001);
});

test('sine, cosine and SSI stream at the same time', () => {
  const client = new Client();
  new SineCosine(client.pico, { hz: 1000 });
  new SsiEncoder(client.pico, { bits: 25, word: (nanos) => BigInt(Math.floor(nanos / 1000)) & 0x1ffffffn });
  client.configureSsi(25, 2e6, 25);
  client.ask(OP.ssiStream, u32(500));
  const { samples } = capture(client, 50e3, 200);
  client.ask(OP.ssiStream, u32(0));
  assert.ok(samples.length > 9000);
  let next = 0;
  for (const { first, lost, timeUs, values } of client.stream(OP.ssiData)) {
    assert.deepEqual([first, lost], [next, 0]);
    values.forEach((value, at) => assert.ok(Math.abs(Number(value) - timeUs - 500 * at) <= 1));
    next += values.length;
  }
  assert.ok(next > 350);
});

test('a late host loses samples and learns how many', () => {
  const client = new Client();
  new SineCosine(client.pico, { hz: 1000 });
  client.ask(OP.analogConfig, u32(100e3));
  client.ask(OP.analogStream, [1]);
  client.pico.run(20e6);
  const { onData } = client.host;
  client.host.fetch(null);
  client.pico.run(300e6);
  client.host.fetch(onData);
  client.pico.run(100e6);
  client.ask(OP.analogStream, [0]);
  let next = 0, lost = 0;
  for (const packet of client.stream(OP.analogData)) {
    assert.equal(packet.first - next, packet.lost);
    lost += packet.lost;
    next = packet.first + packet.values.length;
  }
  assert.ok(lost > 10_000, `${lost} lost`);
  assert.equal(client.ask(OP.status).readUInt32LE(20), lost);
  assert.equal(client.refused(OP.analogConfig, u32(5)), 2);
});
