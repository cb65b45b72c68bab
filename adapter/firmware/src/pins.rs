//! Pins of the Pico. The wiring is described in `docs/adapter.md`.

/// Clock output to the line driver (SSI clock, BiSS MA).
pub(crate) const CLOCK: u8 = 2;
/// Data input from the line receiver (SSI data, BiSS SLO).
pub(crate) const DATA: u8 = 3;
/// Serial line: output to the driver, input from the receiver, and direction (high enables the driver).
pub(crate) const SERIAL_OUT: u8 = 8;
pub(crate) const SERIAL_IN: u8 = 9;
pub(crate) const DIRECTION: u8 = 10;
/// ADC input that measures the voltage at the input of the supply switch, through a divider.
pub(crate) const SUPPLY_INPUT: u32 = 2;
/// Signal between the two state machines of BiSS. The pin must not be connected.
pub(crate) const BISS_DONE_PIN: u8 = 5;
