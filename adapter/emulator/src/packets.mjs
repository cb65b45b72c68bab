// Packets of the bridge protocol, written from the reference, protocol/bridge.md, only.

export function crc16(bytes) {
  let crc = 0xffff;
  for (const byte of bytes) {
    crc ^= byte << 8;
    for (let bit = 0; bit < 8; bit++) crc = crc & 0x8000 ? ((crc << 1) ^ 0x1021) & 0xffff : (crc << 1) & 0xffff;
  }
  return crc;
}

export function stuff(bytes) {
  const out = [];
  let run = [];
  const end = () => { out.push(run.length + 1, ...run); run = []; };
  for (const byte of bytes) {
    if (byte === 0) end();
    else {
      run.push(byte);
      if (run.length === 254) { out.push(255, ...run); run = []; }
    }
  }
  end();
  return out;
}

export function unstuff(bytes) {
  const out = [];
  for (let at = 0; at < bytes.length;) {
    const code = bytes[at];
    if (code === 0 || at + code > bytes.length) throw new Error('not COBS');
    out.push(...bytes.slice(at + 1, at + code));
    at += code;
    if (code !== 255 && at < bytes.length) out.push(0);
  }
  return out;
}

/** Returns the bytes of a packet on the line. */
export function emit(seq, op, body) {
  const content = [seq, op, ...body], crc = crc16(content);
  return [...stuff([...content, crc & 255, crc >> 8]), 0];
}

/** Collects packets from received bytes. */
export class Receiver {
  constructor() { this.rest = []; this.packets = []; }

  push(bytes) {
    for (const byte of bytes) {
      if (byte !== 0) { this.rest.push(byte); continue; }
      if (this.rest.length) {
        const packet = unstuff(this.rest), crc = packet.at(-2) | (packet.at(-1) << 8);
        if (packet.length < 4 || crc16(packet.slice(0, -2)) !== crc) throw new Error('a damaged packet');
        this.packets.push(Buffer.from(packet.slice(0, -2)));
      }
      this.rest = [];
    }
  }
}
