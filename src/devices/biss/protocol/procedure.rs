//! The codes in the command and status registers of the guided procedures (manual 6.3 to 6.7). The addresses of these
//! registers are defined by the encoder's [description](super::Description).

use std::fmt;

/// A procedure that runs in a device mode of the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProcedureKind {
    /// Test of the Wiegand sensor (manual 6.3).
    WiegandTest,
    /// Singleturn calibration (manual 6.4).
    Calibration,
    /// Writing OEM data and EDS motor data (manual 6.5).
    DataWrite,
    /// Selection of the position filter (manual 6.6).
    FilterSelection,
    /// Setting the position to a saved preset value (manual 6.7).
    Preset,
}

impl ProcedureKind {
    /// All procedures, in the manual's order.
    pub const ALL: [ProcedureKind; 5] = [
        ProcedureKind::WiegandTest,
        ProcedureKind::Calibration,
        ProcedureKind::DataWrite,
        ProcedureKind::FilterSelection,
        ProcedureKind::Preset,
    ];
}

/// Defines an enum for the codes of a register. Unknown codes are preserved.
macro_rules! codes {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $code:literal $text:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name {
            $($(#[$doc])* $variant,)*
            /// Code that is not in the manual.
            Unknown(u8),
        }

        impl $name {
            /// All codes in the manual with their names, in the manual's order.
            pub const TABLE: &'static [(u8, &'static str)] = &[$(($code, $text),)*];

            /// Decodes a register value.
            pub const fn from_byte(byte: u8) -> Self {
                match byte {
                    $($code => $name::$variant,)*
                    _ => $name::Unknown(byte),
                }
            }

            /// Returns the register value of the code.
            pub const fn byte(self) -> u8 {
                match self {
                    $($name::$variant => $code,)*
                    $name::Unknown(byte) => byte,
                }
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let text = match self {
                    $($name::$variant => $text,)*
                    $name::Unknown(_) => "unknown code",
                };
                write!(f, "0x{:02X} {text}", self.byte())
            }
        }
    };
}

codes! {
    /// Codes for the command register of the Wiegand test (bank 0, 06h).
    WiegandCommand {
        /// Collects pulses while the motor runs clockwise.
        StartClockwise = 0x01 "start clockwise",
        /// Collects pulses while the motor runs counterclockwise.
        StartCounterclockwise = 0x02 "start counterclockwise",
        /// Ends the test. This is allowed at any time.
        Stop = 0x03 "finish test",
        /// Stores the result, which becomes visible after a restart.
        Save = 0x05 "save result",
    }
}

codes! {
    /// Codes in the status register of the Wiegand test (bank 0, 07h).
    WiegandStatus {
        /// No test is running.
        Stopped = 0x00 "test stopped",
        /// Pulses are being collected in the first direction.
        Clockwise = 0x01 "pulse collection active, clockwise",
        /// The motor must now reverse its direction.
        WaitForDirection = 0x03 "wait for change of motor rotation direction",
        /// Pulses are being collected in the second direction.
        Counterclockwise = 0x04 "pulse collection active, counterclockwise",
        /// The test is complete in both directions.
        Complete = 0x06 "test complete",
        /// The test failed. The error code in bank 0, register 08h, states the reason.
        Failed = 0x07 "test failed",
        /// The encoder has detected that the motor turns in the wrong direction.
        WrongDirection = 0x30 "wrong motor rotation direction",
    }
}

codes! {
    /// Codes for the command register of the calibration (bank 0, 00h).
    CalibrationCommand {
        /// Starts the first run, with the motor turning counterclockwise.
        StartCounterclockwise = 0x01 "start counterclockwise",
        /// Starts the second run, with the motor turning clockwise. If the run succeeds, the table is saved
        /// automatically. If it fails, the table is lost.
        StartClockwise = 0x02 "start clockwise",
    }
}

codes! {
    /// Codes in the status register of the calibration (bank 0, 01h).
    CalibrationStatus {
        /// The calibration has not started.
        Idle = 0x00 "not started",
        /// A run is in progress.
        Running = 0x01 "calibration running",
        /// The first run is complete.
        CounterclockwiseDone = 0x02 "calibration finished, counterclockwise",
        /// The second run is complete and the table has been saved.
        ClockwiseDone = 0x22 "calibration finished, clockwise",
        /// The motor turns in the wrong direction.
        WrongDirection = 0x30 "wrong rotation direction",
        /// The temperature is outside the range from 25 to 40 °C.
        Temperature = 0x31 "temperature out of range",
        /// The motor speed is outside the range from 300 to 700 rpm.
        Speed = 0x32 "motor speed out of range",
        /// The calibration failed for an unknown reason.
        Failed = 0x33 "calibration failure",
    }
}

codes! {
    /// Codes for the command register of the data write (bank 0, 1Ah).
    DataCommand {
        /// Opens banks 04h to 23h for writing.
        OpenMotorData = 0x01 "get write access to EDS motor data",
        /// Opens banks 24h to 43h for writing.
        OpenOemData = 0x02 "get write access to OEM data",
        /// Writes the entered values to flash.
        Save = 0x03 "save data",
        /// Discards the entered values.
        Cancel = 0x04 "cancel write access",
    }
}

