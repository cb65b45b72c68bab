// An SSI encoder on two pins. It follows the reference, protocol/ssi.md 1, and shares nothing with the firmware.

export class SsiEncoder {
  /** `word` is a number or a function of the time in nanoseconds. `delayNanos` is that of the line and of the encoder. */
  constructor(pico, { clock = 2, data = 3, bits, word, delayNanos = 0, timeoutNanos = 20_000 }) {
    Object.assign(this, { bits, word });
    /** Edges of the clock as [cycle, level], and the times at which a value was latched. */
    this.edges = [];
    this.latched = [];
    const pin = pico.mcu.gpio[data];
    // The synchroniser of the pin takes two cycles.
    const delay = 2 + pico.cyclesOf(delayNanos);
    const send = (level) => pico.after(delay, () => pin.setInputValue(level));
    pin.setInputValue(true);
    let level = true, isIdle = true, left = 0, value = 0n, edge = 0;
    pico.mcu.gpio[clock].addListener((state) => {
      if (state > 1 || (state === 1) === level) return;
      level = state === 1;
      this.edges.push([pico.cycles, level]);
      const own = ++edge;
      if (!level && isIdle) {
        isIdle = false;
        this.latched.push(pico.nanos);
        value = typeof this.word === 'function' ? this.word(pico.nanos) : this.word;
        left = this.bits;
      } else if (level && !isIdle) {
        left--;
        send(left >= 0 && ((value >> BigInt(left)) & 1n) === 1n);
      }
      // The monoflop: without an edge for this time, the encoder is idle again.
      pico.after(pico.cyclesOf(timeoutNanos), () => {
        if (own !== edge) return;
        isIdle = true;
        pin.setInputValue(true);
      });
    });
  }
}
