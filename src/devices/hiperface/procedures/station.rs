//! The state of a line and its encoder, which is kept between jobs.

use std::fmt;
use std::time::Duration;

use crate::buses::bridge::procedures::{LineSupply, SupplyAfterSession};
use crate::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, BAUDS, BROADCAST, DeviceAddress, Geometry, MAX_TRANSFER, StatusCode, Timing,
};
use crate::expected::AllowedValues;
use crate::link::line::{Echo, LineState, MARGIN};
use crate::link::{UrlError, UrlQuery};
use crate::parameter::{
    CustomNotation, Millivolts, OptionalValue, ParameterGroup, ParameterValues, RejectedParameter, parse_whole,
};
use crate::parameters;
use crate::units::{Baud, CharacterFormat, Parity, SupplyVoltage};

parameters! {
    /// Link parameters for the line and the encoder. The defaults are the factory settings.
    pub struct LinkParameters: UrlError {
        pub baud: Baud = CharacterFormat::FACTORY.baud, "baud" => BaudValues;
        pub parity: Parity = CharacterFormat::FACTORY.parity, "parity" => Parity::KEYWORDS;
        /// Address used in requests: 40h to 5Fh or broadcast.
        pub address: u8 = DeviceAddress::FACTORY.byte(),
            "address" => CustomNotation(AllowedValues::AddressOrOnlyOne, read_address);
        pub echo: Echo = Echo::Unknown, "echo" => Echo::KEYWORDS;
        /// Whether the encoder's time-out is 44 bits rather than 11 bits.
        pub long_timeout: bool = true, "timeout" => CustomNotation(AllowedValues::TimeoutBits, read_timeout);
        /// Additional time allowed for a reply, beyond the worst case of the protocol. `None` selects the default of
        /// the link.
        pub margin: Option<Duration> = None, "margin" => OptionalValue(MARGIN), "connect.margin" like "50";
        pub periods: Option<u32> = None, "periods" => OptionalValue(CustomNotation(AllowedValues::Periods { most: MAX_PERIODS }, read_periods)), "connect.periods" like "128";
        pub turns: Option<u32> = None, "turns" => OptionalValue(CustomNotation(AllowedValues::MostTurns { most: MAX_PERIODS }, read_periods)), "connect.turns" like "4096";
    }
}

parameters! {
    /// Link parameters for an adapter with a serial line.
    pub struct AdapterParameters: UrlError {
        /// Supply voltage that the adapter provides to the encoder, in millivolts, or `None` for no supply.
        pub millivolt: Option<u16> = None, "voltage" => OptionalValue(Millivolts(SUPPLY_RANGE)), "connect.supply" like "8";
        pub after: SupplyAfterSession = SupplyAfterSession::AsFound, "leave-supply" => SupplyAfterSession::KEYWORDS;
    }
}

/// Supply voltages of HIPERFACE encoders in millivolts. See manual, technical data: 7 to 12 V.
const SUPPLY_RANGE: std::ops::RangeInclusive<u16> = 7_000..=12_000;
/// Time from power-on until the encoder replies with its stored settings. Until 900 ms it may reply with the default
/// settings (manual, figure 38).
const POWER_UP: Duration = Duration::from_secs(1);

impl AdapterParameters {
    /// Returns the supply that the adapter switches on, or `None` if it leaves the supply unchanged.
    pub fn supply(&self) -> Option<LineSupply> {
        let voltage = |nominal| SupplyVoltage { least: *SUPPLY_RANGE.start(), nominal, greatest: *SUPPLY_RANGE.end() };
        self.millivolt.map(|given| LineSupply { voltage: voltage(given), power_up: POWER_UP })
    }
}

/// The four access codes. A code is 55h unless the user has specified another value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Codes([AccessCode; 4]);

impl Default for Codes {
    fn default() -> Self {
        Codes([AccessCode::FACTORY; 4])
    }
}

impl Codes {
    pub fn get(self, number: AccessCodeNumber) -> AccessCode {
        self.0.get(usize::from(number.get())).copied().unwrap_or(AccessCode::FACTORY)
    }

    pub fn set_code(&mut self, number: AccessCodeNumber, code: AccessCode) {
        if let Some(own) = self.0.get_mut(usize::from(number.get())) {
            *own = code;
        }
    }
}

/// Access codes, with their numbers, that apply from the start of every session. If a number occurs twice, the last
/// code applies.
#[derive(Clone, Debug, Default)]
pub struct InitialAccessCodes(Vec<(AccessCodeNumber, AccessCode)>);

