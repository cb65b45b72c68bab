// A BiSS C encoder on two pins. It follows the reference, protocol/biss.md 2 and 3, and shares nothing with the firmware.

export class BissEncoder {
  /** `word` is a number or a function of the time in nanoseconds; `control` answers control frames (registers.mjs). */
  constructor(pico, { ma = 2, slo = 3, bits = 41, word, delayNanos = 0, busyNanos = 5_500, timeoutNanos = 15_000, control = null }) {
    Object.assign(this, { bits, word });
    /** Edges of MA as [cycle, level], the times at which a position was latched, and clocks after the last bit. */
    this.edges = [];
    this.latched = [];
    this.surplus = 0;
    const pin = pico.mcu.gpio[slo];
    const delay = 2 + pico.cyclesOf(delayNanos);
    const send = (level) => pico.after(delay, () => pin.setInputValue(level));
    pin.setInputValue(true);
    let level = true, state = 'idle', ready = 0, sent = 0, value = 0n, cds = 0, edge = 0;
    pico.mcu.gpio[ma].addListener((change) => {
      if (change > 1 || (change === 1) === level) return;
      level = change === 1;
      this.edges.push([pico.cycles, level]);
      const own = ++edge;
      if (level && state === 'parked') {
        // The end of a control bit of 1.
        state = 'idle';
        return;
      }
      if (!level && state === 'idle') {
        state = 'latched';
        this.latched.push(pico.nanos);
        value = typeof this.word === 'function' ? this.word(pico.nanos) : this.word;
        cds = control?.cds() ?? 0;
        ready = pico.cycles + pico.cyclesOf(busyNanos);
        this.surplus = 0;
      } else if (level && state === 'latched') {
        send(false);
        state = 'busy';
      } else if (level && state === 'busy') {
        if (pico.cycles >= ready) {
          send(true);
          state = 'data';
          sent = 0;
        }
      } else if (level && state === 'data') {
        if (sent === 0) send(cds === 1);
        else if (sent <= this.bits) send(((value >> BigInt(this.bits - sent)) & 1n) === 1n);
        else { send(false); this.surplus++; }
        sent++;
      }
      pico.after(pico.cyclesOf(timeoutNanos), () => {
        if (own !== edge) return;
        // The level of MA during the time-out is the control bit of the host, inverted.
        if (state === 'data') control?.cdm(level ? 0 : 1);
        state = level ? 'idle' : 'parked';
        pin.setInputValue(true);
      });
    });
  }
}

/** Returns a frame with its CRC: 16 bits of turns, 17 of steps, error and warning (1: none), CRC6. */
export function frame(turns, steps) {
  const data = (BigInt(turns) << 19n) | (BigInt(steps) << 2n) | 3n;
  let crc = 0;
  for (let at = 34n; at >= 0n; at--) {
    const feedback = (crc >> 5) ^ Number((data >> at) & 1n);
    crc = ((crc << 1) & 0x3f) ^ (feedback ? 3 : 0);
  }
  return (data << 6n) | BigInt(crc ^ 0x3f);
}
