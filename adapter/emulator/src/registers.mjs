// Registers of the POSITAL kit encoder and its answers to control frames, from the reference, protocol/biss.md 3 and 4.

/** The registers with the defaults of the reference. */
export class Registers {
  constructor() {
    this.direct = new Uint8Array(128);
    this.banks = Array.from({ length: 0x44 }, () => new Uint8Array(64));
    const put = (address, ...values) => this.direct.set(values, address);
    put(0x41, 2, 0x61, 0x29, 0x12, 0x34, 0x56, 0x78);
    put(0x66, 0x4b);
    put(0x6e, 3);
    put(0x74, 1, 6, 0);
    put(0x78, 1, 1, 0x68, 0x11, 0, 1, 0x46, 0x72);
    const common = { 0: 1, 1: 2, 2: 4, 3: 0x43, 5: 0x1c, 6: 0x30, 0xc: 0x20, 0xe: 1, 0xf: 0xf4, 0x10: 1, 0x11: 1, 0x14: 3, 0x15: 0x23, 0x17: 0x21 };
    const encoder = {
      0: 1, 1: 1, 2: 0x61, 3: 0x29, 4: 1, 5: 2, 6: 255, 0xa: 0x10, 0xc: 0x11, 0x1f: 0x21, 0x2c: 0x2e, 0x2d: 0xe0,
      0x31: 0xe9, 0x32: 1, 0x33: 0x7a, 0x34: 0x13, 0x35: 0x88, 0x36: 0x2e, 0x37: 0xe0, 0x39: 0x46,
    };
    for (const [bank, content] of [[2, common], [3, encoder]]) {
      for (const [offset, value] of Object.entries(content)) this.banks[bank][offset] = value;
      this.banks[bank][63] = this.banks[bank].slice(0, 63).reduce((sum, value) => sum + value, 0) & 255;
    }
  }

  read(address) {
    return address < 0x40 ? this.banks[this.direct[0x40]]?.[address] ?? 0 : this.direct[address];
  }

  write(address, value) {
    const bank = this.direct[0x40];
    if (address === 0x6a) {
      // A mode needs the password; the mode 0 does not.
      if (value === 0 || this.direct[0x6b] === 0x2a) this.direct[0x6a] = value;
    } else if (address === 0x40 || address === 0x6b) this.direct[address] = value;
    else if (address === 0x1a && bank === 0 && this.direct[0x6a] === 4) {
      // Motor and OEM data, section 5.3: 1 and 2 begin to write, 3 saves, 4 cancels.
      this.banks[0][0x1b] = value === 1 || value === 2 ? 1 : 0;
    } else if (address < 0x40 && bank >= 4 && this.banks[bank] && this.banks[0][0x1b] === 1) this.banks[bank][address] = value;
  }
}

function crc4(value, count) {
  let crc = 0;
  for (let at = count - 1; at >= 0; at--) {
    const feedback = ((crc >> 3) ^ (value >> at)) & 1;
    crc = ((crc << 1) & 15) ^ (feedback ? 3 : 0);
  }
  return crc ^ 15;
}

/** The control channel of an encoder: one bit in each direction a frame. */
export class Control {
  constructor(registers) {
    this.registers = registers;
    this.zeros = 0;
    /** Bits of the host since the start bit. */
    this.bits = null;
    /** Complete accesses. */
    this.accesses = 0;
  }

  number(from, count) {
    return this.bits.slice(from, from + count).reduce((sum, bit) => (sum << 1) | bit, 0);
  }

  /** Returns the bit of the frame that begins. It answers the bits that have arrived so far. */
  cds() {
    if (!this.bits) return 0;
    const index = this.bits.length;
    if (index === 1) return 1;
    if (index === 17 || index === 18) return this.bits[index - 1];
    if (index < 19) return 0;
    // A header with a wrong checksum is not answered.
    if (crc4(this.number(1, 11), 11) !== this.number(12, 4)) return 0;
    const isRead = this.bits[16] === 1, value = isRead ? this.registers.read(this.number(5, 7)) : this.number(19, 8);
    if (index === 19) return 1;
    if (index <= 27) return isRead ? (value >> (27 - index)) & 1 : this.bits[index - 1];
    if (index <= 31) return (crc4(value, 8) >> (31 - index)) & 1;
    return 0;
  }

  /** Takes the bit of the host at the end of a frame. 14 zeros end any access. */
  cdm(bit) {
    const mayStart = this.zeros >= 14;
    this.zeros = bit ? 0 : this.zeros + 1;
    if (this.zeros >= 14) this.bits = null;
    if (!this.bits) {
      if (bit && mayStart) this.bits = [1];
      return;
    }
    this.bits.push(bit);
    if (this.bits.length === 32) {
      const data = this.number(19, 8);
      if (this.bits[17] === 1 && crc4(data, 8) === this.number(27, 4)) this.registers.write(this.number(5, 7), data);
      this.accesses++;
    }
    if (this.bits.length === 33) this.bits = null;
  }
}
