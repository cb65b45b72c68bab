//! The non-volatile memory and its write count. The manual limits the encoder to 1000 writes in its lifetime (manual
//! 6.1).

use crate::devices::biss::protocol::{PositionFilter, PresetValue};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flash {
    pub(super) motor_data: Vec<u8>,
    pub(super) oem_data: Vec<u8>,
    pub(super) preset: PresetValue,
    pub(super) filter: PositionFilter,
    /// Result of the Wiegand test in tenths of a volt: the average, and the average minus four standard deviations,
    /// first clockwise and then counterclockwise.
    pub(super) wiegand: [u8; 4],
    pub(super) calibrated: bool,
    pub(super) cycles: u32,
}

impl Flash {
    /// Size in bytes of a data area, which has 32 banks.
    pub(super) const AREA_BYTES: usize = 32 * 64;

    /// Creates a flash with factory content and the given number of write cycles.
    pub(super) fn factory_default(cycles: u32) -> Self {
        Flash {
            motor_data: vec![0; Self::AREA_BYTES],
            oem_data: vec![0; Self::AREA_BYTES],
            preset: PresetValue::default(),
            filter: PositionFilter::Balanced,
            wiegand: [0; 4],
            calibrated: true,
            cycles,
        }
    }

    pub fn motor_data(&self) -> &[u8] {
        &self.motor_data
    }

    pub fn oem_data(&self) -> &[u8] {
        &self.oem_data
    }

    pub const fn preset(&self) -> PresetValue {
        self.preset
    }

    /// Returns the filter that takes effect after a restart.
    pub const fn filter(&self) -> PositionFilter {
        self.filter
    }

    /// Returns whether there is a calibration table, either from the factory or from a calibration run.
    pub const fn is_calibrated(&self) -> bool {
        self.calibrated
    }

    pub const fn write_cycles(&self) -> u32 {
        self.cycles
    }
}
