//! The content that survives a loss of power, and the number of its writes: 1000 in a lifetime (manual 6.1).

use crate::devices::biss::protocol::{Filter, PresetValue};

/// The flash of a virtual encoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flash {
    pub(super) motor_data: Vec<u8>,
    pub(super) oem_data: Vec<u8>,
    pub(super) preset: PresetValue,
    pub(super) filter: Filter,
    /// Average and average less four standard deviations, clockwise and counterclockwise, in tenths of a volt.
    pub(super) wiegand: [u8; 4],
    pub(super) calibrated: bool,
    pub(super) cycles: u32,
}

impl Flash {
    /// Bytes of each area: 32 banks.
    pub(super) const AREA: usize = 32 * 64;

    /// Creates a memory as delivered, after this many write cycles.
    pub(super) fn delivered(cycles: u32) -> Self {
        Flash {
            motor_data: vec![0; Self::AREA],
            oem_data: vec![0; Self::AREA],
            preset: PresetValue::default(),
            filter: Filter::Balanced,
            wiegand: [0; 4],
            calibrated: true,
            cycles,
        }
    }

    /// Returns the banks 04h…23h.
    pub fn motor_data(&self) -> &[u8] {
        &self.motor_data
    }

    /// Returns the banks 24h…43h.
    pub fn oem_data(&self) -> &[u8] {
        &self.oem_data
    }

    pub const fn preset(&self) -> PresetValue {
        self.preset
    }

    /// Returns the filter that is in force after a restart.
    pub const fn filter(&self) -> Filter {
        self.filter
    }

    /// Returns whether the table of the calibration is there, from the factory or from a run.
    pub const fn is_calibrated(&self) -> bool {
        self.calibrated
    }

    pub const fn cycles(&self) -> u32 {
        self.cycles
    }
}
