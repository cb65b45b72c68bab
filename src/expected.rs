//! Allowed values of a parameter or setting, described in English. The messages shown in the window are in
//! `app::explain::expected`.

use std::borrow::Cow;
use std::fmt;

use thiserror::Error;

/// The set of allowed values, as stated in the error for an invalid value.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum AllowedValues {
    /// One of several keywords, all of which the error message lists.
    #[error("{}", join_alternatives(.0))]
    Words(Cow<'static, [&'static str]>),
    #[error("one of {}", .0.join(", "))]
    OneOf(Vec<String>),
    #[error("{quantity} from {low} to {high}")]
    Range { quantity: Quantity, low: Limit, high: Limit },
    /// A whole number within the range of its type.
    #[error("a whole number")]
    Whole,
    /// A 32-bit number.
    #[error("a number from 0 to 0xFFFFFFFF")]
    Number32,
    /// A speed in revolutions per minute, in either direction.
    #[error("a speed from -{most} to {most} rpm")]
    Speed { most: u32 },
    /// A speed in revolutions per minute, in one direction only.
    #[error("a speed from 0 to {most} rpm")]
    UnidirectionalSpeed { most: u32 },
    #[error("{low} to {high} seconds")]
    Seconds { low: Limit, high: Limit },
    #[error("a bit rate from {low} to {high} bit/s, usually 115200")]
    BitRate { low: u32, high: u32 },
    #[error("1 to {most} periods per revolution")]
    Periods { most: u32 },
    #[error("1 to {most} turns")]
    MostTurns { most: u32 },
    #[error("a number of steps from {low} to {high}, limited by the encoder's number of turns")]
    StepsOfTurns { low: u32, high: u32 },
    #[error("only together with {0}")]
    OnlyWith(&'static str),
    #[error("a CRC polynomial including its highest term, such as 0x43, or \"none\"")]
    Polynomial,
    /// A frame of 64 bits or fewer.
    #[error("a frame of at most 64 bits, including the turns, two flags and the CRC")]
    ShortFrame,
    /// An encoder address on the bus, or the address for a single connected encoder.
    #[error("0x40 to 0x5F, or 0xFF if only one encoder is connected")]
    AddressOrOnlyOne,
    #[error("an address from 0x40 to {last:#04X}")]
    BusAddress { last: u8 },
    /// The first of several consecutive encoder addresses.
    #[error("an address from 0x40 to {last:#04X}, so that there is an address for every encoder")]
    FirstAddress { last: u8 },
    /// A HIPERFACE time-out, counted in bits.
    #[error("44 or 11 bits, as set in the encoder")]
    TimeoutBits,
    #[error("a type byte from 0x00 to 0xFF")]
    TypeByte,
    #[error("a settings byte without reserved values, such as 0xE4")]
    SettingsByte,
    #[error("one to nine ASCII characters")]
    SerialNumber,
    #[error("up to {most} ASCII characters")]
    Ascii { most: u32 },
    /// A position in steps whose limits are not known yet.
    #[error("a position in steps")]
    Steps,
    #[error("NUMBER:HEX for the access codes 0 to 3, separated by commas, such as 0:55,2:66")]
    AccessCodes,
    #[error("a firmware version such as 1.6.0")]
    FirmwareVersion,
    #[error("a value of the error register from 0x00 to 0xFF")]
    ErrorRegister,
    #[error("the number of flash write cycles that the encoder has used so far")]
    WriteCycles,
    #[error("the number of EEPROM write cycles that the encoder has used so far")]
    Stores,
    #[error("AVERAGE,MINIMUM in volts from 0 to 25.5, such as 6.3,5.8")]
    Pulses,
    #[error("a cam program from 1 to 8, or 0 for none")]
    Program,
    #[error("4 or 8 ports; omit the setting for an adapter with one drive")]
    Hub,
    #[error("a two-digit switch setting from 0 to 99")]
    SwitchDigits,
    #[error("a variant from 1 to 13, or its name, such as HDA30A")]
    Variant,
    #[error("0 or 1 for each port (number of ports: {count}), separated by commas, such as 1,0")]
    Places { count: u8 },
    #[error("a family of SSI encoders with its settings, such as atm60,code=gray")]
    Family,
    #[error("{}, separated by commas; append :SECONDS to make an error recur", .0.join(", "))]
    ErrorBits(Vec<String>),
    #[error("no value, because the frame of this encoder has no error bits")]
    NoErrorBits,
    #[error("a string")]
    Text,
    #[error("a string such as {0:?}")]
    TextSuchAs(&'static str),
    #[error("a number from 0 to 255 (0x00 to 0xFF)")]
    Byte,
    #[error("a number from 0 to 65535 (0x0000 to 0xFFFF)")]
    Word,
    #[error("a list of strings that contain hexadecimal bytes")]
    HexLines,
    #[error("a structure: (name: value, …)")]
    Structure,
    #[error("a structure in which each value has a name followed by a colon")]
    Names,
    #[error("a list: […]")]
    List,
    #[error("a map: {{number: value, …}}")]
    Map,
    #[error("a list of four numbers from 0 to 255, in tenths of a volt")]
    FourTenths,
    #[error("the first and the last bank, such as (0x24, 0x43)")]
    Banks,
    /// A number of revolutions, which may be a fraction.
    #[error("a whole number, or a string such as \"25/2\"")]
    Revolutions,
    #[error("a number or a fraction such as 25/2")]
    Fraction,
    #[error("\"ones\", or a number that contains all bits of a frame")]
    Frame,
    #[error("even@CLOCK or odd@CLOCK")]
    ParityBit,
    #[error("BITS+ZEROS, such as 25+1")]
    Repetition,
    #[error("clock numbers joined by +, such as 1+26")]
    Clocks,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Quantity {
    /// A number without any limits.
    #[error("a number")]
    Number,
    #[error("a time in milliseconds")]
    Milliseconds,
    #[error("a time in microseconds")]
    Microseconds,
    #[error("a frequency in hertz")]
    Hertz,
    #[error("a number of bits")]
    Bits,
    #[error("a position in steps")]
    Steps,
    #[error("a number of turns")]
    Turns,
    #[error("a position")]
    Position,
    #[error("a position on the code disc")]
    PlaceOfDisc,
    #[error("a temperature in °C")]
    Celsius,
    #[error("a temperature in whole degrees Celsius")]
    WholeCelsius,
    #[error("a speed in units of 0.1 rpm")]
    TenthsOfRpm,
    /// A torque as a percentage of the nominal torque.
    #[error("a torque as a percentage of the nominal torque")]
    Torque,
    #[error("a protocol version")]
    Version,
    #[error("an address")]
    Address,
    #[error("a port number")]
    Port,
    #[error("a unit ID")]
    Unit,
    #[error("an input register")]
    InputRegister,
    #[error("a holding register")]
    HoldingRegister,
    #[error("a number of cycles")]
    Cycles,
    #[error("a number of encoders")]
    Encoders,
    #[error("a switch position")]
    SwitchPosition,
    #[error("a voltage in volts")]
    Volts,
    /// The fraction of frames in which a bit is inverted.
    #[error("a proportion of damaged frames")]
    DamagedFrames,
    /// The fraction of requests answered with an exception.
    #[error("a proportion of requests answered with an exception")]
    RefusedRequests,
}

/// A limit of a range, with a resolution of one thousandth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    thousandths: i128,
}

impl AllowedValues {
    pub const fn words(words: &'static [&'static str]) -> Self {
        AllowedValues::Words(Cow::Borrowed(words))
    }

    pub fn range(quantity: Quantity, low: impl Into<Limit>, high: impl Into<Limit>) -> Self {
        AllowedValues::Range { quantity, low: low.into(), high: high.into() }
    }

    /// Creates a range of whole numbers.
    pub const fn whole_range(low: i128, high: i128) -> Self {
        AllowedValues::Range { quantity: Quantity::Number, low: Limit::whole(low), high: Limit::whole(high) }
    }

    /// Creates a range of numbers without a unit.
    pub fn number_range(low: impl Into<Limit>, high: impl Into<Limit>) -> Self {
        AllowedValues::range(Quantity::Number, low, high)
    }
}