codes! {
    /// Codes in the status register of the data write (bank 0, 1Bh).
    DataStatus {
        /// Write access is closed and may be requested.
        Closed = 0x00 "wait for write access",
        /// Data may be entered and saved.
        Open = 0x01 "wait for save command",
    }
}

codes! {
    /// Codes for the command register of the filter selection (bank 0, 24h).
    FilterCommand {
        /// Requests write access.
        Open = 0x01 "get write access",
        /// Saves the selected filter and restarts.
        Save = 0x02 "save filter selection",
        /// Selects [`PositionFilter::Balanced`](super::PositionFilter).
        Balanced = 0x03 "balanced filter",
        /// Selects [`PositionFilter::Dynamic`](super::PositionFilter).
        Dynamic = 0x04 "dynamic filter",
    }
}

codes! {
    /// Codes in the status register of the filter selection (bank 0, 25h).
    FilterStatus {
        /// Write access is closed and may be requested.
        Closed = 0x00 "wait for write access",
        /// The filter selection may be saved.
        WaitForSave = 0x01 "wait for save command",
        /// A filter may be selected.
        WaitForValue = 0x02 "wait for filter",
    }
}

codes! {
    /// Codes for the command register of the preset (bank 1, 00h).
    PresetCommand {
        /// Sets the shaft position to the stored preset value and restarts.
        Both = 0x01 "perform preset, singleturn and multiturn",
        /// Allows a preset value to be entered.
        Edit = 0x02 "enable preset value edit",
        /// Saves the preset value and restarts.
        Save = 0x03 "save preset value",
        /// Sets only the singleturn position to the stored preset value and restarts.
        Singleturn = 0x04 "perform preset, singleturn",
        /// Sets only the multiturn position to the stored preset value and restarts.
        Multiturn = 0x05 "perform preset, multiturn",
    }
}

codes! {
    /// Codes in the status register of the preset (bank 1, 01h).
    PresetStatus {
        /// No preset value is expected.
        Idle = 0x00 "idle",
        /// The preset value may be entered.
        WaitForValue = 0x01 "wait for value",
    }
}

/// A preset value with a singleturn part and a multiturn part, each with three bytes, low byte first (bank 1, 02h to
/// 07h).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct PresetValue {
    singleturn: u32,
    multiturn: u32,
}

impl PresetValue {
    /// Number of registers occupied by a preset value.
    pub const BYTES: u8 = 6;
    /// Maximum singleturn or multiturn value.
    pub const MAX: u32 = (1 << 24) - 1;

    /// Creates a preset value, or returns `None` if a part exceeds 24 bits. The encoder's position may be narrower.
    pub const fn new(singleturn: u32, multiturn: u32) -> Option<Self> {
        if singleturn <= Self::MAX && multiturn <= Self::MAX {
            Some(PresetValue { singleturn, multiturn })
        } else {
            None
        }
    }

    /// Parses the register bytes in ascending order of address.
    pub const fn parse(bytes: [u8; 6]) -> Self {
        let [s0, s1, s2, m0, m1, m2] = bytes;
        PresetValue { singleturn: u32::from_le_bytes([s0, s1, s2, 0]), multiturn: u32::from_le_bytes([m0, m1, m2, 0]) }
    }

    /// Returns the register bytes in ascending order of address.
    pub const fn emit(self) -> [u8; 6] {
        let [s0, s1, s2, _] = self.singleturn.to_le_bytes();
        let [m0, m1, m2, _] = self.multiturn.to_le_bytes();
        [s0, s1, s2, m0, m1, m2]
    }

    /// Returns the position within the revolution.
    pub const fn singleturn(self) -> u32 {
        self.singleturn
    }

    /// Returns the number of revolutions.
    pub const fn multiturn(self) -> u32 {
        self.multiturn
    }
}

/// A voltage reported by the Wiegand test, in tenths of a volt (bank 0, 09h to 14h).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PulseVoltage(u8);

/// The result of a Wiegand test in both directions. Bank 0 holds the last result at 09h, the factory result at 0Dh, and
/// the saved result at 11h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WiegandResult {
    /// Average pulse voltage, clockwise.
    pub average_cw: PulseVoltage,
    /// Clockwise average minus four standard deviations.
    pub lowest_cw: PulseVoltage,
    /// Average pulse voltage, counterclockwise.
    pub average_ccw: PulseVoltage,
    /// Counterclockwise average minus four standard deviations.
    pub lowest_ccw: PulseVoltage,
}

impl PulseVoltage {
    /// Limit of 5.3 V for the average minus four standard deviations.
    pub const LIMIT: PulseVoltage = PulseVoltage(53);

    /// Creates a voltage from tenths of a volt. Every byte is valid.
    pub const fn new(tenths: u8) -> Self {
        PulseVoltage(tenths)
    }

    /// Returns the raw register value.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the voltage in volts, 0 to 25.5.
    pub fn volts(self) -> f64 {
        f64::from(self.0) / 10.0
    }
}

