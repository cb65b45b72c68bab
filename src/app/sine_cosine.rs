//! Capability used by Signals: a device that provides sine and cosine in addition to its absolute position.

use super::action::Action;
use super::studio::SessionId;
use super::texts::Text;

/// Position and signals, read while the shaft was at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineCosineReading {
    /// The absolute position, in steps of 1/32 period.
    pub position: u32,
    pub valid: bool,
    /// Sine and cosine in volts, if the device provides them.
    pub signals: Option<SineCosineVolts>,
}

/// Sine and cosine, each relative to its reference wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineCosineVolts {
    pub sine_v: f64,
    pub cosine_v: f64,
}

/// The range of an encoder that turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SineCosineRange {
    /// Signal periods per revolution.
    pub periods: u32,
    pub turns: u32,
}

/// The device that a reading is from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SineCosineOrigin {
    pub session: SessionId,
    /// Serial number, if it was read.
    pub serial_number: Option<String>,
    /// Range, if known and rotary.
    pub range: Option<SineCosineRange>,
}

/// Device whose sine and cosine can be read at rest.
pub trait SineCosineSource {
    fn is_ready(&self) -> bool;

    fn read_action(&self) -> Action;

    fn origin(&self) -> SineCosineOrigin;

    /// Returns the requested reading, or the reason why there is none.
    fn take_reading(&mut self) -> Option<Result<SineCosineReading, Text>>;
}
