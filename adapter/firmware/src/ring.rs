//! Words of a stream in memory. The DMA copies them from the state machine without the processor and counts them, so that
//! none can be missed without being noticed.
//!
//! Two channels take turns, each for 2³¹ words, and start each other. Both write to the same ring, whose length divides
//! 2³¹.

use core::cell::UnsafeCell;

use rp2040_hal as hal;

use hal::pac::{DMA, RESETS};

/// Number of words in the ring.
pub(crate) const LENGTH: u32 = 8192;
/// Number of address bits in the ring.
const ADDRESS_BITS: u8 = 15;
/// Number of words for which a channel runs.
const TURN: u32 = 1 << 31;
const CHANNELS: [usize; 2] = [0, 1];

const _: () = assert!(LENGTH * 4 == 1 << ADDRESS_BITS && TURN % LENGTH == 0);

/// The words, at an address that the ring of the DMA requires.
#[repr(C, align(32768))]
struct Words(UnsafeCell<[u32; LENGTH as usize]>);

// Safety: the DMA writes them, and the processor only reads them, by volatile reads of whole words.
unsafe impl Sync for Words {}

static WORDS: Words = Words(UnsafeCell::new([0; LENGTH as usize]));

/// The channels of the DMA that fill the ring.
pub(crate) struct Ring {
    dma: DMA,
}

impl Ring {
    /// Takes the DMA out of reset.
    pub(crate) fn new(dma: DMA, resets: &mut RESETS) -> Self {
        resets.reset().modify(|_, w| w.dma().clear_bit());
        while resets.reset_done().read().dma().bit_is_clear() {}
        Ring { dma }
    }

    /// Starts to copy the words of a state machine's FIFO, whose requests have the given number.
    pub(crate) fn start(&mut self, fifo: *const u32, request: u8) {
        for (channel, other) in CHANNELS.into_iter().zip(CHANNELS.into_iter().rev()) {
            let registers = self.dma.ch(channel);
            // Safety: the channel reads a FIFO and writes to the ring, which is never freed.
            unsafe {
                registers.ch_read_addr().write(|w| w.bits(fifo as u32));
                registers.ch_write_addr().write(|w| w.bits(WORDS.0.get() as u32));
                registers.ch_trans_count().write(|w| w.bits(TURN));
                // Without starting it.
                registers.ch_al1_ctrl().write(|w| {
                    w.bits(
                        1 | 2 << 2                          // enabled, words of 32 bits
                            | 1 << 5                        // the write address advances
                            | u32::from(ADDRESS_BITS) << 6
                            | 1 << 10                       // the ring is that of the write address
                            | (other as u32) << 11          // starts the other channel at its end
                            | u32::from(request) << 15
                            | 1 << 21, // no interrupt
                    )
                });
            }
        }
        // Safety: both channels are set up.
        unsafe { self.dma.multi_chan_trigger().write(|w| w.bits(1)) };
    }

    /// Ends the copying.
    pub(crate) fn stop(&mut self) {
        for channel in CHANNELS {
            // Safety: disables the channel, so that an abort does not start the other one.
            unsafe { self.dma.ch(channel).ch_al1_ctrl().write(|w| w.bits(0)) };
        }
        // Safety: aborts both channels.
        unsafe { self.dma.chan_abort().write(|w| w.bits(0b11)) };
        while self.dma.chan_abort().read().bits() != 0 {}
    }

    /// Returns the number of words since the start, modulo 2³².
    pub(crate) fn received(&self) -> u32 {
        let mut count = self.count();
        // Between two turns neither channel runs for a moment, and the count may be that of the wrong one.
        loop {
            let again = self.count();
            if again.wrapping_sub(count) < LENGTH {
                return again;
            }
            count = again;
        }
    }

    fn count(&self) -> u32 {
        let [first, second] = CHANNELS.map(|channel| self.dma.ch(channel));
        if second.ch_ctrl_trig().read().busy().bit_is_set() {
            TURN.wrapping_add(TURN - second.ch_trans_count().read().bits())
        } else {
            TURN - first.ch_trans_count().read().bits()
        }
    }

    /// Returns a word by its number since the start.
    pub(crate) fn word(&self, number: u32) -> u32 {
        let at = (number % LENGTH) as usize;
        // Safety: the index is below the length, and the word is read as a whole.
        unsafe { WORDS.0.get().cast::<u32>().add(at).read_volatile() }
    }
}
