// What rp2040js models wrongly, apart from the state machines (pio.mjs). Each correction is tested in
// test/corrections.test.mjs against the data sheet of the RP2040.

const CHAN_ABORT = 0x444;

/** The round robin mask of the converter selects the next input, and input 0 follows input 4. rp2040js computes both wrongly. */
export function correctConverter(adc) {
  // The number is only used for this, and one more lets the search arrive at 0.
  adc.numChannels = 6;
  Object.defineProperty(adc, 'activeChannel', {
    get() { return (this.cs >> 12) & 7; },
    set(channel) { this.cs = (this.cs & ~(7 << 12)) | ((channel & 7) << 12); },
  });
}

/** An abort of a DMA channel is complete at once: its register reads as 0, where rp2040js has no such register. */
export function correctDma(dma) {
  const read = dma.readUint32.bind(dma);
  dma.readUint32 = (offset) => (offset === CHAN_ABORT ? 0 : read(offset));
}

/** With interrupts masked, an interrupt ends a sleep and stays pending, also if it was pending before. */
export function correctSleep(core) {
  const check = core.checkForInterrupts.bind(core);
  core.checkForInterrupts = () =>
    core.waiting && core.PM ? (core.pendingInterrupts & core.enabledInterrupts) !== 0 : check();
}

/** An exception begins at the address of its vector without the lowest bit, which only marks Thumb code. rp2040js leaves it
 * in the program counter, so that the handler computes wrong addresses from it. */
export function correctExceptions(core) {
  const enter = core.exceptionEntry.bind(core);
  core.exceptionEntry = (number) => {
    enter(number);
    core.PC &= ~1;
  };
}

/** A pad reads back what it drives, after the two cycles of its synchroniser. */
export function correctPads(gpio, after) {
  for (const pin of gpio) {
    pin.addListener((value) => {
      if (value <= 1) after(2, () => pin.setInputValue(value === 1));
    });
  }
}
