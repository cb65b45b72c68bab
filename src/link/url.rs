//! Link URLs, for example `serial:/dev/ttyUSB0?baud=9600&parity=even`. The code that opens a link interprets the
//! parameters.

use std::fmt;
use std::str::FromStr;

use crate::expected::AllowedValues;
use crate::parameter::{ParameterValues, RejectedParameter};

/// The kind of connection that a link opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkScheme {
    /// A virtual device in this process.
    Sim,
    /// A serial port of this computer.
    Serial,
    /// A serial device server in the network.
    Tcp,
    /// A recorded trace, which is played back.
    Replay,
    /// An adapter for clocked buses, at a serial port or a TCP address.
    Bridge,
    /// A Modbus/TCP gateway that gives access to process data.
    Modbus,
    /// EtherNet/IP, with explicit messages over TCP and cyclic data in datagrams.
    Enip,
}

impl LinkScheme {
    const ALL: [(LinkScheme, &'static str); 7] = [
        (LinkScheme::Sim, "sim"),
        (LinkScheme::Serial, "serial"),
        (LinkScheme::Tcp, "tcp"),
        (LinkScheme::Replay, "replay"),
        (LinkScheme::Bridge, "bridge"),
        (LinkScheme::Modbus, "modbus"),
        (LinkScheme::Enip, "enip"),
    ];

    /// Returns the keyword before the colon.
    pub fn keyword(self) -> &'static str {
        Self::ALL.iter().find(|(scheme, _)| *scheme == self).map_or("", |(_, word)| word)
    }

    /// Describes what must follow the colon, with an example.
    fn target_hint(self) -> &'static str {
        match self {
            LinkScheme::Tcp => "a host and a port, as in tcp:192.168.0.7:4001",
            LinkScheme::Modbus => "a host, as in modbus:192.168.0.7 or modbus:192.168.0.7:502",
            LinkScheme::Enip => "a host, as in enip:192.168.1.7 or enip:192.168.1.7:44818",
            LinkScheme::Bridge => {
                "a serial port, or a host and a port, as in bridge:/dev/ttyACM0 or bridge:tcp:192.168.0.7:4001"
            }
            LinkScheme::Replay => "a file, as in replay:capture.trace",
            LinkScheme::Serial | LinkScheme::Sim => "a serial port, as in serial:/dev/ttyUSB0 or serial:COM3",
        }
    }
}

/// A parsed link. The command line and the window use the same syntax.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkUrl {
    /// Kind of connection.
    pub scheme: LinkScheme,
    /// Path, host and port, or file. Empty for `sim:`.
    ///
    /// For `bridge:`, this is a path, or `tcp:` followed by host and port. For `modbus:` and `enip:`, the port is
    /// always included and defaults to 502 or 44818.
    pub target: String,
    /// Parameters after the question mark.
    pub query: UrlQuery,
}

