//! What the adapter requires of its hardware.

use crate::{BissSetting, FrameWords, SsiSetting, UartSetting};

/// The bus that is clocked, with its settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clocking {
    /// SSI.
    Ssi(SsiSetting),
    /// BiSS C.
    Biss(BissSetting),
}

/// A frame and the time at which it was latched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Time of the first falling clock edge in microseconds of the adapter's clock.
    pub t_us: u64,
    /// Bits of the frame.
    pub words: FrameWords,
}

/// The wires of an adapter and its clock.
///
/// A stream is paced by hardware: after [`start`](Self::start), a frame is clocked every period without any call, and
/// its words are kept until newer ones replace them.
pub trait Bus {
    /// Number of words of a stream that the hardware keeps.
    const CAPACITY: u32;

    /// Returns the time in microseconds since the adapter was started.
    fn now_us(&self) -> u64;

    /// Waits until a time in microseconds of the adapter's clock.
    fn wait_until(&mut self, t_us: u64);

    /// Selects the bus for the following frames. No stream is running.
    fn select(&mut self, clocking: Clocking);

    /// Clocks one frame. With `cdm`, the clock line stays low during the time-out of BiSS, which transmits a control bit
    /// of 1. The pause or time-out after the frame is not waited for.
    fn frame(&mut self, cdm: bool) -> Frame;

    /// Starts to clock frames at an interval in microseconds. Returns the time of the first one.
    fn start(&mut self, period_us: u32) -> u64;

    /// Ends the stream.
    fn stop(&mut self);

    /// Returns the number of words received since the start of the stream, modulo 2³².
    fn received(&self) -> u32;

    /// Returns a word of the stream by its number. It must be among the last [`CAPACITY`](Self::CAPACITY) words.
    fn word(&self, number: u32) -> u32;

    /// Number of conversions that the hardware keeps.
    const CONVERSIONS: u32;

    /// Starts to convert all analogue inputs in turn, without a pause. Returns the time of the first conversion, which is
    /// that of the sine. The cosine is the second one.
    fn start_conversions(&mut self) -> u64;

    /// Ends the conversions.
    fn stop_conversions(&mut self);

    /// Returns the number of conversions since their start, modulo 2³².
    fn converted(&self) -> u32;

    /// Returns a converted value by its number. It must be among the last [`CONVERSIONS`](Self::CONVERSIONS).
    fn conversion(&self, number: u32) -> u16;

    /// Returns whether a conversion was missed since their start.
    fn has_overrun(&self) -> bool;

    /// Measures the voltage before the switch of the supply, in millivolts.
    fn supply_millivolt(&mut self) -> u16;

    /// Switches the supply of the encoder.
    fn switch_supply(&mut self, on: bool);

    /// Returns whether the switch of the supply reports an overload.
    fn has_supply_fault(&mut self) -> bool;

    /// Sets up the serial line.
    fn configure_uart(&mut self, setting: UartSetting);

    /// Sends characters, given as their bits with the start bit lowest, and then receives. The hardware does both.
    fn begin_transfer(&mut self, characters: &[u32]);

    /// Returns whether all characters have been sent, and the driver is off.
    fn has_sent(&mut self) -> bool;

    /// Returns the time of the first start edge after the characters were sent.
    fn first_edge_us(&mut self) -> Option<u64>;

    /// Returns the number of received characters.
    fn received_characters(&mut self) -> usize;

    /// Returns the bits of a received character without the start bit, the last one highest.
    fn received_character(&mut self, at: usize) -> u32;

    /// Ends the reception.
    fn end_transfer(&mut self);
}
