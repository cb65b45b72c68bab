//! Individual registers of the kit encoder: errors, warnings, temperature, device mode, filter and firmware. See manual
//! 6.1, 6.2, 6.6, 6.8 and the appendix.

use std::fmt;

/// The error register (68h). If any bit is set, the error bit in the position frame is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ErrorRegister(u8);

/// The warning register (69h).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WarningRegister(u8);

const ERRORS: [&str; 5] = [
    "FRAM error",
    "multiturn synchronisation error",
    "singleturn position sensor error",
    "temperature sensor error",
    "magnetic field too low",
];
const WARNINGS: [&str; 1] = ["temperature too high"];
const UNKNOWN_ERROR: &str = "unknown error";
const UNKNOWN_WARNING: &str = "unknown warning";

impl ErrorRegister {
    /// Bit 1, which is set if the multiturn counter has lost synchronisation.
    pub const MULTITURN: ErrorRegister = ErrorRegister(0x02);
    /// Bit 4, which is set if the magnet is missing or too far away.
    pub const FIELD_TOO_LOW: ErrorRegister = ErrorRegister(0x10);

    /// Creates an error register. Bits that the manual does not define are preserved.
    pub const fn new(byte: u8) -> Self {
        ErrorRegister(byte)
    }

    /// Returns the raw register value.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the set bits with their meanings, lowest bit first.
    pub fn set_bits(self) -> impl Iterator<Item = (u8, &'static str)> {
        set_bits(self.0, &ERRORS, UNKNOWN_ERROR)
    }
}

impl WarningRegister {
    /// Bit 0, which is set at 125 °C and above and cleared below 123 °C.
    pub const TEMPERATURE: WarningRegister = WarningRegister(0x01);

    /// Creates a warning register. Bits that the manual does not define are preserved.
    pub const fn new(byte: u8) -> Self {
        WarningRegister(byte)
    }

    /// Returns the raw register value.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the set bits with their meanings, lowest bit first.
    pub fn set_bits(self) -> impl Iterator<Item = (u8, &'static str)> {
        set_bits(self.0, &WARNINGS, UNKNOWN_WARNING)
    }
}

fn set_bits(
    byte: u8,
    names: &'static [&'static str],
    unknown: &'static str,
) -> impl Iterator<Item = (u8, &'static str)> {
    (0..8u8)
        .filter(move |bit| byte >> bit & 1 == 1)
        .map(move |bit| (bit, names.get(usize::from(bit)).copied().unwrap_or(unknown)))
}

/// The temperature register (66h), which holds degrees Celsius plus 50. The sensor covers −40 to 130 °C with an
/// accuracy of 5 °C.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Temperature(u8);

impl Temperature {
    const OFFSET: i16 = 50;

    /// Creates a temperature from a register value. Every byte is valid.
    pub const fn new(byte: u8) -> Self {
        Temperature(byte)
    }

    /// Creates the nearest temperature that the register can represent.
    pub fn from_celsius(celsius: i16) -> Self {
        Temperature(u8::try_from(celsius.saturating_add(Self::OFFSET).clamp(0, 0xFF)).unwrap_or(0))
    }

    /// Returns the raw register value.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the temperature in whole degrees Celsius, −50 to 205.
    pub fn to_celsius(self) -> i16 {
        i16::from(self.0) - Self::OFFSET
    }

    /// Returns the temperature in degrees Fahrenheit. The manual's formula omits the offset of 50.
    pub fn to_fahrenheit(self) -> f64 {
        1.8 * f64::from(self.to_celsius()) + 32.0
    }
}

/// The device mode (6Ah). Unknown modes are preserved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct DeviceMode(u8);

impl DeviceMode {
    /// Normal operation, in which the encoder only sends positions.
    pub const OPERATION: DeviceMode = DeviceMode(0x00);
    /// Singleturn calibration.
    pub const CALIBRATION: DeviceMode = DeviceMode(0x01);
    /// Wiegand sensor test.
    pub const WIEGAND_TEST: DeviceMode = DeviceMode(0x02);
    /// Write access to OEM data and EDS motor data.
    pub const DATA_WRITE: DeviceMode = DeviceMode(0x04);
    /// Selection of the position filter.
    pub const FILTER: DeviceMode = DeviceMode(0x05);
    /// Preset of the position.
    pub const PRESET: DeviceMode = DeviceMode(0x07);

    /// All modes listed in the manual with their names, in the manual's order.
    pub const TABLE: &'static [(u8, &'static str)] = &[
        (DeviceMode::OPERATION.0, "operation"),
        (DeviceMode::CALIBRATION.0, "calibration"),
        (DeviceMode::WIEGAND_TEST.0, "Wiegand sensor test"),
        (DeviceMode::DATA_WRITE.0, "OEM/EDS motor data write"),
        (DeviceMode::FILTER.0, "filter selection"),
        (DeviceMode::PRESET.0, "preset"),
    ];

    /// Password that unlocks the device mode register. It is written to 6Bh.
    pub const PASSWORD: u8 = 0x2A;

    /// Creates a device mode from a register value. Every byte is valid.
    pub const fn new(byte: u8) -> Self {
        DeviceMode(byte)
    }

    /// Returns the raw register value.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns whether the manual lists this mode.
    pub fn is_known(self) -> bool {
        Self::TABLE.iter().any(|(byte, _)| *byte == self.0)
    }
}

