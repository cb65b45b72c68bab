//! Pins of the Pico. The page `docs/adapter.md` has their wiring.

/// Clock of SSI and MA of BiSS, to the driver.
pub(crate) const CLOCK: u8 = 2;
/// Data of SSI and SLO of BiSS, from the receiver.
pub(crate) const DATA: u8 = 3;
/// Serial line: to the driver, from the receiver, and direction (high: the driver is on).
pub(crate) const SERIAL_OUT: u8 = 8;
pub(crate) const SERIAL_IN: u8 = 9;
pub(crate) const DIRECTION: u8 = 10;
/// Input of the converter with the voltage before the switch of the supply, by way of a divider.
pub(crate) const SUPPLY_INPUT: u32 = 2;
/// Connects the two machines of BiSS. Nothing must be wired to it.
pub(crate) const DONE: u8 = 5;
