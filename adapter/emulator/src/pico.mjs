// The emulated Pico. Not modelled: the second core, wait states of the flash (so that the processor is too fast), joined
// FIFOs, stalls and suspension of USB, and anything analogue.

import fs from 'node:fs';
import { RP2040 } from 'rp2040js';
import { correctConverter, correctDma, correctExceptions, correctPads, correctSleep } from './corrections.mjs';
import { StateMachines } from './pio.mjs';

const FLASH = 0x10000000;
const VECTORS = FLASH + 0x100;
const WATCHDOG = 0x40058;

/** Returns the pages of a UF2 file as [address, bytes]. */
export function readUf2(file) {
  if (file.length === 0 || file.length % 512 !== 0) throw new Error('not a UF2 file: wrong length');
  const pages = [];
  for (let at = 0; at < file.length; at += 512) {
    const block = file.subarray(at, at + 512);
    const [begin, second, flags, address, size, number, count, family] =
      Array.from({ length: 8 }, (_, field) => block.readUInt32LE(4 * field));
    if (begin !== 0x0a324655 || second !== 0x9e5d5157 || block.readUInt32LE(508) !== 0x0ab16f30) throw new Error('not a UF2 block');
    if (flags !== 0x2000 || family !== 0xe48bff56) throw new Error('not for the RP2040');
    if (number !== at / 512 || count !== file.length / 512 || size !== 256) throw new Error('blocks are missing');
    pages.push([address, block.subarray(32, 32 + size)]);
  }
  return pages;
}

export class Pico {
  /** Starts the firmware of a UF2 file. Without one, nothing runs. */
  constructor(uf2) {
    const mcu = (this.mcu = new RP2040());
    this.clock = mcu.clock;
    mcu.logger = { debug() {}, info() {}, warn() {}, error: (name, text) => { throw new Error(`${name}: ${text}`); } };
    /** System clock cycles since the start. */
    this.cycles = 0;
    /** Executed instructions. */
    this.instructions = 0;
    /** What happens at a cycle: [cycle, function], in order. */
    this.events = [];
    this.machines = new StateMachines(mcu, () => this.cycles);
    correctConverter(mcu.adc);
    correctDma(mcu.dma);
    correctSleep(mcu.core);
    correctExceptions(mcu.core);
    correctPads(mcu.gpio, (cycles, act) => this.after(cycles, act));
    mcu.peripherals[WATCHDOG].onWatchdogTrigger = () => this.onWatchdog();
    this.onWatchdog = () => { throw new Error('the watchdog has restarted the adapter'); };
    if (uf2) this.load(uf2);
  }

  load(uf2) {
    const { mcu } = this;
    for (const [address, bytes] of readUf2(fs.readFileSync(uf2))) mcu.flash.set(bytes, address - FLASH);
    // What the boot ROM and the second stage of the boot loader do.
    mcu.core.VTOR = VECTORS;
    mcu.core.SP = mcu.readUint32(VECTORS);
    mcu.core.PC = mcu.readUint32(VECTORS + 4) & ~1;
    mcu.core.LR = 0xffffffff;
  }

  /** Duration of a system clock cycle in nanoseconds. */
  get cycleNanos() {
    return 1e9 / this.mcu.clkSys;
  }

  /** Time since the start in nanoseconds. */
  get nanos() {
    return this.clock.nanos;
  }

  /** Returns the number of cycles in a time. */
  cyclesOf(nanos) {
    return Math.round(nanos / this.cycleNanos);
  }

  /** Calls a function after a number of cycles. */
  after(cycles, act) {
    const at = this.cycles + cycles;
    let place = this.events.length;
    while (place > 0 && this.events[place - 1][0] > at) place--;
    this.events.splice(place, 0, [at, act]);
  }

  /** Lets a number of cycles pass for the state machines, the events and the clock. */
  elapse(cycles) {
    const end = this.cycles + cycles, { machines, events } = this;
    for (;;) {
      const next = Math.min(machines.due, events.length ? events[0][0] : Infinity);
      if (next > end) break;
      this.advance(next);
      while (events.length && events[0][0] <= this.cycles) events.shift()[1]();
      machines.run();
    }
    this.advance(end);
  }

  /** The clock goes with the cycles, so that what the machines cause has the right time. */
  advance(cycle) {
    if (cycle <= this.cycles) return;
    const cycles = cycle - this.cycles;
    this.cycles = cycle;
    this.clock.tick(cycles * this.cycleNanos);
  }

  /** Runs for a time in nanoseconds, or until a budget of real milliseconds is used up. Returns whether it is complete. */
  run(nanos, budgetMs = Infinity) {
    const end = this.clock.nanos + nanos, stop = performance.now() + budgetMs, { mcu, clock } = this, { core } = mcu;
    for (let steps = 1; clock.nanos < end; steps++) {
      if (core.waiting && core.pendingInterrupts & core.enabledInterrupts) core.waiting = false;
      if (core.waiting) {
        // Nothing happens until the next alarm, instruction of a state machine or event.
        const alarm = clock.nextAlarm ? Math.ceil(clock.nanosToNextAlarm / this.cycleNanos) : Infinity;
        const other = Math.min(this.machines.due, this.events.length ? this.events[0][0] : Infinity) - this.cycles;
        const rest = Math.ceil((end - clock.nanos) / this.cycleNanos);
        this.elapse(Math.max(1, Math.min(alarm, other, rest)));
      } else {
        this.elapse(core.executeInstruction());
        this.instructions++;
      }
      if ((steps & 0xfff) === 0 && performance.now() > stop) return false;
    }
    return true;
  }
}
