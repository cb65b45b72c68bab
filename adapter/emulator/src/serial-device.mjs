// A device at the serial line, on the level of bits. It reads characters from the output of the adapter while the driver is
// on, and answers by `reply(bytes)` after silence.

export class SerialDevice {
  constructor(pico, { output = 8, input = 9, direction = 10, baud = 9600, parity = 'even', reply = () => [], delayNanos = 5e6, silenceNanos = 4.6e6 }) {
    Object.assign(this, { pico, baud, parity, reply, delayNanos, silenceNanos });
    /** Received bytes with the times of their start edges, and errors of parity and stop bits. */
    this.heard = [];
    this.errors = 0;
    /** Edges of the direction as [nanoseconds, level], and those of the output. */
    this.direction = [];
    this.edges = [];
    /** Time of the first start edge of the last reply. */
    this.replied = null;
    this.input = pico.mcu.gpio[input];
    this.input.setInputValue(true);
    this.out = pico.mcu.gpio[output];
    this.isReceiving = false;
    this.pending = [];
    this.timer = 0;
    pico.mcu.gpio[direction].addListener((value) => { if (value <= 1) this.direction.push([pico.nanos, value]); });
    this.out.addListener((value) => {
      if (value > 1) return;
      this.edges.push([pico.nanos, value]);
      if (value === 0 && !this.isReceiving) this.receive();
    });
  }

  get bitNanos() {
    return 1e9 / this.baud;
  }

  at(nanos, act) {
    this.pico.after(this.pico.cyclesOf(nanos), act);
  }

  receive() {
    const count = this.parity === 'none' ? 9 : 10, bits = [];
    this.isReceiving = true;
    const start = this.pico.nanos;
    for (let bit = 1; bit <= count; bit++) this.at((bit + 0.5) * this.bitNanos, () => bits.push(this.out.value === 1 ? 1 : 0));
    this.at((count + 0.6) * this.bitNanos, () => {
      this.isReceiving = false;
      const byte = bits.slice(0, 8).reduce((sum, bit, at) => sum | (bit << at), 0);
      const ones = bits.slice(0, count - 1).reduce((sum, bit) => sum + bit, 0);
      if (bits[count - 1] !== 1 || (this.parity === 'even' && ones % 2) || (this.parity === 'odd' && !(ones % 2))) this.errors++;
      this.heard.push([start, byte]);
      this.pending.push(byte);
      const own = ++this.timer;
      this.at(this.silenceNanos, () => {
        if (own !== this.timer) return;
        const bytes = this.reply(this.pending.splice(0));
        if (bytes.length) this.at(this.delayNanos, () => this.send(bytes));
      });
    });
  }

  send(bytes) {
    const bit = this.bitNanos;
    this.replied = this.pico.nanos;
    bytes.forEach((byte, character) => {
      const data = Array.from({ length: 8 }, (_, at) => (byte >> at) & 1), ones = data.reduce((sum, one) => sum + one, 0);
      const parity = { none: [], even: [ones % 2], odd: [1 - (ones % 2)] }[this.parity];
      const levels = [0, ...data, ...parity, 1];
      levels.forEach((level, at) => this.at((character * levels.length + at) * bit, () => this.input.setInputValue(level === 1)));
    });
  }
}
