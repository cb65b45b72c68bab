//! Interface for devices that provide sine and cosine signals in addition to an absolute position. Used by the Signals
//! tool.

use super::action::Action;
use super::studio::SessionId;
use super::texts::Text;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineCosineReading {
    /// Absolute position in steps of 1/32 period.
    pub position: u32,
    pub valid: bool,
    /// Sine and cosine voltages, if the device provides them.
    pub signals: Option<SineCosineVolts>,
}

/// Voltages of the sine and cosine signals, each relative to its reference wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineCosineVolts {
    pub sine_v: f64,
    pub cosine_v: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SineCosineRange {
    pub periods: u32,
    pub turns: u32,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SineCosineOrigin {
    pub session: SessionId,
    /// Serial number, or `None` if it has not been read.
    pub serial_number: Option<String>,
    /// Measuring range, or `None` if it is unknown or not rotary.
    pub range: Option<SineCosineRange>,
}

pub trait SineCosineSource {
    fn is_ready(&self) -> bool;

    fn read_action(&self) -> Action;

    fn origin(&self) -> SineCosineOrigin;

    /// Takes the requested reading, or the reason why it failed. Returns `None` if there is no new reading.
    fn take_reading(&mut self) -> Option<Result<SineCosineReading, Text>>;
}
