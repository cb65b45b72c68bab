//! The serial line, which uses two state machines of PIO 1 and four DMA channels. The processor only starts a transfer
//! and reads its result, so the characters and the time of the reply do not depend on the main loop.

use core::cell::UnsafeCell;

use adapter_core::UartSetting;
use rp2040_hal as hal;

use hal::pac::{PIO1, TIMER};
use hal::pio::{SM1, SM2};

use super::machine::Machine;
use crate::ring::dma;

/// Maximum number of characters in a request or a reply.
const LENGTH: usize = 512;
/// DMA channels for sending, for the mark of the first edge, for the time of this edge, and for the received
/// characters.
const SEND_CHANNEL: usize = 4;
const EDGE_MARK_CHANNEL: usize = 5;
const EDGE_TIME_CHANNEL: usize = 6;
const RECEIVE_CHANNEL: usize = 7;
/// Number of the DMA request signal that is always active.
const ALWAYS: u8 = 63;
/// Placeholder for a character that has not arrived. It is distinct, because received characters use only the highest
/// bits of a word.
const NO_CHARACTER: u32 = 1;

/// Memory shared by the DMA and the processor.
struct Shared<const N: usize>(UnsafeCell<[u32; N]>);

// Safety: the processor writes this memory only while no channel runs, and reads it with volatile reads of whole words.
unsafe impl<const N: usize> Sync for Shared<N> {}

static SENT: Shared<LENGTH> = Shared(UnsafeCell::new([0; LENGTH]));
static RECEIVED: Shared<LENGTH> = Shared(UnsafeCell::new([0; LENGTH]));
/// The mark of the first edge, whose value has no meaning, and the lower half of the edge's time.
static FIRST_EDGE: Shared<2> = Shared(UnsafeCell::new([0; 2]));

impl<const N: usize> Shared<N> {
    fn address(&self) -> *mut u32 {
        self.0.get().cast()
    }

    fn read(&self, at: usize) -> u32 {
        // Safety: the index is within the memory.
        if at < N { unsafe { self.address().add(at).read_volatile() } } else { 0 }
    }

    fn write(&self, at: usize, word: u32) {
        if at < N {
            // Safety: the index is within the memory.
            unsafe { self.address().add(at).write_volatile(word) };
        }
    }
}

/// Sender and receiver of the serial line.
pub(super) struct Serial {
    pub(super) sender: Machine<(PIO1, SM1)>,
    pub(super) receiver: Machine<(PIO1, SM2)>,
    /// Placeholder for the time of an edge that has not occurred yet: a time in the past.
    no_edge: u32,
    /// Delay of the edge's mark in microseconds.
    mark_delay_us: u32,
    /// Number of characters received so far.
    count: usize,
}

impl Serial {
    pub(super) fn new(sender: Machine<(PIO1, SM1)>, receiver: Machine<(PIO1, SM2)>) -> Self {
        Serial { sender, receiver, no_edge: 0, mark_delay_us: 0, count: 0 }
    }

    pub(super) fn configure(&mut self, setting: UartSetting) {
        let (whole, fraction) = ((setting.divisor >> 8) as u16, setting.divisor as u8);
        self.mark_delay_us = setting.mark_delay_us();
        self.sender.set_divisor_256(whole, fraction);
        self.receiver.set_divisor_256(whole, fraction);
        // At most eleven bits. The receiver omits the start bit.
        let bits = setting.bits() as u8;
        self.sender.set_y(bits - 1);
        self.receiver.set_y(bits - 2);
    }