impl InitialAccessCodes {
    pub fn apply_codes(&self, codes: &mut Codes) {
        for (number, code) in &self.0 {
            codes.set_code(*number, *code);
        }
    }
}

impl FromIterator<(AccessCodeNumber, AccessCode)> for InitialAccessCodes {
    fn from_iter<I: IntoIterator<Item = (AccessCodeNumber, AccessCode)>>(codes: I) -> Self {
        InitialAccessCodes(codes.into_iter().collect())
    }
}

#[derive(Clone, Debug)]
pub struct Station {
    /// Address used in requests: 40h to 5Fh or broadcast.
    pub address: u8,
    pub format: CharacterFormat,
    /// Whether the encoder's time-out is 44 bits rather than 11 bits.
    pub long_timeout: bool,
    pub line: LineState,
    pub codes: Codes,
    /// Periods and turns, as specified by the user for an encoder type that is not in the table.
    pub geometry: Option<Geometry>,
    /// Status codes to display, in the order in which they were read. They are removed once displayed.
    pub codes_to_display: Vec<StatusCode>,
    /// Status codes for the logbook. This is their only copy, because command 50h removes them from the encoder.
    codes_to_log: Vec<StatusCode>,
    /// Type and serial number of the encoder that was identified last.
    pub identified: Option<(u8, String)>,
    /// Number of missing or damaged replies to command 50h. Each of them may have contained a status code.
    pub(super) unanswered_codes: u32,
    /// Whether every value is read twice because it will be stored. This applies even to a line without errors.
    pub(super) reads_twice: bool,
    /// Maximum number of bytes per transfer. It is halved if the line damages long replies, and doubled otherwise.
    pub(super) max_transfer: usize,
}

impl Station {
    pub fn new(margin: Duration) -> Self {
        Station {
            address: DeviceAddress::FACTORY.byte(),
            format: CharacterFormat::FACTORY,
            long_timeout: true,
            line: LineState::new(margin),
            codes: Codes::default(),
            geometry: None,
            codes_to_display: Vec::new(),
            codes_to_log: Vec::new(),
            identified: None,
            unanswered_codes: 0,
            reads_twice: false,
            max_transfer: MAX_TRANSFER,
        }
    }

    /// Creates a station from link parameters and a margin for replies. Missing parameters have their factory settings,
    /// and parameters that do not concern the line are ignored.
    ///
    /// # Errors
    /// Returns an error with the allowed values if a value is invalid.
    pub fn from_query(query: &UrlQuery, margin: Duration) -> Result<Self, UrlError> {
        let link = LinkParameters::read(query.pairs())?;
        let mut station = Station::new(link.margin.unwrap_or(margin));
        station.format = CharacterFormat { baud: link.baud, parity: link.parity };
        (station.address, station.long_timeout) = (link.address, link.long_timeout);
        station.line.echo = link.echo;
        station.geometry = parse_geometry(&link)?;
        Ok(station)
    }

    pub fn timing(&self) -> Timing {
        Timing::new(self.format, self.long_timeout)
    }

    /// Returns whether values must be read twice, because the XOR checksum misses some pairs of flipped bits.
    pub(super) fn requires_double_read(&self) -> bool {
        self.reads_twice || self.line.damaged > 0
    }

    pub(super) fn queue_codes(&mut self, codes: impl IntoIterator<Item = StatusCode>) {
        let codes: Vec<StatusCode> = codes.into_iter().filter(|code| *code != StatusCode::OK).collect();
        self.codes_to_log.extend(&codes);
        self.codes_to_display.extend(codes);
    }

    /// Removes and returns the codes for the logbook. They must be stored before any of them is displayed.
    pub fn take_unlogged_codes(&mut self) -> Vec<StatusCode> {
        std::mem::take(&mut self.codes_to_log)
    }

    /// Returns the number of missing or damaged replies to command 50h since the last call, and resets it. Each of
    /// these replies may have contained a status code.
    pub fn take_missed_code_count(&mut self) -> u32 {
        std::mem::take(&mut self.unanswered_codes)
    }

    pub fn take_undisplayed_codes(&mut self) -> Vec<StatusCode> {
        std::mem::take(&mut self.codes_to_display)
    }
}

impl fmt::Display for Station {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "address {:02X}h at {}", self.address, self.format)
    }
}

struct BaudValues;

impl ParameterValues for BaudValues {
    type Value = Baud;

