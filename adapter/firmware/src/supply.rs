//! The switch for the encoder supply: its pins and its input voltage.

use embedded_hal::digital::{InputPin as _, OutputPin as _};
use rp2040_hal as hal;

use hal::gpio::bank0::{Gpio14, Gpio15};
use hal::gpio::{FunctionNull, FunctionSio, Pin, PinState, PullDown, PullNone, PullUp, SioInput, SioOutput};

/// Input voltage of the divider, in millivolts, at the full scale of the ADC. The divider divides by six.
const FULL_SCALE_MILLIVOLT: u32 = 6 * 3_300;

/// The pins of the supply switch. A resistor keeps the switch off until the firmware drives its pin.
pub(crate) struct Switch {
    enable: Pin<Gpio14, FunctionSio<SioOutput>, PullNone>,
    /// Fault pin, which the switch pulls low during an overload.
    fault: Pin<Gpio15, FunctionSio<SioInput>, PullUp>,
}

impl Switch {
    /// Sets up the pins. The switch is off.
    pub(crate) fn new(enable: Pin<Gpio14, FunctionNull, PullDown>, fault: Pin<Gpio15, FunctionNull, PullDown>) -> Self {
        let enable: Pin<_, _, PullNone> = enable.into_push_pull_output_in_state(PinState::Low).into_pull_type();
        Switch { enable, fault: fault.into_pull_up_input() }
    }

    pub(crate) fn set(&mut self, on: bool) {
        let Ok(()) = self.enable.set_state(on.into());
    }

    pub(crate) fn has_fault(&mut self) -> bool {
        let Ok(is_low) = self.fault.is_low();
        is_low
    }
}

/// Converts an ADC value to the input voltage of the divider in millivolts.
pub(crate) fn millivolt(value: u16) -> u16 {
    // At most 19 800.
    (u32::from(value) * FULL_SCALE_MILLIVOLT / 4096) as u16
}