impl Limit {
    /// Creates a limit from thousandths.
    pub const fn from_thousandths(thousandths: i128) -> Self {
        Limit { thousandths }
    }

    pub const fn whole(number: i128) -> Self {
        Limit { thousandths: number * 1000 }
    }
}

impl<N: Into<i128>> From<N> for Limit {
    fn from(number: N) -> Self {
        Limit::whole(number.into())
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (whole, part) = (self.thousandths / 1000, self.thousandths % 1000);
        match part {
            0 => whole.fmt(f),
            part => f.write_str(format!("{whole}.{:03}", part.abs()).trim_end_matches('0')),
        }
    }
}

fn join_alternatives(words: &[&str]) -> String {
    match words {
        [before @ .., last] if !before.is_empty() => format!("{} or {last}", before.join(", ")),
        words => words.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_words_and_limits() {
        let cases = [
            (AllowedValues::words(&["on"]), "on"),
            (AllowedValues::words(&["auto", "on", "off"]), "auto, on or off"),
            (AllowedValues::range(Quantity::Milliseconds, 0, 2000), "a time in milliseconds from 0 to 2000"),
            (
                AllowedValues::range(Quantity::Volts, Limit::from_thousandths(4750), Limit::from_thousandths(12_500)),
                "a voltage in volts from 4.75 to 12.5",
            ),
            (AllowedValues::Seconds { low: Limit::from_thousandths(100), high: 60.into() }, "0.1 to 60 seconds"),
            (AllowedValues::BusAddress { last: 0x5F }, "an address from 0x40 to 0x5F"),
        ];
        for (expected, words) in cases {
            assert_eq!(expected.to_string(), words);
        }
    }
}
