//! A gateway and its encoder, with the state that outlives a job.

use std::fmt;
use std::time::Duration;

use crate::devices::interbus::protocol::{Command, Gear, INPUT, OUTPUT, StartupMode, UNIT, WindowShift, WordOrder};
use crate::link::line::LineState;
use crate::link::{UrlError, UrlQuery};
use crate::parameter::{Milliseconds, ParameterGroup};
use crate::parameters;

parameters! {
    /// Connection parameters of the gateway, and the registers of the encoder.
    #[derive(Copy)]
    pub struct LinkParameters: UrlError {
        pub unit: u8 = 1, "unit" => UNIT, "connect.unit";
        /// First of the two input registers that contain the IN word.
        pub input: u16 = 0, "input" => INPUT, "connect.input";
        /// First of the two holding registers that contain the OUT word.
        pub output: u16 = 0, "output" => OUTPUT, "connect.output";
        pub order: WordOrder = WordOrder::HighFirst, "order" => WordOrder::KEYWORDS;
        /// Time limit for an echo, a value or a position (`U`: not documented). See reference 4.
        pub handshake: Duration = Duration::from_secs(2), "handshake" => Milliseconds(50..=8000), "connect.handshake";
        /// Pause before each reading of the IN word. The default is about the cycle time of a gateway.
        pub cycle: Duration = Duration::from_millis(5), "cycle" => Milliseconds(1..=1000);
        /// Time limit for a reply from the gateway, not including the margin of the line.
        pub timeout: Duration = Duration::from_secs(1), "timeout" => Milliseconds(10..=2000);
    }
}

#[derive(Clone, Debug)]
pub struct Station {
    pub link: LinkParameters,
    /// Whether replies come from a recording, in which case they contain the recorded request numbers.
    pub recorded: bool,
    pub(super) line: LineState,
    pub(super) next: u16,
    /// Received bytes that have not been processed yet.
    pub(super) waiting: Vec<u8>,
    /// Whether the gateway failed to answer the most recent request.
    pub(super) silent: bool,
    pub(super) known: KnownState,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct KnownState {
    /// Operating mode as last reported.
    pub(super) mode: Option<StartupMode>,
    pub(super) serial_number: Option<u32>,
    pub(super) gear: Option<Gear>,
    pub(super) shift: Option<WindowShift>,
    /// A mode that lasts only while this OUT word remains set, or `None` if the mode lasts with 00000000h.
    pub(super) hold: Option<(StartupMode, Command)>,
    pub(super) kept: Option<StartupMode>,
    /// Longest time for which the encoder was seen to be busy with a word in this session.
    pub(super) processing: Duration,
}

impl Station {
    /// Returns the serial number of the last encoder that was identified.
    pub fn serial_number(&self) -> Option<u32> {
        self.known.serial_number
    }

    /// Creates the state for a new gateway with default parameters. `margin` extends the time limit for replies.
    pub fn new(margin: Duration) -> Self {
        Station {
            link: LinkParameters::default(),
            recorded: false,
            line: LineState::new(margin),
            next: 1,
            waiting: Vec::new(),
            silent: false,
            known: KnownState::default(),
        }
    }

    /// Creates a station from the connection parameters in a query. Other parameters of the query are ignored.
    ///
    /// # Errors
    /// Returns an error with the valid values if a parameter is invalid.
    pub fn from_query(query: &UrlQuery, margin: Duration) -> Result<Self, UrlError> {
        Ok(Station { link: LinkParameters::read(query.pairs())?, ..Station::new(margin) })
    }
}

impl fmt::Display for Station {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unit {}, IN at {}, OUT at {}", self.link.unit, self.link.input, self.link.output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(query: &str) -> Result<Station, UrlError> {
        Station::from_query(&query.parse().unwrap(), Duration::from_millis(50))
    }

    #[test]
    fn omitted_parameters_use_defaults() {
        let station = station("").unwrap();
        assert_eq!(station.to_string(), "unit 1, IN at 0, OUT at 0");
        assert_eq!((station.link.order, station.link.handshake), (WordOrder::HighFirst, Duration::from_secs(2)));
    }

    #[test]
    fn parses_gateway_settings() {
        let station =
            station("unit=17&input=0x1000&output=2048&order=low-first&handshake=500&cycle=20&timeout=250").unwrap();
        assert_eq!(station.to_string(), "unit 17, IN at 4096, OUT at 2048");
        assert_eq!((station.link.order, station.link.handshake), (WordOrder::LowFirst, Duration::from_millis(500)));
        assert_eq!((station.link.cycle, station.link.timeout), (Duration::from_millis(20), Duration::from_millis(250)));
    }

    #[test]
    fn rejection_lists_allowed_values() {
        let cases = [
            ("unit=256", "unit=256 is not valid (allowed: a unit ID from 0 to 255)"),
            ("input=65535", "input=65535 is not valid (allowed: an input register from 0 to 65534)"),
            ("output=-1", "output=-1 is not valid (allowed: a holding register from 0 to 65534)"),
            ("order=swapped", "order=swapped is not valid (allowed: high-first or low-first)"),
            ("handshake=10", "handshake=10 is not valid (allowed: a time in milliseconds from 50 to 8000)"),
            ("cycle=0", "cycle=0 is not valid (allowed: a time in milliseconds from 1 to 1000)"),
            ("timeout=5000", "timeout=5000 is not valid (allowed: a time in milliseconds from 10 to 2000)"),
        ];
        for (query, message) in cases {
            assert_eq!(station(query).unwrap_err().to_string(), message);
        }
    }
}
