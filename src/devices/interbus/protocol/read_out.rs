//! Values that a K3 encoder returns on request (reference 3).

use super::cam::ProgramNumber;
use super::value::Value;

/// Number of a read-out, sent in bits 15..0 of the request 2021xxxxh. It need not be one that the manual defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ReadOutNumber(u16);

/// A row of the read-out table.
#[derive(Clone, Copy, Debug)]
pub struct ReadOutRow {
    /// Number of the read-out.
    pub read_out: ReadOutNumber,
    /// Name in the manual.
    pub name: &'static str,
    /// Unit of the transmitted value, or an empty string if there is none.
    pub unit: &'static str,
}

/// All read-outs in the order of the manual, except the sixteen registers of the OPC chip.
pub const READ_OUTS: [ReadOutRow; 12] = [
    row(ReadOutNumber::SERIAL_NUMBER, "serial number", ""),
    row(ReadOutNumber(0x1), "steps", "steps"),
    row(ReadOutNumber(0x2), "revolutions", "turns"),
    row(ReadOutNumber(0x3), "complement", ""),
    row(ReadOutNumber(0x4), "preset", "steps"),
    row(ReadOutNumber(0x5), "zero shift", "steps"),
    row(ReadOutNumber(0x6), "preset flag", ""),
    row(ReadOutNumber(0x7), "software version", ""),
    row(ReadOutNumber::OPERATING_TIME, "operating time", "10 min"),
    row(ReadOutNumber::STARTUP_MODE, "startup mode", ""),
    row(ReadOutNumber::FLAGS, "flags", ""),
    row(ReadOutNumber::TEMPERATURE, "temperature", "0.1 °C"),
];

const fn row(read_out: ReadOutNumber, name: &'static str, unit: &'static str) -> ReadOutRow {
    ReadOutRow { read_out, name, unit }
}

/// Lowest hexadecimal digit of the read-outs that return chip registers.
const CHIP: u16 = 0xD;

/// Value of a read-out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadOutValue {
    /// A number in the unit of the table row. Unknown read-outs and chip registers also use this variant.
    Plain(u32),
    /// Operating time in minutes.
    Minutes(u32),
    /// Temperature in tenths of a degree Celsius.
    TenthsOfDegree(i32),
    /// Mode of the encoder.
    StartupMode(StartupMode),
    /// Flags of the encoder.
    Flags(Flags),
}

/// Current mode and start-up mode of the encoder (read-out 9). The manual prints `3h to 10h` for the programs, but
/// decimal 3 to 10 is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StartupMode {
    /// Code 0: the encoder operates like a K2 encoder.
    K2,
    /// Code 1: the encoder operates like a K3 encoder.
    K3,
    /// Code 2: velocity mode.
    Velocity,
    /// Codes 3 to 0Ah: cam programs 1 to 8.
    Cams(ProgramNumber),
    /// A code that the manual does not define.
    Unknown(Value),
}

/// Encoder flags (read-out Ah).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Flags(Value);

impl ReadOutNumber {
    /// Serial number, read-out 0.
    pub const SERIAL_NUMBER: ReadOutNumber = ReadOutNumber(0x0);
    /// Operating time in units of ten minutes, read-out 8.
    pub const OPERATING_TIME: ReadOutNumber = ReadOutNumber(0x8);
    /// Start-up mode, read-out 9.
    pub const STARTUP_MODE: ReadOutNumber = ReadOutNumber(0x9);
    /// Flags, read-out Ah.
    pub const FLAGS: ReadOutNumber = ReadOutNumber(0xA);
    /// Temperature in tenths of a degree Celsius, read-out Ch.
    pub const TEMPERATURE: ReadOutNumber = ReadOutNumber(0xC);

    /// Creates a read-out from its number. Every number is valid.
    pub const fn new(number: u16) -> Self {
        ReadOutNumber(number)
    }

    /// Returns the read-out `xDh` for OPC chip register x, or `None` if the register is above 15.
    pub const fn chip_register(register: u8) -> Option<Self> {
        if register < 16 { Some(ReadOutNumber((register as u16) << 4 | CHIP)) } else { None }
    }

    /// Returns the number of the read-out.
    pub const fn to_u16(self) -> u16 {
        self.0
    }

    /// Returns the number of the chip register, or `None` if this read-out is not for a chip register.
    pub const fn register(self) -> Option<u8> {
        if self.0 & 0xF == CHIP && self.0 <= 0xFF { Some((self.0 >> 4) as u8) } else { None }
    }

    /// Returns the table row of the read-out, or `None` for chip registers and numbers that the manual does not define.
    pub fn row(self) -> Option<&'static ReadOutRow> {
        READ_OUTS.iter().find(|row| row.read_out == self)
    }

    /// Interprets a value received for this read-out.
    pub fn value(self, value: Value) -> ReadOutValue {
        match self {
            ReadOutNumber::OPERATING_TIME => ReadOutValue::Minutes(value.get() * 10),
            ReadOutNumber::STARTUP_MODE => ReadOutValue::StartupMode(StartupMode::parse(value)),
            ReadOutNumber::FLAGS => ReadOutValue::Flags(Flags(value)),
            ReadOutNumber::TEMPERATURE => ReadOutValue::TenthsOfDegree(to_signed(value)),
            _ => ReadOutValue::Plain(value.get()),
        }
    }
}

/// Returns the value as a signed 25-bit number, or as a signed 16-bit number if it is above 7FFFh and bit 24 is clear.
/// The manual does not say how negative values are sent (`U`). See reference 3.
const fn to_signed(value: Value) -> i32 {
    let number = value.get();
    if number >> (Value::BITS - 1) == 0 && number > 0x7FFF { number as u16 as i16 as i32 } else { value.to_signed() }
}

impl StartupMode {
    /// Parses a mode.
    pub fn parse(value: Value) -> Self {
        let program = |number: u32| u8::try_from(number).ok().and_then(ProgramNumber::new);
        match value.get() {
            0 => StartupMode::K2,
            1 => StartupMode::K3,
            2 => StartupMode::Velocity,
            number => program(number - 2).map_or(StartupMode::Unknown(value), StartupMode::Cams),
        }
    }

    /// Returns the number of the mode.
    pub fn emit(self) -> u32 {
        match self {
            StartupMode::K2 => 0,
            StartupMode::K3 => 1,
            StartupMode::Velocity => 2,
            StartupMode::Cams(program) => u32::from(program.get()) + 2,
            StartupMode::Unknown(value) => value.get(),
        }
    }
}

impl Flags {
    /// Creates flags from any value. Unknown bits are preserved.
    pub const fn new(value: Value) -> Self {
        Flags(value)
    }

    /// Returns the flags as a number.
    pub const fn value(self) -> Value {
        self.0
    }

    /// Returns whether bit 0 is set. Older encoders set it and report the number of steps minus one.
    pub const fn steps_minus_one(self) -> bool {
        self.0.get() & 1 != 0
    }

    /// Returns whether bit 1 is set, which means that the encoder counts turns.
    pub const fn counts_turns(self) -> bool {
        self.0.get() & 2 != 0
    }

    /// Returns the English name of the encoder type according to the flags.
    pub const fn type_name(self) -> &'static str {
        match (self.counts_turns(), self.steps_minus_one()) {
            (true, false) => "multiturn",
            (false, false) => "single turn",
            (true, true) => "multiturn, steps less one",
            (false, true) => "single turn, steps less one",
        }
    }

    /// Returns all other flags, whose meaning is unknown.
    pub const fn unknown_bits(self) -> u32 {
        self.0.get() & !3
    }
}
