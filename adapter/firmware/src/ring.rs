//! Ring buffers for the values of a stream. The DMA copies and counts the values without the processor, so that lost
//! values are always detected.
//!
//! Two channels alternate every 2³¹ values and start each other. Both write to the same ring, whose length is a divisor
//! of 2³¹.

use core::cell::UnsafeCell;

use rp2040_hal as hal;

use hal::pac::{DMA, RESETS};

/// Capacities of the two rings: words of SSI or BiSS, and converted values.
pub(crate) const WORDS: u32 = BYTES / 4;
pub(crate) const CONVERSIONS: u32 = BYTES / 2;

/// Length of a ring in bytes, which is the maximum that the DMA supports.
const BYTES: u32 = 1 << ADDRESS_BITS;
const ADDRESS_BITS: u32 = 15;
/// Number of values that a channel copies before the other channel continues.
const VALUES_PER_TURN: u32 = 1 << 31;

/// Memory with the alignment required by a DMA ring.
#[repr(C, align(32768))]
struct Memory(UnsafeCell<[u8; BYTES as usize]>);

// Safety: the DMA writes this memory. The processor only reads it, with volatile reads of whole values.
unsafe impl Sync for Memory {}

static WORD_MEMORY: Memory = Memory(UnsafeCell::new([0; BYTES as usize]));
static CONVERSION_MEMORY: Memory = Memory(UnsafeCell::new([0; BYTES as usize]));

/// A ring buffer with its two DMA channels.
pub(crate) struct Ring {
    memory: &'static Memory,
    channels: [usize; 2],
    /// Binary logarithm of the number of bytes in a value.
    size: u32,
}

/// Takes the DMA out of reset. Returns the ring for SSI or BiSS words, and the ring for converted values.
pub(crate) fn rings(dma: DMA, resets: &mut RESETS) -> (Ring, Ring) {
    resets.reset().modify(|_, w| w.dma().clear_bit());
    while resets.reset_done().read().dma().bit_is_clear() {}
    // From here on, only the rings use the registers.
    drop(dma);
    let words = Ring { memory: &WORD_MEMORY, channels: [0, 1], size: 2 };
    let conversions = Ring { memory: &CONVERSION_MEMORY, channels: [2, 3], size: 1 };
    (words, conversions)
}

/// Returns the registers of the DMA.
pub(crate) fn dma() -> &'static hal::pac::dma::RegisterBlock {
    // Safety: `rings` has taken the DMA, and each user has its own channels. Shared registers only contain bits to set,
    // one for each channel.
    unsafe { &*DMA::ptr() }
}

impl Ring {
    /// Starts copying the values of the FIFO with this DMA request signal.
    pub(crate) fn start(&mut self, fifo: *const u32, request: u8) {
        let others = self.channels.into_iter().rev();
        for (channel, other) in self.channels.into_iter().zip(others) {
            let registers = dma().ch(channel);
            // Safety: the channel reads a FIFO and writes to the ring, which is never freed.
            unsafe {
                registers.ch_read_addr().write(|w| w.bits(fifo as u32));
                registers.ch_write_addr().write(|w| w.bits(self.memory.0.get() as u32));
                registers.ch_trans_count().write(|w| w.bits(VALUES_PER_TURN));
                // This register sets up the channel without starting it.
                registers.ch_al1_ctrl().write(|w| {
                    w.bits(
                        1 | self.size << 2              // enabled
                            | 1 << 5                    // the write address advances
                            | ADDRESS_BITS << 6
                            | 1 << 10                   // the ring is that of the write address
                            | (other as u32) << 11      // starts the other channel at its end
                            | u32::from(request) << 15
                            | 1 << 21, // no interrupt
                    )
                });
            }
        }
        let [first, _] = self.channels;
        // Safety: both channels are set up.
        unsafe { dma().multi_chan_trigger().write(|w| w.bits(1 << first)) };
    }

    /// Stops the copying.
    pub(crate) fn stop(&mut self) {
        let mut mask = 0;
        for channel in self.channels {
            // Safety: disables the channel, so that an abort does not start the other one.
            unsafe { dma().ch(channel).ch_al1_ctrl().write(|w| w.bits(0)) };
            mask |= 1 << channel;
        }
        // Safety: aborts both channels.
        unsafe { dma().chan_abort().write(|w| w.bits(mask)) };
        while dma().chan_abort().read().bits() & mask != 0 {}
    }

    /// Returns the number of copied values since the start, modulo 2³².
    pub(crate) fn received(&self) -> u32 {
        let mut count = self.count();
        // While the channels alternate, neither runs for a moment, and the count may be read from the wrong channel.
        loop {
            let again = self.count();
            if again.wrapping_sub(count) < WORDS {
                return again;
            }
            count = again;
        }
    }

    fn count(&self) -> u32 {
        let [first, second] = self.channels.map(|channel| dma().ch(channel));
        if second.ch_ctrl_trig().read().busy().bit_is_set() {
            VALUES_PER_TURN.wrapping_add(VALUES_PER_TURN - second.ch_trans_count().read().bits())
        } else {
            VALUES_PER_TURN - first.ch_trans_count().read().bits()
        }
    }

    /// Returns a value by its number, counted from the start.
    pub(crate) fn value(&self, number: u32) -> u32 {
        let at = ((number << self.size) % BYTES) as usize;
        let address = self.memory.0.get().cast::<u8>();
        // Safety: the address is within the ring and aligned to the size, and the value is read as a whole.
        unsafe {
            let address = address.add(at);
            if self.size == 2 {
                address.cast::<u32>().read_volatile()
            } else {
                address.cast::<u16>().read_volatile().into()
            }
        }
    }
}
