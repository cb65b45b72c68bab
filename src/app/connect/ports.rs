//! Serial ports in the order in which the connection form offers them.

use crate::link::{LinkScheme, LinkUrl, PortInfo};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortEntry {
    /// Path or name of the port as used in links.
    pub path: String,
    /// Description of the adapter as reported by the system. It may be empty.
    pub description: String,
    pub used: bool,
    /// Whether the port currently exists: the system lists it, or its path exists, as for a pseudo-terminal. A
    /// previously used port may have been unplugged.
    pub listed: bool,
}

/// Returns the previously used ports, most recent first, followed by USB adapters and then all other ports.
///
/// `links` contains the previously used links, most recent first. `exists` checks a path that the system does not list.
pub fn offered_ports(ports: &[PortInfo], links: &[String], exists: impl Fn(&str) -> bool) -> Vec<PortEntry> {
    let mut offers: Vec<PortEntry> = Vec::new();
    for url in links.iter().filter_map(|link| link.parse::<LinkUrl>().ok()) {
        if url.scheme == LinkScheme::Serial && offers.iter().all(|offer| offer.path != url.target) {
            let known = ports.iter().find(|port| port.path == url.target);
            let description = known.map(|port| port.description.clone()).unwrap_or_default();
            let listed = known.is_some() || exists(&url.target);
            offers.push(PortEntry { path: url.target, description, used: true, listed });
        }
    }
    let (usb, others): (Vec<&PortInfo>, Vec<&PortInfo>) =
        ports.iter().partition(|port| !port.description.is_empty() || port.serial_number.is_some());
    for port in usb.into_iter().chain(others) {
        if offers.iter().all(|offer| offer.path != port.path) {
            let (path, description) = (port.path.clone(), port.description.clone());
            offers.push(PortEntry { path, description, used: false, listed: true });
        }
    }
    offers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_used_ports_first() {
        let port = |path: &str, description: &str| PortInfo {
            path: path.to_owned(),
            description: description.to_owned(),
            serial_number: None,
        };
        let ports = [
            port("/dev/ttyS0", ""),
            port("/dev/ttyS1", ""),
            port("/dev/ttyUSB0", "FTDI FT232R"),
            port("/dev/ttyUSB1", "FTDI FT4232H"),
        ];
        let links = [
            "sim:",
            "serial:/dev/ttyUSB1?baud=19200",
            "no link",
            "serial:/tmp/enc0",
            "serial:/tmp/enc1",
            "serial:/dev/ttyUSB1",
            "serial:/dev/ttyS1",
        ]
        .map(str::to_owned);
        let offers = offered_ports(&ports, &links, |path| path == "/tmp/enc0");
        let shown: Vec<(&str, &str, bool, bool)> =
            offers.iter().map(|o| (o.path.as_str(), o.description.as_str(), o.used, o.listed)).collect();
        assert_eq!(
            shown,
            [
                ("/dev/ttyUSB1", "FTDI FT4232H", true, true),
                ("/tmp/enc0", "", true, true),
                ("/tmp/enc1", "", true, false),
                ("/dev/ttyS1", "", true, true),
                ("/dev/ttyUSB0", "FTDI FT232R", false, true),
                ("/dev/ttyS0", "", false, true),
            ]
        );
        assert!(offered_ports(&[], &[], |_| false).is_empty());
    }
}
