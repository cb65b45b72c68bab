//! Interface to the adapter's hardware.

use crate::{BissSetting, FrameWords, SsiSetting, UartSetting};

/// The selected bus, SSI or BiSS, with its settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clocking {
    /// SSI.
    Ssi(SsiSetting),
    /// BiSS C.
    Biss(BissSetting),
}

/// A frame, and the time at which the encoder latched its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Time of the first falling clock edge in microseconds, on the adapter's clock.
    pub t_us: u64,
    /// Bits of the frame.
    pub words: FrameWords,
}

/// The hardware of an adapter: its lines, its inputs and its clock.
///
/// The hardware paces a stream: after [`start`](Self::start), one frame is clocked per period without further calls.
/// The words are kept until newer ones replace them.
pub trait Bus {
    /// Number of words of a stream that the hardware keeps.
    const CAPACITY: u32;

    /// Returns the time in microseconds since the adapter was started.
    fn now_us(&self) -> u64;

    /// Waits until the adapter's clock reaches a time, given in microseconds.
    fn wait_until(&mut self, t_us: u64);

    /// Selects the bus and settings for the following frames. Must not be called during a stream.
    fn select(&mut self, clocking: Clocking);

    /// Clocks one frame, but does not wait for the pause or time-out after it. If `cdm` is set, the clock line stays
    /// low during the BiSS time-out, which sends a control bit of 1.
    fn frame(&mut self, cdm: bool) -> Frame;

    /// Starts a stream that clocks one frame per interval, given in microseconds. Returns the time of the first frame.
    fn start(&mut self, period_us: u32) -> u64;

    /// Ends the stream.
    fn stop(&mut self);

    /// Returns the number of words received since the start of the stream, modulo 2³².
    fn received(&self) -> u32;

    /// Returns a word of the stream by its number. Only the last [`CAPACITY`](Self::CAPACITY) words are available.
    fn word(&self, number: u32) -> u32;

    /// Number of conversions that the hardware keeps.
    const CONVERSIONS: u32;

    /// Starts converting all analogue inputs in turn without a pause. The sine is first, and the cosine is second.
    /// Returns the time of the first conversion.
    fn start_conversions(&mut self) -> u64;

    /// Ends the conversions.
    fn stop_conversions(&mut self);

    /// Returns the number of conversions since their start, modulo 2³².
    fn converted(&self) -> u32;

    /// Returns a converted value by its number. Only the last [`CONVERSIONS`](Self::CONVERSIONS) values are available.
    fn conversion(&self, number: u32) -> u16;

    /// Returns whether a conversion was missed since the conversions were started.
    fn has_overrun(&self) -> bool;

    /// Measures the voltage at the input of the supply switch, in millivolts.
    fn supply_millivolt(&mut self) -> u16;

    /// Switches the encoder supply on or off.
    fn switch_supply(&mut self, on: bool);

    /// Returns whether the supply switch reports an overload.
    fn has_supply_fault(&mut self) -> bool;

    /// Configures the serial line.
    fn configure_uart(&mut self, setting: UartSetting);

    /// Starts sending characters, after which the hardware receives without further calls. Each character is given as
    /// its bits, with the start bit lowest.
    fn begin_transfer(&mut self, characters: &[u32]);

    /// Returns whether all characters have been sent and the driver is off.
    fn has_sent(&mut self) -> bool;

    /// Returns the time at which the reply's first start bit began, or `None` if it has not begun yet.
    fn first_edge_us(&mut self) -> Option<u64>;

    /// Returns the number of received characters.
    fn received_characters(&mut self) -> usize;

    /// Returns the bits of a received character without the start bit. The bit received last is the highest.
    fn received_character(&mut self, at: usize) -> u32;

    /// Ends the reception.
    fn end_transfer(&mut self);
}
