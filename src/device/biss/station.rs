//! What a session knows about its line and the encoder at its end, from one job to the next.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use crate::device::line::{Echo, LineState, MARGIN_ALLOWED, read_margin};
use crate::link::{Query, UrlError};
use crate::protocol::biss::{Access, ByteOrder, Description, Layout, RegisterAddress};
use crate::protocol::ubicom::REPLY_TIME_OUT;

/// Link parameters that describe the line and the encoder.
pub const PARAMETERS: [&str; 4] = ["order", "echo", "timeout", "margin"];

/// How the encoder is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// UBICOM over its configuration pin: registers by their global address.
    ConfigPin,
}

/// What a session knows about its line and the encoder at its end.
#[derive(Clone, Debug)]
pub struct Station {
    /// How the encoder is reached.
    pub way: Way,
    /// Silences, echo and damage: what every line has.
    pub line: LineState,
    /// Which byte of a register's number comes first over the configuration pin; `None` until it was probed.
    pub order: Option<ByteOrder>,
    /// So long a reply may take, beside the time of its bytes and the margin.
    pub timeout: Duration,
    /// What the encoder's registers are; `None` before it was identified.
    pub description: Option<Arc<Description>>,
    /// The frame as the encoder's data sheet tells it.
    pub layout: Option<Layout>,
    /// What is read is to be kept: it has to come twice, on a line that seems good as well.
    pub(super) thorough: bool,
}

impl Station {
    /// A line that nobody has used.
    pub fn new(way: Way, margin: Duration) -> Self {
        Station {
            way,
            line: LineState::new(margin),
            order: None,
            timeout: REPLY_TIME_OUT,
            description: None,
            layout: None,
            thorough: false,
        }
    }

    /// A line as the parameters of its link say.
    ///
    /// # Errors
    /// A value that cannot be used, with what could be. Parameters that do not concern the line are left alone.
    pub fn from_query(query: &Query, way: Way, margin: Duration) -> Result<Self, UrlError> {
        let mut station = Station::new(way, margin);
        station.order = query.read("order", "auto, low-first or high-first", read_order)?.flatten();
        if let Some(echo) = query.read("echo", Echo::ALLOWED, Echo::read)? {
            station.line.echo = echo;
        }
        if let Some(timeout) = query.read("timeout", "milliseconds from 1 to 10000", read_timeout)? {
            station.timeout = timeout;
        }
        if let Some(margin) = query.read("margin", MARGIN_ALLOWED, read_margin)? {
            station.line.margin = margin;
        }
        Ok(station)
    }

    /// The frame of the position: as the encoder's data sheet says, else its description, else that of the kit encoder.
    pub fn frame(&self) -> Layout {
        let described = || self.description.as_ref().and_then(|description| description.layout().cloned());
        self.layout.clone().or_else(described).unwrap_or_default()
    }

    /// Once is not enough: a sum lets some pairs of flipped bits through.
    pub(super) fn reads_twice(&self) -> bool {
        self.thorough || self.line.damaged > 0
    }

    /// Whether reading a register back tells that it was written. What a command register gives back does not: the same
    /// command may have been given before.
    pub(super) fn tells_back(&self, address: RegisterAddress) -> bool {
        if address == RegisterAddress::BANK_SELECT {
            return true;
        }
        let Some(description) = &self.description else { return false };
        let is_command = description.procedures().iter().any(|procedure| procedure.command == address);
        let stores = description.at(address).is_none_or(|register| register.saves.is_empty());
        description.access(address) == Some(Access::Rw) && !is_command && stores
    }
}

impl fmt::Display for Station {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.way {
            Way::ConfigPin => f.write_str("UBICOM"),
        }
    }
}

/// `Some(None)` is to be probed.
fn read_order(text: &str) -> Option<Option<ByteOrder>> {
    match text {
        "auto" => Some(None),
        "low-first" => Some(Some(ByteOrder::LowFirst)),
        "high-first" => Some(Some(ByteOrder::HighFirst)),
        _ => None,
    }
}

fn read_timeout(text: &str) -> Option<Duration> {
    text.parse().ok().filter(|ms| (1..=10_000).contains(ms)).map(Duration::from_millis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::biss::Descriptions;

    fn station(query: &str) -> Result<Station, UrlError> {
        Station::from_query(&query.parse().unwrap(), Way::ConfigPin, Duration::from_millis(50))
    }

    #[test]
    fn what_is_left_out_is_probed_or_usual() {
        let station = station("").unwrap();
        assert_eq!((station.order, station.line.echo), (None, Echo::Unknown));
        assert_eq!((station.timeout, station.line.margin), (Duration::from_millis(100), Duration::from_millis(50)));
        assert_eq!(station.frame().bits(), 41);
    }

    #[test]
    fn a_line_is_read_from_its_parameters() {
        let station = station("order=high-first&echo=on&timeout=250&margin=5").unwrap();
        assert_eq!((station.order, station.line.echo), (Some(ByteOrder::HighFirst), Echo::On));
        assert_eq!((station.timeout, station.line.margin), (Duration::from_millis(250), Duration::from_millis(5)));
    }

    #[test]
    fn a_value_that_cannot_be_used_names_what_can() {
        let cases = [
            ("order=lsb", "order=lsb: auto, low-first or high-first"),
            ("echo=yes", "echo=yes: auto, on or off"),
            ("timeout=0", "timeout=0: milliseconds from 1 to 10000"),
            ("margin=-1", "margin=-1: milliseconds from 0 to 2000"),
        ];
        for (query, message) in cases {
            assert_eq!(station(query).unwrap_err().to_string(), message);
        }
    }

    /// Manual, appendix 9.1: bank select, mode, password and the data areas keep what they are given; the rest are
    /// commands, cannot be written, or are not described.
    #[test]
    fn reading_back_tells_of_registers_that_keep_what_they_are_given() {
        let mut station = Station::new(Way::ConfigPin, Duration::ZERO);
        let tells = |station: &Station, text: &str| station.tells_back(text.parse().unwrap());
        assert!(tells(&station, "0x40") && !tells(&station, "0x6B"), "nothing is known of the encoder yet");
        station.description = Descriptions::built_in().named("POSITAL IXARC kit encoder").cloned().map(Arc::new);
        for text in ["0x40", "0x6A", "0x6B", "0x01:0x02", "0x01:0x07", "0x04:0x00", "0x43:0x3F"] {
            assert!(tells(&station, text), "{text}");
        }
        let others = ["0x00:0x00", "0x00:0x06", "0x00:0x1A", "0x00:0x24", "0x01:0x00", "0x66", "0x02:0x05", "0x50"];
        for text in others {
            assert!(!tells(&station, text), "{text}");
        }
    }
}
