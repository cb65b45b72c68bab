// State machines in step with the processor. rp2040js runs them in bursts, without clock dividers and delays. Here each
// instruction is executed at its own system clock cycle, and cycles in which nothing happens are skipped.

const CTRL = 0x000;
const CLKDIV = 0x00;
const INSTR = 0x10;
const WAIT_FOR_PIN = 1;

/** The state machines of both PIO blocks of an emulated chip. `now()` is the current system clock cycle. */
export class StateMachines {
  constructor(mcu, now) {
    this.blocks = mcu.pio;
    this.now = now;
    this.machines = [];
    for (const block of this.blocks) {
      block.run = () => {};
      for (const machine of block.machines) {
        this.machines.push(machine);
        this.correct(machine);
      }
      const write = block.writeUint32.bind(block);
      block.writeUint32 = (offset, value) => {
        const before = block.machines.map((machine) => machine.enabled);
        write(offset, value);
        if (offset === CTRL) {
          block.machines.forEach((machine, at) => {
            if (!machine.enabled) machine.due = Infinity;
            else if (!before[at]) machine.due = this.tickFrom(machine, now() + 1);
          });
        }
        block.checkChangedPins();
      };
    }
  }

  correct(machine) {
    /** Cycle of the next instruction. Infinite while the machine is stopped or waits. */
    machine.due = Infinity;
    /** A cycle at which the divided clock ticks, in 256ths. */
    machine.phase = 0;
    machine.clkDivRestart = () => { machine.phase = this.now() * 256; };
    const checkWait = machine.checkWait.bind(machine);
    machine.isExecuting = false;
    // Something from outside may have ended a wait. The machine notices at its next tick; a flag or a FIFO of which
    // another unit changes the state is seen in the following cycle.
    machine.checkWait = () => {
      if (machine.isExecuting) checkWait();
      else if (machine.waiting && machine.enabled) {
        const seen = this.now() + (machine.waitType === WAIT_FOR_PIN ? 0 : 1);
        machine.due = Math.min(machine.due, this.tickFrom(machine, seen));
      }
    };
    const write = machine.writeUint32.bind(machine);
    machine.writeUint32 = (offset, value) => {
      if (offset === INSTR) {
        // The instruction replaces one that waits, which is executed again afterwards.
        machine.waiting = false;
        machine.isExecuting = true;
        write(offset, value);
        machine.isExecuting = false;
        if (machine.enabled) machine.due = this.tickFrom(machine, this.now() + 1);
        return;
      }
      write(offset, value);
      if (offset === CLKDIV) machine.phase = this.now() * 256;
    };
  }

  static divisor(machine) {
    return ((machine.clockDivInt || 65536) << 8) + machine.clockDivFrac;
  }

  /** Returns the cycle of the first tick at or after a cycle. */
  tickFrom(machine, cycle) {
    const divisor = StateMachines.divisor(machine);
    const ticks = Math.ceil((cycle * 256 - machine.phase) / divisor);
    return Math.ceil((machine.phase + ticks * divisor) / 256);
  }

  /** Returns the cycle in which the next machine does something. */
  get due() {
    let due = Infinity;
    for (const machine of this.machines) if (machine.due < due) due = machine.due;
    return due;
  }

  /** Executes what is due at the current cycle. */
  run() {
    const now = this.now();
    for (const block of this.blocks) {
      let ran = false;
      for (const machine of block.machines) {
        if (machine.due > now) continue;
        this.step(machine, block);
        ran = true;
      }
      if (ran) block.checkChangedPins();
    }
  }

  step(machine, block) {
    const now = this.now();
    const before = machine.cycles;
    let cycles;
    machine.due = Infinity;
    machine.isExecuting = true;
    if (machine.waiting) {
      machine.checkWait();
      // The wait itself takes a cycle, and its delay follows.
      cycles = machine.cycles - before + 1;
    } else {
      machine.updatePC = true;
      machine.executeInstruction(block.instructions[machine.pc]);
      if (machine.updatePC) machine.nextPC();
      cycles = machine.cycles - before;
    }
    machine.isExecuting = false;
    if (machine.waiting || !machine.enabled) return;
    const divisor = StateMachines.divisor(machine);
    // Ticks of a fractional divider are counted from the phase, so that their error does not add up.
    const ticks = Math.round((now * 256 - machine.phase) / divisor) + cycles;
    machine.due = Math.ceil((machine.phase + ticks * divisor) / 256);
  }
}