    fn read(&self, text: &str) -> Option<Baud> {
        text.parse().ok().and_then(Baud::new).filter(|baud| BAUDS.contains(baud))
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::OneOf(BAUDS.map(|baud| baud.to_string()).to_vec())
    }
}

fn read_address(text: &str) -> Option<u8> {
    let byte = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(hex) => u8::from_str_radix(hex, 16).ok()?,
        None => match text.strip_suffix(['h', 'H']) {
            Some(hex) => u8::from_str_radix(hex, 16).ok()?,
            None => text.parse().ok()?,
        },
    };
    (byte == BROADCAST || DeviceAddress::new(byte).is_some()).then_some(byte)
}

fn read_timeout(text: &str) -> Option<bool> {
    match text {
        "44" => Some(true),
        "11" => Some(false),
        _ => None,
    }
}

/// Maximum number of periods. Each period has 32 steps in the 32-bit position word.
pub const MAX_PERIODS: u32 = 1 << 27;

fn read_periods(text: &str) -> Option<u32> {
    parse_whole(text).filter(|periods| (1..=MAX_PERIODS).contains(periods))
}

/// Returns the geometry specified by `periods=` and `turns=`. The default number of turns is 1.
fn parse_geometry(link: &LinkParameters) -> Result<Option<Geometry>, RejectedParameter> {
    let turns = link.turns.unwrap_or(1);
    match link.periods {
        None if link.turns.is_some() => {
            Err(RejectedParameter::new("turns", turns, AllowedValues::OnlyWith("periods=")))
        }
        None => Ok(None),
        Some(periods) if turns > MAX_PERIODS / periods => {
            Err(RejectedParameter::new("turns", turns, AllowedValues::MostTurns { most: MAX_PERIODS / periods }))
        }
        Some(periods) => Ok(Some(Geometry::Rotary { periods, turns })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(query: &str) -> Result<Station, UrlError> {
        Station::from_query(&query.parse().unwrap(), Duration::from_millis(50))
    }

    #[test]
    fn omitted_parameters_use_factory_settings() {
        let station = station("").unwrap();
        assert_eq!(station.to_string(), "address 40h at 9600 8E1");
        assert_eq!(station.line.echo, Echo::Unknown);
        assert_eq!(station.line.margin, Duration::from_millis(50));
        assert_eq!(station.codes.get(AccessCodeNumber::ZERO), AccessCode::FACTORY);
    }

    #[test]
    fn never_prints_access_codes() {
        let number = |number| AccessCodeNumber::new(number).unwrap();
        let given: InitialAccessCodes =
            [(number(2), AccessCode::new(0x9D)), (number(2), AccessCode::new(0xA7))].into_iter().collect();
        let mut codes = Codes::default();
        given.apply_codes(&mut codes);
        assert_eq!((codes.get(number(2)).byte(), codes.get(number(1)).byte()), (0xA7, 0x55));
        let text = format!("{given:?} {given:#?}");
        for code in ["9D", "9d", "157", "A7", "a7", "167"] {
            assert!(!text.contains(code), "{text}");
        }
    }

    #[test]
    fn parses_line_settings() {
        let station = station("baud=38400&parity=odd&address=0x41&echo=off&timeout=11&margin=5&periods=64").unwrap();
        assert_eq!(station.to_string(), "address 41h at 38400 8O1");
        assert_eq!(station.line.echo, Echo::Off);
        assert_eq!(station.timing().timeout, Duration::from_nanos(286_458));
        assert_eq!(station.geometry, Some(Geometry::Rotary { periods: 64, turns: 1 }));
    }

    #[test]
    fn rejection_lists_allowed_values() {
        let cases = [
            ("baud=115200", "baud=115200 is not valid (allowed: one of 600, 1200, 2400, 4800, 9600, 19200, 38400)"),
            ("parity=mark", "parity=mark is not valid (allowed: none, even or odd)"),
            (
                "address=0x60",
                "address=0x60 is not valid (allowed: 0x40 to 0x5F, or 0xFF if only one encoder is connected)",
            ),
            ("echo=yes", "echo=yes is not valid (allowed: auto, on or off)"),
            ("margin=-1", "margin=-1 is not valid (allowed: a time in milliseconds from 0 to 2000)"),
            ("turns=4096", "turns=4096 is not valid (allowed: only together with periods=)"),
            ("periods=134217728&turns=2", "turns=2 is not valid (allowed: 1 to 1 turns)"),
        ];
        for (query, message) in cases {
            assert_eq!(station(query).unwrap_err().to_string(), message);
        }
    }
}
