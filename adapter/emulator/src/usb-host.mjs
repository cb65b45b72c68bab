// A USB host for the serial port of the emulated adapter. It enumerates the device and carries bytes with the pace of full
// speed. The host of rp2040js answers each prepared endpoint with an empty packet and has no pace.

import { createSetupPacket } from 'rp2040js';

/** A packet of 64 bytes with its overhead: at most 19 of them fit in a frame of a millisecond. */
const PACKET_NANOS = 53_000;
const GET_DESCRIPTOR = 6, SET_ADDRESS = 5, SET_CONFIGURATION = 9, SET_CONTROL_LINE_STATE = 0x22;
const DEVICE = 1, CONFIGURATION = 2, STRING = 3, INTERFACE = 4, ENDPOINT = 5;
const COMMUNICATION = 2, DATA = 10;
/** Registers of the buffers in the memory of the controller (4.1.2.5), and their bits. */
const BUFFER_CONTROL = 0x80, AVAILABLE = 1 << 10, FULL = 1 << 15, LENGTH = 0x3ff;

export class UsbHost {
  constructor(pico) {
    const usb = (this.usb = pico.mcu.usbCtrl);
    this.pico = pico;
    this.toDevice = [];
    /** Whether the device waits for a packet, by endpoint, and the length. */
    this.prepared = new Map();
    this.isReady = false;
    /** Receives the bytes of the device. While it is null, packets are not fetched. */
    this.onData = () => {};
    this.texts = {};
    this.waiting = [];
    usb.readDelayMicroseconds = PACKET_NANOS / 1000;
    usb.writeDelayMicroseconds = PACKET_NANOS / 1000;
    usb.onUSBEnabled = () => usb.resetDevice();
    usb.onResetReceived = () => this.enumerate();
    usb.onEndpointWrite = (endpoint, bytes) => this.received(endpoint, Uint8Array.from(bytes));
    usb.onEndpointRead = (endpoint, length) => {
      if (endpoint === 0) return;
      this.prepared.set(endpoint, length);
      this.pump();
    };
    const update = usb.DPRAMUpdated.bind(usb);
    usb.DPRAMUpdated = (offset, value) => {
      if (offset === BUFFER_CONTROL + 8 * this.input && value & AVAILABLE) this.offered(offset, value);
      else update(offset, value);
    };
  }

  /** The device offers a packet. It is complete, and its buffer free, when it has been transferred; a host that does not
   *  fetch it leaves it where it is. rp2040js frees the buffer at once. */
  offered(offset, value) {
    const { usb, pico } = this, memory = pico.mcu.usbDPRAM, view = pico.mcu.usbDPRAMView;
    const start = usb.getEndpointBufferOffset(this.input, false);
    const bytes = memory.slice(start, start + (value & LENGTH));
    const transfer = () => pico.after(pico.cyclesOf(PACKET_NANOS), () => {
      view.setUint32(offset, value & ~(AVAILABLE | FULL), true);
      if (bytes.length) this.onData?.(bytes);
      usb.indicateBufferReady(this.input, false);
    });
    if (this.onData) transfer();
    else this.waiting.push(transfer);
  }

  /** Stops or continues to fetch packets. */
  fetch(onData) {
    this.onData = onData;
    if (onData) for (const transfer of this.waiting.splice(0)) transfer();
  }

  control(request, wanted, then) {
    const [type, recipient, bRequest, wValue, wIndex, wLength, isIn] = request;
    this.answer = [];
    this.wanted = wanted;
    this.then = then;
    const dataDirection = isIn ? 1 : 0;
    this.usb.sendSetupPacket(createSetupPacket({ dataDirection, type, recipient, bRequest, wValue, wIndex, wLength }));
  }

  descriptor(kind, number, length, then) {
    const language = kind === STRING && number > 0 ? 0x409 : 0;
    this.control([0, 0, GET_DESCRIPTOR, (kind << 8) | number, language, length, true], length, then);
  }

  enumerate() {
    const text = (number, name, then) => this.descriptor(STRING, number, 255, (bytes) => {
      this.texts[name] = Buffer.from(bytes.slice(2)).toString('utf16le');
      then();
    });
    this.control([0, 0, SET_ADDRESS, 1, 0, 0, false], 0, () =>
      this.descriptor(DEVICE, 0, 18, (device) => {
        this.id = [device[8] | (device[9] << 8), device[10] | (device[11] << 8)];
        this.descriptor(CONFIGURATION, 0, 9, (head) =>
          this.descriptor(CONFIGURATION, 0, head[2] | (head[3] << 8), (configuration) => {
            this.parse(configuration);
            text(device[14], 'manufacturer', () => text(device[15], 'product', () => text(device[16], 'serial', () =>
              this.control([0, 0, SET_CONFIGURATION, 1, 0, 0, false], 0, () =>
                this.open(true, () => { this.isReady = true; })))));
          }));
      }));
  }

  /** Opens or closes the port: sets the line DTR. */
  open(isOpen, then = () => {}) {
    this.control([1, 1, SET_CONTROL_LINE_STATE, isOpen ? 3 : 0, this.interface, 0, false], 0, then);
  }

  parse(configuration) {
    let kind = 0;
    for (let at = 0; at < configuration.length; at += configuration[at]) {
      if (configuration[at + 1] === INTERFACE) {
        kind = configuration[at + 5];
        if (kind === COMMUNICATION) this.interface = configuration[at + 2];
      }
      if (configuration[at + 1] === ENDPOINT && kind === DATA) {
        const address = configuration[at + 2];
        if (address & 0x80) this.input = address & 15;
        else this.output = address;
      }
    }
  }

  received(endpoint, bytes) {
    if (endpoint !== 0) return;
    const { then } = this;
    if (this.wanted === 0) {
      // The confirmation of a request without data.
      this.then = null;
      if (then) this.pico.after(this.pico.cyclesOf(20_000), () => then([]));
      return;
    }
    this.answer.push(...bytes);
    if (this.answer.length >= this.wanted || bytes.length < 64) {
      this.then = null;
      this.wanted = -1;
      this.usb.endpointReadDone(0, new Uint8Array(0));
      if (then) this.pico.after(this.pico.cyclesOf(100_000), () => then(this.answer));
    }
  }

  /** Sends bytes to the device. */
  send(bytes) {
    this.toDevice.push(Uint8Array.from(bytes));
    this.pump();
  }

  pump() {
    if (!this.isReady || !this.prepared.has(this.output) || !this.toDevice.length) return;
    const [first] = this.toDevice, packet = first.subarray(0, Math.min(64, this.prepared.get(this.output)));
    if (packet.length === first.length) this.toDevice.shift();
    else this.toDevice[0] = first.subarray(packet.length);
    this.prepared.delete(this.output);
    this.usb.endpointReadDone(this.output, packet);
  }
}
