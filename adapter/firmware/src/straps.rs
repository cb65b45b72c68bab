//! Strap pins, which indicate the parts fitted on the board. A fitted part connects its pin to ground.

use bridge_codec::Capabilities;
use embedded_hal::digital::InputPin as _;
use rp2040_hal as hal;

use hal::gpio::bank0::{Gpio18, Gpio19, Gpio20};
use hal::gpio::{FunctionNull, Pin, PullDown};

/// Returns the capabilities of this board. Every board has SSI and BiSS.
pub(crate) fn capabilities(
    serial: Pin<Gpio18, FunctionNull, PullDown>,
    supply: Pin<Gpio19, FunctionNull, PullDown>,
    analog: Pin<Gpio20, FunctionNull, PullDown>,
) -> Capabilities {
    let digital =
        Capabilities::SSI.union(Capabilities::BISS).union(Capabilities::BISS_REGISTERS).union(Capabilities::STATUS);
    let (mut serial, mut supply) = (serial.into_pull_up_input(), supply.into_pull_up_input());
    let mut analog = analog.into_pull_up_input();
    // The pull-up needs a moment to take effect.
    cortex_m::asm::delay(1_000);
    let parts = [
        (serial.is_low() == Ok(true), Capabilities::UART),
        (supply.is_low() == Ok(true), Capabilities::SUPPLY),
        (analog.is_low() == Ok(true), Capabilities::ANALOG.union(Capabilities::ANALOG_SKEW)),
    ];
    parts.into_iter().filter(|(is_built, _)| *is_built).fold(digital, |all, (_, part)| all.union(part))
}
