//! State of an adapter or a hub, kept between jobs.

use std::collections::VecDeque;
use std::collections::hash_map::RandomState;
use std::fmt;
use std::hash::{BuildHasher, Hasher};
use std::time::Duration;

use crate::buses::ethernet_ip::protocol::{EXPLICIT_MESSAGE_PORT, IMPLICIT_MESSAGE_PORT, Receiver};
use crate::devices::hiperdrive::protocol::{ByteOrder, Topology};
use crate::expected::Quantity;
use crate::link::line::LineState;
use crate::link::{ReplyTimes, UrlError, UrlQuery};
use crate::parameter::{Milliseconds, OptionalValue, ParameterGroup, ParameterValues, WholeNumbers};
use crate::parameters;
use crate::units::Moment;

parameters! {
    #[derive(Copy)]
    pub struct LinkParameters: UrlError {
        pub interval: Duration = Duration::from_millis(10), "rpi" => Milliseconds(5..=100), "connect.interval";
        /// Byte order of process data.
        pub order: ByteOrder = ByteOrder::Little, "order" => ByteOrder::KEYWORDS;
        /// UDP port of cyclic data, unless the device reports another.
        pub udp: Option<u16> = None, "udp" => OptionalValue(WholeNumbers(Quantity::Port, 1..=u16::MAX)), "connect.udp_port" like "2222";
        /// Time limit of a reply, excluding the line margin.
        pub timeout: Duration = Duration::from_secs(1), "timeout" => Milliseconds(10..=LONGEST_TIMEOUT), "connect.reply_time";
    }
}

/// Longest time-out in milliseconds.
const LONGEST_TIMEOUT: u64 = 2000;

#[derive(Clone, Debug)]
pub struct Station {
    pub link: LinkParameters,
    /// UDP port of cyclic data, unless the device reports another.
    pub udp: u16,
    /// Whether the replies come from a recording and contain its request numbers.
    pub recorded: bool,
    pub(super) line: LineState,
    pub(super) session: Option<u32>,
    pub(super) next: u64,
    /// The latest unanswered requests: number, send time, and whether the requested operation takes long.
    open: VecDeque<(u64, Moment, bool)>,
    /// Reply times, including those of late replies but not those of operations that take long.
    pub(super) replies: ReplyTimes,
    /// Received bytes that do not form a complete frame yet.
    pub(super) receiver: Receiver,
    /// Number of frames that arrived too late.
    pub(super) late: u64,
    /// Originator ID for connections, different for each session.
    pub(super) originator: u32,
    pub(super) connections: u16,
    pub(super) known: KnownState,
    /// Category and serial number of the last identified device.
    pub identified: Option<(String, String)>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct KnownState {
    pub(super) topology: Option<Topology>,
}

impl Station {
    pub const LONGEST_TIMEOUT: Duration = Duration::from_millis(LONGEST_TIMEOUT);
    /// Maximum number of unanswered requests whose late replies can be recognised. A job gives up the connection before
    /// reaching this number.
    const OPEN: usize = 8;

    pub fn new(margin: Duration) -> Self {
        // Two programs in one network must not open their connections with the same originator ID.
        let random = RandomState::new().build_hasher().finish();
        Station {
            link: LinkParameters::default(),
            udp: IMPLICIT_MESSAGE_PORT,
            recorded: false,
            line: LineState::new(margin),
            session: None,
            next: 1,
            open: VecDeque::new(),
            replies: ReplyTimes::default(),
            receiver: Receiver::default(),
            late: 0,
            originator: random as u32,
            connections: (random >> 32) as u16,
            known: KnownState::default(),
            identified: None,
        }
    }

    /// Creates the station from the parameters of a link, ignoring those that do not concern the connection. `tcp` is
    /// the port for explicit messages.
    ///
    /// # Errors
    /// Returns an error with the allowed values if a value is invalid.
    pub fn from_query(query: &UrlQuery, tcp: Option<u16>, margin: Duration) -> Result<Self, UrlError> {
        let link = LinkParameters::read(query.pairs())?;
        // A server with a non-standard port for messages also uses this port for cyclic data.
        let beside = tcp.filter(|port| *port != EXPLICIT_MESSAGE_PORT).unwrap_or(IMPLICIT_MESSAGE_PORT);
        Ok(Station { link, udp: link.udp.unwrap_or(beside), ..Station::new(margin) })
    }

    pub const fn topology(&self) -> Option<Topology> {
        self.known.topology
    }

    pub const fn late_reply_count(&self) -> u64 {
        self.late
    }

    pub fn replies(&self) -> ReplyTimes {
        self.replies.clone()
    }

    /// Records that a request is sent, and returns a number for it.
    pub(super) fn begin_request(&mut self, at: Moment, takes_long: bool) -> u64 {
        let number = self.next;
        self.next = number.wrapping_add(1);
        self.open.truncate(Self::OPEN - 1);
        self.open.push_front((number, at, takes_long));
        number
    }

    /// Records a reply to the request with the given number, in time or late.
    pub(super) fn record_reply(&mut self, number: u64, at: Moment) {
        if let Some(place) = self.open.iter().position(|(own, ..)| *own == number)
            && let Some((_, sent, false)) = self.open.remove(place)
        {
            self.replies.record(at.duration_since(sent));
        }
    }
}

impl fmt::Display for Station {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (interval, order) = (self.link.interval.as_millis(), ByteOrder::KEYWORDS.format_example(&self.link.order));
        write!(f, "every {interval} ms, {order} endian, UDP port {}", self.udp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(query: &str, tcp: Option<u16>) -> Result<Station, UrlError> {
        Station::from_query(&query.parse().unwrap(), tcp, Duration::from_millis(50))
    }

    #[test]
    fn omitted_parameters_have_defaults() {
        assert_eq!(station("", Some(44818)).unwrap().to_string(), "every 10 ms, little endian, UDP port 2222");
        assert_eq!(station("", None).unwrap().udp, 2222);
        assert_eq!(station("", Some(50123)).unwrap().udp, 50123);
    }

    #[test]
    fn parses_connection_settings() {
        let station = station("rpi=5&order=big&udp=3333&timeout=250", Some(50123)).unwrap();
        assert_eq!(station.to_string(), "every 5 ms, big endian, UDP port 3333");
        assert_eq!(station.link.timeout, Duration::from_millis(250));
    }

    #[test]
    fn rejection_lists_allowed_values() {
        let cases = [
            ("rpi=4", "rpi=4 is not valid (allowed: a time in milliseconds from 5 to 100)"),
            ("rpi=101", "rpi=101 is not valid (allowed: a time in milliseconds from 5 to 100)"),
            ("order=middle", "order=middle is not valid (allowed: little or big)"),
            ("udp=0", "udp=0 is not valid (allowed: a port number from 1 to 65535)"),
            ("timeout=5000", "timeout=5000 is not valid (allowed: a time in milliseconds from 10 to 2000)"),
        ];
        for (query, message) in cases {
            assert_eq!(station(query, None).unwrap_err().to_string(), message);
        }
    }
}