    /// Starts sending characters, after which the hardware receives. `now` is the lower half of the clock.
    pub(super) fn begin(&mut self, characters: &[u32], now: u32) {
        self.end();
        (self.no_edge, self.count) = (now.wrapping_sub(1), 0);
        FIRST_EDGE.write(1, self.no_edge);
        for at in 0..LENGTH {
            RECEIVED.write(at, NO_CHARACTER);
        }
        let count = characters.len().min(LENGTH);
        for (at, word) in characters.iter().take(count).enumerate() {
            SENT.write(at, *word);
        }
        let (fifo, request) = self.receiver.output();
        // Each channel starts the next one: the mark, its time, and the characters.
        let timer = timer_address();
        channel(
            EDGE_MARK_CHANNEL,
            fifo as u32,
            FIRST_EDGE.address(),
            1,
            CopyOptions { request, chain: EDGE_TIME_CHANNEL, advance: 0 },
        );
        channel(
            EDGE_TIME_CHANNEL,
            timer,
            FIRST_EDGE.address().wrapping_add(1),
            1,
            CopyOptions { request: ALWAYS, chain: RECEIVE_CHANNEL, advance: 0 },
        );
        let characters = CopyOptions { request, chain: RECEIVE_CHANNEL, advance: WRITES };
        channel(RECEIVE_CHANNEL, fifo as u32, RECEIVED.address(), LENGTH as u32, characters);
        let (fifo, request) = self.sender.input();
        let words = CopyOptions { request, chain: SEND_CHANNEL, advance: READS };
        channel(SEND_CHANNEL, SENT.address() as u32, fifo.cast_mut(), count as u32, words);
        // Safety: the channels are set up. The channels of the time and the characters are started by chaining.
        unsafe { dma().multi_chan_trigger().write(|w| w.bits(1 << EDGE_MARK_CHANNEL | 1 << SEND_CHANNEL)) };
    }

    /// Returns whether all characters have been sent and the driver is off.
    pub(super) fn has_sent(&mut self) -> bool {
        !is_busy(SEND_CHANNEL) && self.sender.has_consumed_all() && self.sender.is_at_start()
    }

    /// Returns the lower half of the first edge's time, or `None` if there was no edge yet.
    pub(super) fn first_edge(&self) -> Option<u32> {
        Some(FIRST_EDGE.read(1)).filter(|time| *time != self.no_edge).map(|time| time.wrapping_sub(self.mark_delay_us))
    }

    pub(super) fn received(&mut self) -> usize {
        while self.count < LENGTH && RECEIVED.read(self.count) != NO_CHARACTER {
            self.count += 1;
        }
        self.count
    }

    pub(super) fn character(&self, at: usize) -> u32 {
        RECEIVED.read(at)
    }

    /// Ends a transfer and prepares the receiver for the next one.
    pub(super) fn end(&mut self) {
        let channels = [SEND_CHANNEL, EDGE_MARK_CHANNEL, EDGE_TIME_CHANNEL, RECEIVE_CHANNEL];
        let mask = channels.iter().fold(0, |mask, channel| mask | 1 << channel);
        for channel in channels {
            // Safety: disables the channel, so that an abort does not start the next one.
            unsafe { dma().ch(channel).ch_al1_ctrl().write(|w| w.bits(0)) };
        }
        // Safety: aborts the channels.
        unsafe { dma().chan_abort().write(|w| w.bits(mask)) };
        while dma().chan_abort().read().bits() & mask != 0 {}
        self.sender.restart();
        self.sender.set_output_high();
        self.receiver.restart();
        self.receiver.clear_isr();
        self.receiver.discard();
    }
}

/// Flags that advance the read address and the write address during a copy.
const READS: u32 = 1 << 4;
const WRITES: u32 = 1 << 5;

/// Options of a DMA copy.
struct CopyOptions {
    request: u8,
    /// Channel to start when the copy ends, or the channel's own number to start none.
    chain: usize,
    advance: u32,
}

/// Sets up a channel that copies words, without starting it.
fn channel(number: usize, from: u32, to: *mut u32, count: u32, options: CopyOptions) {
    let registers = dma().ch(number);
    // Safety: the addresses are a FIFO, the timer, and memory that is never freed and has room for the count.
    unsafe {
        registers.ch_read_addr().write(|w| w.bits(from));
        registers.ch_write_addr().write(|w| w.bits(to as u32));
        registers.ch_trans_count().write(|w| w.bits(count));
        let bits =
            1 | 2 << 2 | options.advance | (options.chain as u32) << 11 | u32::from(options.request) << 15 | 1 << 21;
        registers.ch_al1_ctrl().write(|w| w.bits(bits));
    }
}

fn is_busy(channel: usize) -> bool {
    dma().ch(channel).ch_ctrl_trig().read().busy().bit_is_set()
}

/// Returns the address of the lower half of the clock.
fn timer_address() -> u32 {
    // Safety: only the address is taken.
    unsafe { (*TIMER::ptr()).timerawl().as_ptr() as u32 }
}
