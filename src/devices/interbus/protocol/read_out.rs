//! The values that can be read from an encoder, and their meaning (reference 3).

use super::cam::ProgramNumber;
use super::value::Value;

/// The number of a value: bits 15..0 of a word 2021xxxxh. Numbers that are not in the manual are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ReadOut(u16);

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ReadOutRow {
    /// The value's number.
    pub read_out: ReadOut,
    /// Name in the manual.
    pub name: &'static str,
    /// Unit of the value as sent; empty if there is none.
    pub unit: &'static str,
}

/// All read-outs, in the manual's order, without the sixteen registers of the chip.
pub const READ_OUTS: [ReadOutRow; 12] = [
    row(ReadOut::SERIAL_NUMBER, "serial number", ""),
    row(ReadOut(0x1), "steps", "steps"),
    row(ReadOut(0x2), "revolutions", "turns"),
    row(ReadOut(0x3), "complement", ""),
    row(ReadOut(0x4), "preset", "steps"),
    row(ReadOut(0x5), "zero shift", "steps"),
    row(ReadOut(0x6), "preset flag", ""),
    row(ReadOut(0x7), "software version", ""),
    row(ReadOut::OPERATING_TIME, "operating time", "10 min"),
    row(ReadOut::STARTUP_MODE, "startup mode", ""),
    row(ReadOut::FLAGS, "flags", ""),
    row(ReadOut::TEMPERATURE, "temperature", "0.1 °C"),
];

const fn row(read_out: ReadOut, name: &'static str, unit: &'static str) -> ReadOutRow {
    ReadOutRow { read_out, name, unit }
}

/// The lowest digit of a chip register's number.
const CHIP: u16 = 0xD;

/// A value that was read out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadOutValue {
    /// A number in the unit of its row; also for unknown read-outs and registers.
    Plain(u32),
    /// Minutes.
    Minutes(u32),
    /// Tenths of a degree Celsius.
    TenthsOfDegree(i32),
    /// The mode of the encoder.
    StartupMode(StartupMode),
    /// Flags of the encoder.
    Flags(Flags),
}

/// Read-out 9: the mode in which the encoder is and starts. The manual prints `3h to 10h` for the programs: decimal 3 to
/// 10.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StartupMode {
    /// 0: as a K2 encoder.
    K2,
    /// 1: as a K3 encoder.
    K3,
    /// 2: speed.
    Velocity,
    /// 3 to 0Ah: cam program 1 to 8.
    Cams(ProgramNumber),
    /// Nothing that the manual has.
    Unknown(Value),
}

/// Read-out Ah.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Flags(Value);

impl ReadOut {
    /// 0.
    pub const SERIAL_NUMBER: ReadOut = ReadOut(0x0);
    /// 8, in ten minutes.
    pub const OPERATING_TIME: ReadOut = ReadOut(0x8);
    /// 9: the mode.
    pub const STARTUP_MODE: ReadOut = ReadOut(0x9);
    /// Ah.
    pub const FLAGS: ReadOut = ReadOut(0xA);
    /// Ch, in tenths of a degree Celsius.
    pub const TEMPERATURE: ReadOut = ReadOut(0xC);

    /// Creates it: any number is a read-out.
    pub const fn new(number: u16) -> Self {
        ReadOut(number)
    }

    /// Returns a register of the OPC chip: `xDh`. `None` beyond 15.
    pub const fn chip_register(register: u8) -> Option<Self> {
        if register < 16 { Some(ReadOut((register as u16) << 4 | CHIP)) } else { None }
    }

    /// Returns its number.
    pub const fn number(self) -> u16 {
        self.0
    }

    /// Returns the number of the chip register, if it is one.
    pub const fn register(self) -> Option<u8> {
        if self.0 & 0xF == CHIP && self.0 <= 0xFF { Some((self.0 >> 4) as u8) } else { None }
    }

    /// Returns its row; `None` for registers of the chip and numbers that are not in the manual.
    pub fn row(self) -> Option<&'static ReadOutRow> {
        READ_OUTS.iter().find(|row| row.read_out == self)
    }

    /// Parses the value received for it.
    pub fn value(self, value: Value) -> ReadOutValue {
        match self {
            ReadOut::OPERATING_TIME => ReadOutValue::Minutes(value.get() * 10),
            ReadOut::STARTUP_MODE => ReadOutValue::StartupMode(StartupMode::parse(value)),
            ReadOut::FLAGS => ReadOutValue::Flags(Flags(value)),
            ReadOut::TEMPERATURE => ReadOutValue::TenthsOfDegree(signed(value)),
            _ => ReadOutValue::Plain(value.get()),
        }
    }
}

/// Returns a number with a sign in 25 bits; if bit 24 is clear and it is above 7FFFh, in 16 (`U`: the manual has −10 °C in
/// neither form).
const fn signed(value: Value) -> i32 {
    let number = value.get();
    if number >> (Value::BITS - 1) == 0 && number > 0x7FFF { number as u16 as i16 as i32 } else { value.signed() }
}

impl StartupMode {
    /// Returns the meaning of this number.
    pub fn parse(value: Value) -> Self {
        let program = |number: u32| u8::try_from(number).ok().and_then(ProgramNumber::new);
        match value.get() {
            0 => StartupMode::K2,
            1 => StartupMode::K3,
            2 => StartupMode::Velocity,
            number => program(number - 2).map_or(StartupMode::Unknown(value), StartupMode::Cams),
        }
    }

    /// Returns its number.
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
    /// Creates it from any value; unknown bits are kept.
    pub const fn new(value: Value) -> Self {
        Flags(value)
    }

    /// Returns its number.
    pub const fn value(self) -> Value {
        self.0
    }

    /// Returns bit 0: steps are reported less one, as by older encoders.
    pub const fn steps_minus_one(self) -> bool {
        self.0.get() & 1 != 0
    }

    /// Returns bit 1: it counts turns.
    pub const fn multiturn(self) -> bool {
        self.0.get() & 2 != 0
    }

    /// Returns the type of encoder that they make.
    pub const fn type_name(self) -> &'static str {
        match (self.multiturn(), self.steps_minus_one()) {
            (true, false) => "multiturn",
            (false, false) => "single turn",
            (true, true) => "multiturn, steps less one",
            (false, true) => "single turn, steps less one",
        }
    }

    /// Returns the other bits, whose meaning is unknown.
    pub const fn unknown(self) -> u32 {
        self.0.get() & !3
    }
}