/// The port, host or file that a link uses. Several links may use the same resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire<'a> {
    /// A virtual device in this process, which needs no external resource.
    InProcess,
    /// Path or name of a serial port.
    Port(&'a str),
    /// Host and TCP port, as in the link.
    Host(&'a str),
    /// Path of a recorded trace.
    File(&'a str),
}

/// The parameters of a link in the order in which they were written. Names are lower case and unique.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UrlQuery(Vec<(String, String)>);

/// The reason why a text is not a valid link.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UrlError {
    /// The colon is missing, or the keyword before it is unknown.
    #[error("{0:?} is not a link: a link begins with sim:, serial:, tcp:, modbus:, enip:, replay: or bridge:")]
    Scheme(String),
    /// This kind of link cannot be used for the device.
    #[error("{scheme}: links cannot be used for this device; valid links begin with {known}")]
    Device {
        /// Keyword before the colon.
        scheme: &'static str,
        /// Keywords that are allowed for the device.
        known: &'static str,
    },
    /// The port, host or file is missing.
    #[error("{}: needs {}", scheme.keyword(), scheme.target_hint())]
    Target {
        /// Kind of connection.
        scheme: LinkScheme,
    },
    /// The port number is invalid.
    #[error("{scheme}: {port} is not a port number from 1 to 65535")]
    Port {
        /// Keyword before the colon.
        scheme: &'static str,
        /// The invalid port.
        port: String,
    },
    /// A parameter is not of the form `name=value`.
    #[error("{0:?} is not of the form name=value")]
    Parameter(String),
    /// A parameter occurs twice.
    #[error("{0} appears twice")]
    Twice(String),
    /// The link does not accept a parameter.
    #[error("{name} is not a parameter of {scheme}: links; valid parameters are {known}")]
    Unknown {
        /// Name of the parameter as written.
        name: String,
        /// Keyword before the colon.
        scheme: &'static str,
        /// Names of the valid parameters.
        known: String,
    },
    /// A value is invalid.
    #[error("{name}={value} is not valid (allowed: {allowed})")]
    Value {
        /// Name of the parameter.
        name: String,
        /// Value as written.
        value: String,
        /// Description of the allowed values.
        allowed: AllowedValues,
    },
}

impl From<RejectedParameter> for UrlError {
    fn from(RejectedParameter { key: name, value, allowed }: RejectedParameter) -> Self {
        UrlError::Value { name, value, allowed }
    }
}

impl FromStr for LinkUrl {
    type Err = UrlError;

    fn from_str(text: &str) -> Result<Self, UrlError> {
        let text = text.trim();
        let scheme_error = || UrlError::Scheme(text.to_owned());
        let (word, rest) = text.split_once(':').ok_or_else(scheme_error)?;
        let (scheme, _) =
            LinkScheme::ALL.into_iter().find(|(_, known)| known.eq_ignore_ascii_case(word)).ok_or_else(scheme_error)?;
        let (target, query) = rest.split_once('?').unwrap_or((rest, ""));
        let mut target = target.trim_end().to_owned();
        let port = match scheme {
            LinkScheme::Modbus => MODBUS_PORT,
            LinkScheme::Enip => ENIP_PORT,
            _ => "",
        };
        if has_no_port(&target) {
            target.push_str(port);
        }
        let url = LinkUrl { scheme, target, query: query.parse()? };
        url.check_target()?;
        Ok(url)
    }
}

impl LinkUrl {
    /// Returns a link to the virtual device with default settings.
    pub fn simulated() -> Self {
        LinkUrl { scheme: LinkScheme::Sim, target: String::new(), query: UrlQuery::default() }
    }

    /// Returns the port, host or file that the link uses.
    pub fn wire(&self) -> Wire<'_> {
        let target = self.target.as_str();
        match (self.scheme, target.strip_prefix("tcp:")) {
            (LinkScheme::Sim, _) => Wire::InProcess,
            (LinkScheme::Replay, _) => Wire::File(target),
            (LinkScheme::Tcp | LinkScheme::Modbus | LinkScheme::Enip, _) => Wire::Host(target),
            (LinkScheme::Bridge, Some(host)) => Wire::Host(host),
            (LinkScheme::Serial, _) | (LinkScheme::Bridge, None) => Wire::Port(target),
        }
    }

    fn check_target(&self) -> Result<(), UrlError> {
        if self.scheme == LinkScheme::Sim && !self.target.is_empty() {
            return Err(UrlError::Parameter(self.target.clone()));
        }
        let is_there = match self.wire() {
            Wire::InProcess => true,
            Wire::Port(name) | Wire::File(name) => !name.is_empty(),
            Wire::Host(host) => match host.rsplit_once(':') {
                Some((host, port)) if !host.is_empty() && !port.is_empty() => {
                    let is_port = port.parse::<u16>().is_ok_and(|port| port != 0);
                    let (scheme, port) = (self.scheme.keyword(), port.to_owned());
                    return if is_port { Ok(()) } else { Err(UrlError::Port { scheme, port }) };
                }
                _ => false,
            },
        };
        if is_there { Ok(()) } else { Err(UrlError::Target { scheme: self.scheme }) }
    }
}

