//! Registers outside the data areas (manual, appendix 9.1).

use super::Encoder;
use crate::devices::biss::protocol::{EdsBank, Temperature, WarningRegister};

/// Wiegand pulse voltages measured in production, in tenths of a volt.
const PRODUCTION_PULSES: [u8; 4] = [64, 60, 64, 59];

impl Encoder {
    pub(super) fn direct_register(&self, address: u8) -> u8 {
        let [n0, n1, n2, n3] = self.serial_number.to_be_bytes();
        let diagnoses = self.firmware >= Self::MIN_DIAGNOSTICS_FIRMWARE;
        match address {
            0x40 => self.bank,
            0x41 => EdsBank::Common.kit_number(),
            0x42 => 0x61,
            0x43 => 0x29,
            0x44 => n0,
            0x45 => n1,
            0x46 => n2,
            0x47 => n3,
            0x66 => Temperature::from_celsius(self.celsius).byte(),
            0x68 if diagnoses => self.errors.byte(),
            0x69 if diagnoses && self.hot => WarningRegister::TEMPERATURE.byte(),
            0x6A => self.mode.byte(),
            0x6B => self.password,
            0x6E if self.firmware >= Self::MIN_FILTER_FIRMWARE => self.flash.filter.byte(),
            0x74 => self.firmware.major,
            0x75 => self.firmware.minor,
            0x76 => self.firmware.patch,
            0x78 | 0x79 | 0x7D => 0x01,
            0x7A => 0x68,
            0x7B => 0x11,
            0x7E => b'F',
            0x7F => b'r',
            _ => 0,
        }
    }

    pub(super) fn bank_0_register(&self, offset: u8) -> u8 {
        let of = |values: &[u8; 4], first: u8| values.get(usize::from(offset - first)).copied().unwrap_or(0);
        match offset {
            0x00 => self.calibration.command,
            0x01 => self.calibration.status.byte(),
            0x06 => self.wiegand.command,
            0x07 => self.wiegand.status.byte(),
            0x08 => self.wiegand.error,
            0x09..=0x0C => of(&self.wiegand.result, 0x09),
            0x0D..=0x10 => of(&PRODUCTION_PULSES, 0x0D),
            0x11..=0x14 => of(&self.saved_wiegand, 0x11),
            0x1A => self.data.command,
            0x1B => self.data.status().byte(),
            0x24 => self.filter.command,
            0x25 => self.filter.status.byte(),
            _ => 0,
        }
    }

    pub(super) fn preset_register(&self, offset: u8) -> u8 {
        match offset {
            0x00 => self.preset.command,
            0x01 => self.preset.status.byte(),
            0x02..=0x07 => self.preset.byte(usize::from(offset - 2)).unwrap_or(0),
            _ => 0,
        }
    }
}
