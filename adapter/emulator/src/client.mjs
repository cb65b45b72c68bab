// A host program at the emulated adapter, in virtual time.

import { connectBoard } from './board.mjs';
import { emit, Receiver } from './packets.mjs';
import { Pico } from './pico.mjs';
import { UsbHost } from './usb-host.mjs';

export const u16 = (value) => [value & 255, value >> 8];
export const u32 = (value) => [value & 255, (value >> 8) & 255, (value >> 16) & 255, value >>> 24];

export const OP = {
  hello: 0x01, supply: 0x02, ssiConfig: 0x10, ssiRead: 0x11, ssiStream: 0x12,
  bissConfig: 0x20, bissRead: 0x21, registerRead: 0x22, registerWrite: 0x23, bissStream: 0x24,
  status: 0x03, uartConfig: 0x40, uartTransfer: 0x41, analogConfig: 0x30, analogStream: 0x31, analogSkew: 0x33, analogData: 0xb2, ssiData: 0x93, bissData: 0xa5,
};

export class Client {
  constructor({ uf2 = process.env.ADAPTER_UF2, parts } = {}) {
    this.pico = new Pico(uf2);
    connectBoard(this.pico, parts);
    this.host = new UsbHost(this.pico);
    this.receiver = new Receiver();
    this.seq = 0;
    this.host.fetch((bytes) => this.receiver.push(bytes));
    this.until(() => this.host.isReady, 'no enumeration', 100e6);
  }

  /** Runs until a condition holds. */
  until(condition, text, nanos = 300e6) {
    const end = this.pico.clock.nanos + nanos;
    while (!condition()) {
      if (this.pico.clock.nanos > end) throw new Error(text);
      this.pico.run(20_000);
    }
  }

  /** Sends a request and returns its reply: operation and body. */
  request(op, body = [], nanos = 300e6) {
    this.seq = (this.seq + 1) & 255;
    this.host.send(emit(this.seq, op, body));
    const { packets } = this.receiver;
    const answers = (packet) => packet[0] === this.seq && (packet[1] === (op | 0x80) || packet[1] === 0xff);
    this.until(() => packets.some(answers), `no reply to operation ${op.toString(16)}`, nanos);
    const [reply] = packets.splice(packets.findIndex(answers), 1);
    return { op: reply[1], body: reply.subarray(2) };
  }

  /** Sends a request and returns the body of its reply, which is not a refusal. */
  ask(op, body = [], nanos = 300e6) {
    const reply = this.request(op, body, nanos);
    if (reply.op === 0xff) throw new Error(`refused: ${reply.body[1]} ${reply.body.subarray(3)}`);
    return reply.body;
  }

  /** Sends a request that is refused and returns the error code. */
  refused(op, body = []) {
    const reply = this.request(op, body);
    if (reply.op !== 0xff) throw new Error(`operation ${op.toString(16)} was not refused`);
    return reply.body[1];
  }

  /** Configures SSI and returns the actual clock. */
  configureUart(baud, parity = 2, turnaroundUs = 0) {
    return this.ask(OP.uartConfig, [...u32(baud), parity, ...u16(turnaroundUs)]).readUInt32LE(0);
  }

  transfer(bytes, timeoutUs = 50_000, idleUs = 5_000) {
    const body = this.ask(OP.uartTransfer, [...u32(timeoutUs), ...u32(idleUs), ...bytes], 1e9);
    return { timeUs: Number(body.readBigUInt64LE(0)), rx: [...body.subarray(8)] };
  }

  configureSsi(clocks, hz, pauseUs = 30) {
    return this.ask(OP.ssiConfig, [clocks, ...u32(hz), ...u16(pauseUs), 1]).readUInt32LE(0);
  }

  readSsi() {
    const body = this.ask(OP.ssiRead);
    return { timeUs: Number(body.readBigUInt64LE(0)), raw: body.readBigUInt64LE(8) };
  }

  /** Takes the packets of a stream that have arrived. */
  stream(op) {
    const { packets } = this.receiver, found = packets.filter((packet) => packet[1] === op);
    this.receiver.packets = packets.filter((packet) => packet[1] !== op);
    return found.map((packet) => (op === OP.analogData ? parseAnalog(packet.subarray(2)) : parseStream(packet.subarray(2), op === OP.bissData)));
  }
}

function parseAnalog(body) {
  const count = body[14], values = [];
  if (body.length !== 15 + 4 * count) throw new Error('wrong length of a packet');
  for (let at = 15; at < body.length; at += 4) values.push([body.readInt16LE(at), body.readInt16LE(at + 2)]);
  return { first: body.readUInt32LE(0), timeUs: Number(body.readBigUInt64LE(4)), lost: body.readUInt16LE(12), values };
}

function parseStream(body, hasStatus) {
  const width = body[18], count = body[19], size = width + (hasStatus ? 1 : 0), values = [];
  if (body.length !== 20 + count * size) throw new Error('wrong length of a packet');
  for (let at = 20; at < body.length; at += size) {
    const start = at + (hasStatus ? 1 : 0);
    let raw = 0n;
    for (let byte = width - 1; byte >= 0; byte--) raw = (raw << 8n) | BigInt(body[start + byte]);
    values.push(hasStatus ? { status: body[at], raw } : raw);
  }
  return { first: body.readUInt32LE(0), timeUs: Number(body.readBigUInt64LE(4)), periodUs: body.readUInt32LE(12), lost: body.readUInt16LE(16), values };
}
