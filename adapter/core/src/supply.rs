//! The switched encoder supply. The adapter does not generate the voltage. It measures the voltage at the input of the
//! switch, and switches on only if this is the requested voltage. The switch itself limits the current and reports an
//! overload.
//!
//! The supply is off at the start. Only a request or an overload switches it off. HELLO and the disconnection of the
//! host do not, because that would interrupt a write in progress.

use bridge_codec::{ErrorCode, SupplyFaults};

use crate::{Bus, Refusal};

/// State of the supply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Supply {
    is_on: bool,
    faults: SupplyFaults,
}

/// Range of permitted voltages, in millivolts.
const RANGE: core::ops::RangeInclusive<u16> = 4_500..=15_000;
/// Permitted difference between the measured and the requested voltage, in per cent. It includes the tolerance of the
/// voltage divider.
const TOLERANCE: u32 = 10;

impl Supply {
    pub(crate) const fn new() -> Self {
        Supply { is_on: false, faults: SupplyFaults::NONE }
    }

    pub(crate) const fn is_on(self) -> bool {
        self.is_on
    }

    pub(crate) const fn faults(self) -> SupplyFaults {
        self.faults
    }

    /// Switches the supply on or off. Returns the measured voltage in millivolts, or 0 if the supply is off.
    pub(crate) fn switch<B: Bus>(&mut self, bus: &mut B, on: bool, millivolt: u16) -> Result<u16, Refusal> {
        if !on {
            self.switch_off(bus);
            return Ok(0);
        }
        if !RANGE.contains(&millivolt) {
            return Err((ErrorCode::BAD_ARGUMENT, "4.5 to 15 V"));
        }
        let measured = bus.supply_millivolt();
        let deviation = u32::from(measured.abs_diff(millivolt));
        if deviation * 100 > u32::from(millivolt) * TOLERANCE {
            // The supply must not stay on with another voltage.
            self.switch_off(bus);
            return Err((ErrorCode::BAD_ARGUMENT, "the connected voltage is another one"));
        }
        self.faults = SupplyFaults::NONE;
        self.is_on = true;
        bus.switch_supply(true);
        Ok(measured)
    }

    /// Switches the supply off if the switch reports an overload.
    pub(crate) fn poll<B: Bus>(&mut self, bus: &mut B) {
        if self.is_on && bus.has_supply_fault() {
            self.switch_off(bus);
            self.faults = SupplyFaults::OVERLOAD;
        }
    }

    fn switch_off<B: Bus>(&mut self, bus: &mut B) {
        bus.switch_supply(false);
        self.is_on = false;
    }
}