const MODBUS_PORT: &str = ":502";
const ENIP_PORT: &str = ":44818";

/// Returns whether the target is a host without a port number. The host may be an IPv6 address in brackets.
fn has_no_port(target: &str) -> bool {
    !target.is_empty() && (!target.contains(':') || target.ends_with(']'))
}

impl fmt::Display for LinkUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.scheme.keyword(), self.target)?;
        for (at, (name, value)) in self.query.0.iter().enumerate() {
            let separator = if at == 0 { '?' } else { '&' };
            write!(f, "{separator}{name}={value}")?;
        }
        Ok(())
    }
}

impl FromStr for UrlQuery {
    type Err = UrlError;

    fn from_str(text: &str) -> Result<Self, UrlError> {
        let mut query = UrlQuery::default();
        for parameter in text.split('&').map(str::trim).filter(|parameter| !parameter.is_empty()) {
            let (name, value) = parameter.split_once('=').ok_or_else(|| UrlError::Parameter(parameter.to_owned()))?;
            let (name, value) = (name.trim_end().to_ascii_lowercase(), value.trim_start());
            if query.get(&name).is_some() {
                return Err(UrlError::Twice(name));
            }
            query.0.push((name, value.to_owned()));
        }
        Ok(query)
    }
}

impl UrlQuery {
    /// Returns the value of a parameter, if present.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, value)| value.as_str())
    }

    /// Sets a parameter. An existing parameter keeps its position.
    pub fn set(&mut self, name: &str, value: &str) {
        match self.0.iter_mut().find(|(own, _)| own == name) {
            Some((_, own)) => value.clone_into(own),
            None => self.0.push((name.to_owned(), value.to_owned())),
        }
    }

    /// Returns all parameters in the order in which they were written.
    pub fn pairs(&self) -> &[(String, String)] {
        &self.0
    }

    /// Returns the parameters that are not in `names`.
    pub fn without(&self, names: &[&str]) -> Vec<(String, String)> {
        self.0.iter().filter(|(name, _)| !names.contains(&name.as_str())).cloned().collect()
    }

    /// Parses a parameter, or returns `None` if it is missing.
    ///
    /// # Errors
    /// Returns an error if the value is not allowed.
    pub fn read<V: ParameterValues>(&self, name: &str, values: &V) -> Result<Option<V::Value>, UrlError> {
        Ok(self.get(name).map(|value| values.parse_value(name, value)).transpose()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expected::Quantity;
    use crate::parameter::WholeNumbers;

    #[test]
    fn links_round_trip() {
        for text in [
            "sim:",
            "sim:?seed=7&fault=drop:0.01",
            "serial:/dev/ttyUSB0?baud=9600&parity=even&address=0x40&echo=auto",
            "serial:COM3",
            "tcp:192.168.0.7:4001",
            "tcp:[::1]:4001?baud=9600",
            "replay:captures/monday.trace",
            "bridge:/dev/ttyACM0?clock=2000000",
            "bridge:tcp:192.168.0.7:4001",
            "modbus:192.168.0.7:502?unit=1&input=0&output=0&order=high-first",
            "enip:192.168.1.7:44818?rpi=10&order=little",
        ] {
            assert_eq!(text.parse::<LinkUrl>().unwrap().to_string(), text);
        }
        let url: LinkUrl = "SERIAL:/dev/ttyUSB0?Baud=19200".parse().unwrap();
        assert_eq!((url.scheme, url.target.as_str()), (LinkScheme::Serial, "/dev/ttyUSB0"));
        assert_eq!(url.query.get("baud"), Some("19200"));
    }

    #[test]
    fn rejects_invalid_links_with_reason() {
        let cases = [
            ("", "\"\" is not a link: a link begins with sim:, serial:, tcp:, modbus:, enip:, replay: or bridge:"),
            (
                "/dev/ttyUSB0",
                "\"/dev/ttyUSB0\" is not a link: a link begins with sim:, serial:, tcp:, modbus:, enip:, replay: or bridge:",
            ),
            (
                "usb:1",
                "\"usb:1\" is not a link: a link begins with sim:, serial:, tcp:, modbus:, enip:, replay: or bridge:",
            ),
            ("serial:", "serial: needs a serial port, as in serial:/dev/ttyUSB0 or serial:COM3"),
            ("tcp:host", "tcp: needs a host and a port, as in tcp:192.168.0.7:4001"),
            ("tcp:host:99999", "tcp: 99999 is not a port number from 1 to 65535"),
            ("tcp:host:0", "tcp: 0 is not a port number from 1 to 65535"),
            ("tcp:host:", "tcp: needs a host and a port, as in tcp:192.168.0.7:4001"),
            ("enip:127.0.0.1:99999", "enip: 99999 is not a port number from 1 to 65535"),
            ("enip:", "enip: needs a host, as in enip:192.168.1.7 or enip:192.168.1.7:44818"),
            ("replay:", "replay: needs a file, as in replay:capture.trace"),
            (
                "bridge:",
                "bridge: needs a serial port, or a host and a port, as in bridge:/dev/ttyACM0 or \
                 bridge:tcp:192.168.0.7:4001",
            ),
            (
                "bridge:tcp:host",
                "bridge: needs a serial port, or a host and a port, as in bridge:/dev/ttyACM0 or \
                 bridge:tcp:192.168.0.7:4001",
            ),
            ("modbus:", "modbus: needs a host, as in modbus:192.168.0.7 or modbus:192.168.0.7:502"),
            ("modbus:plc:many", "modbus: many is not a port number from 1 to 65535"),
            ("serial:x?baud", "\"baud\" is not of the form name=value"),
            ("serial:x?baud=1&baud=2", "baud appears twice"),
        ];
        for (text, message) in cases {
            assert_eq!(text.parse::<LinkUrl>().unwrap_err().to_string(), message);
        }
    }

    #[test]
    fn gateway_defaults_to_modbus_port() {
        for (text, whole) in [
            ("modbus:plc", "modbus:plc:502"),
            ("modbus:[::1]?unit=3", "modbus:[::1]:502?unit=3"),
            ("modbus:[::1]:1502", "modbus:[::1]:1502"),
            ("modbus:plc:1502", "modbus:plc:1502"),
            ("enip:192.168.1.7", "enip:192.168.1.7:44818"),
            ("enip:hub?rpi=5", "enip:hub:44818?rpi=5"),
            ("enip:127.0.0.1:50123", "enip:127.0.0.1:50123"),
        ] {
            assert_eq!(text.parse::<LinkUrl>().unwrap().to_string(), whole);
        }
    }

    #[test]
    fn recognizes_links_to_same_wire() {
        let wire = |text: &str| format!("{:?}", text.parse::<LinkUrl>().unwrap().wire());
        assert_eq!(wire("bridge:/dev/ttyACM0?clock=1"), wire("serial:/dev/ttyACM0"));
        assert_eq!(wire("bridge:tcp:[::1]:4001"), wire("tcp:[::1]:4001"));
        assert_eq!(wire("replay:/dev/ttyACM0"), "File(\"/dev/ttyACM0\")");
        assert_eq!(wire("sim:"), "InProcess");
    }

    #[test]
    fn bad_value_names_allowed_values() {
        let query: UrlQuery = "baud=fast".parse().unwrap();
        let speeds = WholeNumbers(Quantity::Number, 1..=9);
        let error = query.read("baud", &speeds).unwrap_err();
        assert_eq!(error.to_string(), "baud=fast is not valid (allowed: a number from 1 to 9)");
        assert_eq!(query.read("parity", &speeds), Ok(None));
    }
}
