// The corrections of rp2040js by themselves, without the firmware. Expected values follow the data sheet of the RP2040: the
// section is named at each test. Instructions of the state machines are assembled by hand from its section 3.4.

import assert from 'node:assert/strict';
import test from 'node:test';
import { RP2040 } from 'rp2040js';
import { correctConverter, correctDma, correctSleep } from '../src/corrections.mjs';
import { Pico, readUf2 } from '../src/pico.mjs';

const PIO0 = 0x50200000, CTRL = 0x000, TXF0 = 0x010, IRQ = 0x030, IRQ_FORCE = 0x034, MEMORY = 0x048, CLKDIV = 0x0c8,
  EXECCTRL = 0x0cc, SHIFTCTRL = 0x0d0, ADDR = 0x0d4, INSTR = 0x0d8, PINCTRL = 0x0dc, NEXT = 0x18;
const SET_PINS = 0xe000, SET_PINDIRS = 0xe080, JMP = 0x0000, WAIT_1_PIN = 0x20a0, WAIT_1_IRQ = 0x20c0, IRQ_SET = 0xc000,
  PULL_BLOCK = 0x80a0, JMP_PIN = 0x00c0, delay = (cycles) => cycles << 8;

/** Loads a program into PIO 0 and starts machines that use pin 2 for SET and pin 3 for IN. Records the edges of pin 2. */
function start(program, { divisor = [1, 0], machines = 1, starts = [0, 0] } = {}) {
  const pico = new Pico(), { mcu } = pico;
  const write = (offset, value) => mcu.writeUint32(PIO0 + offset, value);
  mcu.gpio[2].ctrl = 6;
  mcu.gpio[2].padValue = 0x40;
  mcu.gpio[3].padValue = 0x40;
  const edges = [];
  mcu.gpio[2].addListener((value) => { if (value <= 1) edges.push([pico.cycles, value]); });
  program.forEach((instruction, at) => write(MEMORY + 4 * at, instruction));
  for (let machine = 0; machine < machines; machine++) {
    const at = NEXT * machine;
    write(CLKDIV + at, ((divisor[0] << 16) | (divisor[1] << 8)) >>> 0);
    write(EXECCTRL + at, (3 << 24) | ((program.length - 1) << 12));
    write(SHIFTCTRL + at, 0x000c0000);
    write(PINCTRL + at, (1 << 26) | (3 << 15) | (2 << 5));
    write(INSTR + at, JMP | starts[machine]);
  }
  write(INSTR, SET_PINDIRS | 1);
  edges.length = 0;
  write(CTRL, (1 << machines) - 1);
  return { pico, mcu, write, edges, gaps: () => edges.slice(1).map(([cycle], at) => cycle - edges[at][0]) };
}

test('an instruction takes a cycle and its delay (3.2.6)', () => {
  const { pico, gaps } = start([SET_PINS | 1 | delay(3), SET_PINS | 0 | delay(6)]);
  pico.elapse(100);
  assert.deepEqual(gaps().slice(0, 6), [4, 7, 4, 7, 4, 7]);
});

test('a divider stretches every cycle, a fraction on average (3.5.5)', () => {
  const whole = start([SET_PINS | 1 | delay(1), SET_PINS | 0], { divisor: [10, 0] });
  whole.pico.elapse(400);
  assert.deepEqual(whole.gaps().slice(0, 6), [20, 10, 20, 10, 20, 10]);
  const fraction = start([SET_PINS | 1, SET_PINS | 0], { divisor: [2, 128] });
  fraction.pico.elapse(1000);
  const { edges } = fraction;
  assert.equal(edges[200][0] - edges[0][0], 500);
  assert.ok(fraction.gaps().every((gap) => gap === 2 || gap === 3));
});

test('a long pause and many short steps give the same edges', () => {
  const run = (step) => {
    const one = start([SET_PINS | 1 | delay(31), SET_PINS | 0], { divisor: [7, 33] });
    for (let cycle = 0; cycle < 5000; cycle += step) one.pico.elapse(step);
    return one.edges.filter(([cycle]) => cycle <= 5000);
  };
  assert.deepEqual(run(1), run(5000));
  assert.ok(run(1).length > 30);
});

