//! The non-volatile memory and its write count, limited to 1000 writes over the encoder's lifetime (manual 6.1).

use crate::devices::biss::protocol::{PositionFilter, PresetValue};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flash {
    pub(super) motor_data: Vec<u8>,
    pub(super) oem_data: Vec<u8>,
    pub(super) preset: PresetValue,
    pub(super) filter: PositionFilter,
    /// Wiegand test result in tenths of a volt. Each direction has an average and the average minus four standard
    /// deviations. The clockwise values come first.
    pub(super) wiegand: [u8; 4],
    pub(super) calibrated: bool,
    pub(super) cycles: u32,
}

impl Flash {
    /// Size of each data area in bytes: 32 banks.
    pub(super) const AREA: usize = 32 * 64;

    /// Creates the factory content after the given number of write cycles.
    pub(super) fn factory_default(cycles: u32) -> Self {
        Flash {
            motor_data: vec![0; Self::AREA],
            oem_data: vec![0; Self::AREA],
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

    /// Returns whether a calibration table exists, from the factory or from a run.
    pub const fn is_calibrated(&self) -> bool {
        self.calibrated
    }

    pub const fn write_cycles(&self) -> u32 {
        self.cycles
    }
}
