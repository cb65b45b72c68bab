#!/usr/bin/env node
// Serves the emulated adapter on a TCP port, in real time:
//
//   serve.mjs FILE.uf2 --ssi BITS[:gray[:APPENDED]]     an SSI encoder. Its position counts the frames that were read;
//                                                       APPENDED is the number of zero bits after it
//   serve.mjs FILE.uf2 --biss                           a BiSS kit encoder. Its steps count the frames
//   --sine HZ,SINE,COSINE,OFFSET,OFFSET                sine and cosine: frequency, amplitudes and offsets in volts
//   --start NUMBER                                      position of the first frame
//   --still                                             the BiSS encoder is at rest: its position stays the same
//   --delay NANOSECONDS                                 delay of the line
//
// Prints "ready tcp:HOST:PORT" and serves one client at a time until it is terminated or its standard input ends.

import net from 'node:net';
import { parseArgs } from 'node:util';
import { BissEncoder, frame } from './biss-encoder.mjs';
import { connectBoard } from './board.mjs';
import { Pico } from './pico.mjs';
import { Control, Registers } from './registers.mjs';
import { SineCosine } from './sine-cosine.mjs';
import { SsiEncoder } from './ssi-encoder.mjs';
import { UsbHost } from './usb-host.mjs';

const string = (value) => ({ type: 'string', default: value });
const { values: options, positionals: [file] } = parseArgs({
  allowPositionals: true,
  options: {
    ssi: string(), biss: { type: 'boolean' }, sine: string(), start: string('0'), still: { type: 'boolean' },
    delay: string('100'),
  },
});

const pico = new Pico(file), host = new UsbHost(pico);
connectBoard(pico);
const delayNanos = Number(options.delay);
let position = BigInt(options.start);
if (options.ssi) {
  const [digits, code, appended] = options.ssi.split(':'), bits = Number(digits), zeros = BigInt(appended ?? 0);
  const word = () => {
    const value = position++ & ((1n << BigInt(bits)) - 1n);
    return (code === 'gray' ? value ^ (value >> 1n) : value) << zeros;
  };
  new SsiEncoder(pico, { bits: bits + Number(zeros), word, delayNanos });
}
if (options.biss) {
  const word = () => {
    const value = Number(position & 0x1ffffffffn);
    if (!options.still) position++;
    return frame(Math.floor(value / 2 ** 17), value % 2 ** 17);
  };
  new BissEncoder(pico, { word, delayNanos, control: new Control(new Registers()) });
}
if (options.sine) {
  const [hz, sine, cosine, sineOffset, cosineOffset] = options.sine.split(',').map(Number);
  new SineCosine(pico, { hz, sine, cosine, sineOffset, cosineOffset });
}
while (!host.isReady) {
  if (pico.nanos > 200e6) throw new Error('the adapter was not enumerated');
  pico.run(1e6);
}

let client = null;
const send = (bytes) => client?.write(bytes);
const server = net.createServer((socket) => {
  client?.destroy();
  client = socket;
  socket.setNoDelay(true);
  socket.on('data', (bytes) => host.send(bytes));
  socket.on('error', () => {});
  socket.on('close', () => {
    if (client !== socket) return;
    client = null;
    host.open(false);
  });
  host.open(true);
  host.fetch(send);
});
server.listen(0, '127.0.0.1', () => console.log(`ready tcp:127.0.0.1:${server.address().port}`));
process.stdin.on('end', () => process.exit()).resume();

/** Virtual and real time of the last moment at which both were equal. */
let virtual = pico.clock.nanos, real = performance.now();

function run() {
  const ahead = (pico.clock.nanos - virtual) / 1e6 - (performance.now() - real);
  if (ahead > 1) {
    setTimeout(run, Math.min(5, ahead));
    return;
  }
  // A computer that is too slow does not catch up.
  if (ahead < -50) {
    virtual = pico.clock.nanos;
    real = performance.now();
  }
  pico.run(1e6, 10);
  setImmediate(run);
}
run();