test('a wait ends at the next tick after the level, and its delay follows', () => {
  const { pico, mcu, edges } = start([WAIT_1_PIN | delay(4), SET_PINS | 1, SET_PINS | 0], { divisor: [10, 0] });
  pico.elapse(5);
  pico.after(43, () => mcu.gpio[3].setInputValue(true));
  pico.elapse(200);
  // Ticks are at multiples of ten; the level comes at 48, is seen at 50, and five cycles later the pin rises.
  assert.deepEqual(edges.filter(([, level]) => level === 1)[0], [100, 1]);
});

test('a flag of another machine is seen in the following cycle and cleared by the wait (3.4.3)', () => {
  const program = [JMP | 1 | delay(5), IRQ_SET | 0, JMP | 2, WAIT_1_IRQ | 0, SET_PINS | 1, JMP | 5];
  const { pico, mcu, edges } = start(program, { machines: 2, starts: [0, 3] });
  pico.elapse(50);
  const raised = 1 + 6;
  assert.equal(edges.at(-1)[1], 1);
  // Raised in a cycle, seen in the next one, and the pin changes in the one after it.
  assert.equal(edges.at(-1)[0], raised + 2);
  assert.equal(mcu.readUint32(PIO0 + IRQ), 0);
});

test('the processor raises a flag', () => {
  const { pico, write, edges } = start([WAIT_1_IRQ | 0, SET_PINS | 1, JMP | 2]);
  pico.elapse(30);
  assert.deepEqual(edges, []);
  write(IRQ_FORCE, 1);
  pico.elapse(30);
  assert.deepEqual(edges.at(-1), [32, 1]);
});

test('an instruction of the processor interrupts a wait, which continues (3.5.7)', () => {
  const { pico, mcu, write, edges } = start([PULL_BLOCK, SET_PINS | 1, JMP | 2]);
  pico.elapse(20);
  write(INSTR, SET_PINS | 1);
  assert.equal(edges.at(-1)[1], 1);
  write(INSTR, SET_PINS | 0);
  pico.elapse(20);
  assert.equal(mcu.readUint32(PIO0 + ADDR), 0, 'it waits again');
  write(TXF0, 5);
  pico.elapse(5);
  assert.equal(edges.at(-1)[1], 1);
});

test('a stopped machine does nothing, and continues where it was', () => {
  const { pico, write, edges } = start([SET_PINS | 1, SET_PINS | 0]);
  pico.elapse(10);
  write(CTRL, 0);
  const before = edges.length;
  pico.elapse(100);
  assert.equal(edges.length, before);
  write(CTRL, 1);
  pico.elapse(10);
  assert.ok(edges.length > before);
});

test('a pad reads back its own output after two cycles (2.19.4)', () => {
  const { pico, mcu } = start([SET_PINS | 1, JMP | 1]);
  pico.elapse(2);
  const levels = [];
  for (let cycle = 0; cycle < 4; cycle++) { levels.push(mcu.gpio[2].inputValue); pico.elapse(1); }
  assert.equal(levels.indexOf(true), 1, String(levels));
  // Another machine branches on it.
  const branch = start([SET_PINS | 1, JMP_PIN | 3, JMP | 1, SET_PINS | 0]);
  branch.write(EXECCTRL, (2 << 24) | (3 << 12));
  branch.pico.elapse(20);
  assert.deepEqual(branch.edges.slice(0, 2).map(([, level]) => level), [1, 0]);
});