impl WiegandResult {
    /// Number of revolutions in each direction during which pulses are collected (manual 6.3).
    pub const REVOLUTIONS: u16 = 515;

    /// Parses the four registers in ascending order of address.
    pub fn parse(bytes: [u8; 4]) -> Self {
        let [average_cw, lowest_cw, average_ccw, lowest_ccw] = bytes.map(PulseVoltage);
        WiegandResult { average_cw, lowest_cw, average_ccw, lowest_ccw }
    }

    /// Returns the four registers in ascending order of address.
    pub fn emit(&self) -> [u8; 4] {
        [self.average_cw, self.lowest_cw, self.average_ccw, self.lowest_ccw].map(PulseVoltage::byte)
    }

    /// Returns whether the results of both directions are above the limit.
    pub fn is_passed(&self) -> bool {
        self.lowest_cw > PulseVoltage::LIMIT && self.lowest_ccw > PulseVoltage::LIMIT
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Expected values for 270°, 180°, 90°, 1° and 0° at 17 bits from section 5.5 of the reference.
    #[test]
    fn published_preset_values_match() {
        for (singleturn, bytes) in [
            (98_304, [0x00, 0x80, 0x01]),
            (0, [0x00, 0x00, 0x00]),
            (0x1_0000, [0x00, 0x00, 0x01]),
            (0x8000, [0x00, 0x80, 0x00]),
            (364, [0x6C, 0x01, 0x00]),
        ] {
            let value = PresetValue::new(singleturn, 0x0102).unwrap();
            assert_eq!(value.emit()[..3], bytes);
            assert_eq!(value.emit()[3..], [0x02, 0x01, 0x00]);
            assert_eq!(PresetValue::parse(value.emit()), value);
        }
        assert_eq!(PresetValue::new(1 << 24, 0), None);
        assert_eq!(PresetValue::new(0, 1 << 24), None);
    }

    #[test]
    fn pulse_voltage_is_in_tenths() {
        assert_eq!(PulseVoltage::LIMIT.byte(), 0x35);
        assert_eq!(PulseVoltage::LIMIT.volts(), 5.3);
    }

    /// Manual 6.3 recommends more than 5.3 V in both directions.
    #[test]
    fn compares_wiegand_result_with_limit() {
        for (bytes, passes) in [
            ([60, 54, 60, 54], true),
            ([60, 53, 60, 54], false),
            ([60, 54, 60, 53], false),
            ([0, 0, 0, 0], false),
            ([255, 255, 255, 255], true),
        ] {
            let result = WiegandResult::parse(bytes);
            assert_eq!((result.is_passed(), result.emit()), (passes, bytes));
        }
        assert_eq!(WiegandResult::parse([1, 2, 3, 4]).lowest_ccw.byte(), 4);
    }

    /// Covers all codes in the manual's tables, and codes that are not in the manual.
    #[test]
    fn codes_match_manual() {
        assert_eq!(
            [0, 1, 3, 4, 6, 7, 0x30].map(|code| WiegandStatus::from_byte(code).to_string()),
            [
                "0x00 test stopped",
                "0x01 pulse collection active, clockwise",
                "0x03 wait for change of motor rotation direction",
                "0x04 pulse collection active, counterclockwise",
                "0x06 test complete",
                "0x07 test failed",
                "0x30 wrong motor rotation direction",
            ]
        );
        assert_eq!(
            [1, 2, 0x22, 0x30, 0x31, 0x32, 0x33].map(CalibrationStatus::from_byte),
            [
                CalibrationStatus::Running,
                CalibrationStatus::CounterclockwiseDone,
                CalibrationStatus::ClockwiseDone,
                CalibrationStatus::WrongDirection,
                CalibrationStatus::Temperature,
                CalibrationStatus::Speed,
                CalibrationStatus::Failed,
            ]
        );
        assert_eq!(
            [0, 2, 1].map(FilterStatus::from_byte),
            [FilterStatus::Closed, FilterStatus::WaitForValue, FilterStatus::WaitForSave,]
        );
        for byte in 0..=255 {
            assert_eq!(WiegandCommand::from_byte(byte).byte(), byte);
            assert_eq!(WiegandStatus::from_byte(byte).byte(), byte);
            assert_eq!(CalibrationCommand::from_byte(byte).byte(), byte);
            assert_eq!(CalibrationStatus::from_byte(byte).byte(), byte);
            assert_eq!(DataCommand::from_byte(byte).byte(), byte);
            assert_eq!(DataStatus::from_byte(byte).byte(), byte);
            assert_eq!(FilterCommand::from_byte(byte).byte(), byte);
            assert_eq!(FilterStatus::from_byte(byte).byte(), byte);
            assert_eq!(PresetCommand::from_byte(byte).byte(), byte);
            assert_eq!(PresetStatus::from_byte(byte).byte(), byte);
        }
        assert_eq!(CalibrationStatus::from_byte(0x77).to_string(), "0x77 unknown code");
    }

    proptest! {
        #[test]
        fn preset_values_round_trip_as_six_bytes(bytes: [u8; 6]) {
            prop_assert_eq!(PresetValue::parse(bytes).emit(), bytes);
        }
    }
}