impl fmt::Display for DeviceMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::TABLE.iter().find(|(byte, _)| *byte == self.0).map_or("unknown mode", |(_, name)| name);
        write!(f, "0x{:02X} {name}", self.0)
    }
}

/// The position filter (6Eh).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PositionFilter {
    /// Filter 03h, the factory setting, with low noise.
    Balanced,
    /// Filter 04h, with low latency and more noise.
    Dynamic,
    /// Filter value that the manual does not define.
    Unknown(u8),
}

impl PositionFilter {
    /// Returns the filter for a register value.
    pub const fn from_byte(byte: u8) -> Self {
        match byte {
            0x03 => PositionFilter::Balanced,
            0x04 => PositionFilter::Dynamic,
            _ => PositionFilter::Unknown(byte),
        }
    }

    /// Returns the code, which is used both as the register value in 6Eh and as a command.
    pub const fn byte(self) -> u8 {
        match self {
            PositionFilter::Balanced => 0x03,
            PositionFilter::Dynamic => 0x04,
            PositionFilter::Unknown(byte) => byte,
        }
    }
}

/// A firmware release (74h to 76h), ordered from oldest to newest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Firmware {
    /// Major release number.
    pub major: u8,
    /// Minor release number.
    pub minor: u8,
    /// Patch level.
    pub patch: u8,
}

impl Firmware {
    /// Creates a firmware release from its three numbers.
    pub const fn new(major: u8, minor: u8, patch: u8) -> Self {
        Firmware { major, minor, patch }
    }
}

impl fmt::Display for Firmware {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}.{}", self.major, self.minor, self.patch)
    }
}

/// The profile ID, which identifies the type of electronic data sheet. It is stored in registers 42h and 43h, high byte
/// first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ProfileId(u16);

impl ProfileId {
    /// Creates a profile ID. Every 16-bit value is valid.
    pub const fn new(word: u16) -> Self {
        ProfileId(word)
    }

    /// Returns the profile ID as a 16-bit word. The first byte is in the high half.
    pub const fn to_u16(self) -> u16 {
        self.0
    }

    /// Returns whether bits 15 to 13 are 011, which denotes the standard encoder profile BP3. Only the data sheet of
    /// that profile can be decoded.
    pub const fn is_standard_encoder_profile(self) -> bool {
        self.0 >> 13 == 0b011
    }
}

impl fmt::Display for ProfileId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:04X}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Expected values from sections 4 and 7 of the reference.
    #[test]
    fn published_temperatures_match() {
        for (byte, celsius, fahrenheit) in
            [(0x0A, -40, -40.0), (0x4B, 25, 77.0), (0x7B, 73, 163.4), (0xAF, 125, 257.0), (0xB4, 130, 266.0)]
        {
            let temperature = Temperature::new(byte);
            assert_eq!(temperature.to_celsius(), celsius, "{byte:02X}");
            assert!((temperature.to_fahrenheit() - fahrenheit).abs() < 1e-9, "{byte:02X}");
            assert_eq!(Temperature::from_celsius(celsius).byte(), byte);
        }
        assert_eq!(Temperature::from_celsius(-300).byte(), 0x00);
        assert_eq!(Temperature::from_celsius(i16::MAX).byte(), 0xFF);
    }

    /// According to section 7 of the reference, error 12h means multiturn and field too low, and warning 01h means
    /// temperature.
    #[test]
    fn names_error_and_warning_bits() {
        let errors: Vec<_> = ErrorRegister::new(0x12).set_bits().collect();
        assert_eq!(errors, [(1, "multiturn synchronisation error"), (4, "magnetic field too low")]);
        assert_eq!(0x12, ErrorRegister::MULTITURN.byte() | ErrorRegister::FIELD_TOO_LOW.byte());
        assert_eq!(WarningRegister::new(0x01).set_bits().collect::<Vec<_>>(), [(0, "temperature too high")]);
        assert_eq!(
            ErrorRegister::new(0xA0).set_bits().collect::<Vec<_>>(),
            [(5, "unknown error"), (7, "unknown error")]
        );
        assert_eq!(WarningRegister::new(0x80).set_bits().collect::<Vec<_>>(), [(7, "unknown warning")]);
        assert_eq!(ErrorRegister::new(0).set_bits().count(), 0);
    }

    #[test]
    fn keeps_unknown_modes_filters_and_profiles() {
        let known: Vec<u8> = (0..=255).filter(|byte| DeviceMode::new(*byte).is_known()).collect();
        assert_eq!(known, [0, 1, 2, 4, 5, 7]);
        assert_eq!(DeviceMode::new(0x09).to_string(), "0x09 unknown mode");
        assert_eq!(DeviceMode::PRESET.to_string(), "0x07 preset");
        assert!((0..=255).all(|byte| PositionFilter::from_byte(byte).byte() == byte));
        assert!(ProfileId::new(0x6129).is_standard_encoder_profile());
        assert!(
            !ProfileId::new(0x4129).is_standard_encoder_profile()
                && !ProfileId::new(0xE129).is_standard_encoder_profile()
        );
    }

    #[test]
    fn orders_firmware_versions() {
        assert!(Firmware::new(1, 10, 0) > Firmware::new(1, 6, 0));
        assert!(Firmware::new(1, 6, 0) > Firmware::new(1, 2, 9));
        assert_eq!(Firmware::new(1, 6, 0).to_string(), "1.6.0");
    }
}
