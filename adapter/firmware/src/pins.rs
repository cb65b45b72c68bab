//! Pins of the Pico. For the wiring, see `docs/adapter.md`.

/// Output to the driver: clock of SSI, and MA of BiSS.
pub(crate) const CLOCK: u8 = 2;
/// Input from the receiver: data of SSI, and SLO of BiSS.
pub(crate) const DATA: u8 = 3;
/// Serial line: to the driver, from the receiver, and direction (high: the driver is on).
pub(crate) const SERIAL_OUT: u8 = 8;
pub(crate) const SERIAL_IN: u8 = 9;
pub(crate) const DIRECTION: u8 = 10;
/// Converter input that measures the input voltage of the supply switch through a divider.
pub(crate) const SUPPLY_INPUT: u32 = 2;
/// Signal between the two BiSS state machines. The pin must not be connected.
pub(crate) const DONE: u8 = 5;