test('a round robin of the converter follows its mask (4.9.2.1)', () => {
  const mcu = new RP2040(), { adc } = mcu, seen = [];
  correctConverter(adc);
  adc.onADCRead = (channel) => { seen.push(channel); adc.completeADCRead(channel, false); };
  const CS = 0x4004c000;
  const convert = (mask, first) => {
    seen.length = 0;
    for (let count = 0; count < 5; count++) {
      const channel = count === 0 ? first : (mcu.readUint32(CS) >> 12) & 7;
      mcu.writeUint32(CS, (mask << 16) | (channel << 12) | 5);
    }
    return [...seen];
  };
  assert.deepEqual(convert(0b00011, 0), [0, 1, 0, 1, 0]);
  assert.deepEqual(convert(0b00111, 0), [0, 1, 2, 0, 1]);
  assert.deepEqual(convert(0b11111, 3), [3, 4, 0, 1, 2]);
  assert.deepEqual(convert(0b10001, 0), [0, 4, 0, 4, 0]);
});

test('what a machine causes has the time at which it happens, also after a long sleep', () => {
  // The machine waits for a level, and its output lets the DMA copy the time.
  const PUSH = 0x8000, { pico, mcu } = start([WAIT_1_PIN, PUSH, JMP | 2], { divisor: [1000, 0] });
  const CHANNEL = 0x50000000, RAM = 0x20000000, TIMERAWL = 0x40054028, DREQ_PIO0_RX0 = 4;
  mcu.writeUint32(CHANNEL, TIMERAWL);
  mcu.writeUint32(CHANNEL + 4, RAM);
  mcu.writeUint32(CHANNEL + 8, 1);
  mcu.writeUint32(CHANNEL + 0xc, 1 | (2 << 2) | (DREQ_PIO0_RX0 << 15));
  pico.after(1_000_500, () => mcu.gpio[3].setInputValue(true));
  pico.elapse(2_000_000);
  // Seen with the tick at 1 001 000, and the output a thousand cycles later, of 8 ns.
  assert.equal(mcu.readUint32(RAM), 1_002_000 * 8 / 1000);
});

test('an abort of the DMA is complete at once (2.5.7)', () => {
  const mcu = new RP2040();
  correctDma(mcu.dma);
  mcu.writeUint32(0x50000444, 3);
  assert.equal(mcu.readUint32(0x50000444), 0);
  mcu.writeUint32(0x50000420, 0x10002);
  assert.equal(mcu.readUint32(0x50000420), 0x10002, 'the other registers are as before');
});

test('a masked interrupt ends a sleep and stays pending', () => {
  const { core } = new RP2040();
  correctSleep(core);
  core.enabledInterrupts = 1 << 5;
  core.PM = true;
  core.waiting = true;
  assert.equal(core.checkForInterrupts(), false);
  core.setInterrupt(5, true);
  assert.equal(core.waiting, false);
  assert.equal(core.IPSR, 0, 'no handler was entered');
  assert.equal(core.pendingInterrupts, 1 << 5);
});

test('a handler begins at an even address', () => {
  const { mcu } = new Pico(), { core } = mcu;
  core.VTOR = 0x20000000;
  core.SP = 0x20001000;
  core.PC = 0x20000800;
  mcu.writeUint32(0x20000000 + 4 * (16 + 5), 0x20000401);
  core.exceptionEntry(16 + 5);
  assert.equal(core.PC, 0x20000400);
  assert.equal(core.IPSR, 16 + 5);
});

test('a damaged UF2 file is refused', () => {
  const block = Buffer.alloc(512);
  [0x0a324655, 0x9e5d5157, 0x2000, 0x10000000, 256, 0, 1, 0xe48bff56].forEach((word, at) => block.writeUInt32LE(word, 4 * at));
  block.writeUInt32LE(0x0ab16f30, 508);
  block[32] = 7;
  const pages = readUf2(block);
  assert.deepEqual([pages.length, pages[0][0], pages[0][1][0], pages[0][1].length], [1, 0x10000000, 7, 256]);
  for (const [at, value] of [[0, 0], [4, 1], [508, 2], [28, 5], [24, 2], [20, 1], [16, 255]]) {
    const damaged = Buffer.from(block);
    damaged.writeUInt32LE(value, at);
    assert.throws(() => readUf2(damaged), undefined, `byte ${at}`);
  }
  assert.throws(() => readUf2(block.subarray(0, 511)));
});
