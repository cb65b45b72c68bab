//! Opening a session with an adapter or a hub from a link.

use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex};

use super::{DeviceConnection, Hiperdrive};
use crate::bits::MaskedBytes;
use crate::devices::hiperdrive::procedures::{LinkParameters, Station};
use crate::devices::hiperdrive::sim::{Config, Target};
use crate::link::{
    Clock, Direction, LinkScheme, LinkUrl, RealClock, ReplayLink, SimPort, TcpLink, TraceEntry, UdpPort, Wire,
};
use crate::store::Store;
use crate::worker::open::{connect_simulated, read_recording, reply_margin, simulator_settings, wrong_target_error};
use crate::worker::{OpenError, Session};

/// Checks a link to an adapter or a hub without opening it.
///
/// # Errors
/// Returns [`OpenError::Url`] or [`OpenError::Sim`] if a setting is invalid.
pub fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
    read(url).map(|_| ())
}

/// Opens a link to an adapter or a hub: `enip:` for a real device, `sim:` for a virtual one, and `replay:` for a
/// recording. A recording has no cyclic connection.
///
/// # Errors
/// Returns an [`OpenError`] if the link cannot be opened. Nothing has been sent in this case.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Hiperdrive>, OpenError> {
    let (station, config) = read(url)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let way = match url.wire() {
        Wire::File(path) => {
            let entries = read_recording(path)?.into_iter().map(mask_numbers).collect();
            let wire = Box::new(ReplayLink::new(path, entries, clock.clone()));
            DeviceConnection { wire, port: None, station, target: None }
        }
        Wire::Host(target) | Wire::Port(target) => {
            let wire = Box::new(TcpLink::connect(target, clock.clone())?);
            let port = Box::new(UdpPort::new(target, clock.clone()));
            DeviceConnection { wire, port: Some(port), station, target: None }
        }
        Wire::InProcess => open_virtual(&config, station, clock.clone()),
    };
    Ok(Session::for_target(way, clock, store))
}

/// Returns the connection to a virtual device in this process.
fn open_virtual(config: &Config, station: Station, clock: Arc<dyn Clock>) -> DeviceConnection {
    let target = Target::new(config);
    let connection = target.connect_from(Ipv4Addr::UNSPECIFIED);
    let wire = connect_simulated(connection, &clock);
    let port = Box::new(SimPort::new(Arc::new(Mutex::new(target.clone())), clock));
    DeviceConnection { wire, port: Some(port), station, target: Some(target) }
}

/// Parses the settings of the connection and of the virtual device. The latter are allowed only in a link to a virtual
/// device.
fn read(url: &LinkUrl) -> Result<(Station, Config), OpenError> {
    if !matches!(url.scheme, LinkScheme::Sim | LinkScheme::Enip | LinkScheme::Replay) {
        return Err(wrong_target_error(url.scheme, "sim:, enip:, replay:"));
    }
    let config = Config::from_pairs(&simulator_settings(url, LinkParameters::KEYS, Config::KEYS)?)?;
    let tcp = match url.wire() {
        Wire::Host(host) => host.rsplit_once(':').and_then(|(_, port)| port.parse().ok()),
        _ => None,
    };
    let mut station = Station::from_query(&url.query, tcp, reply_margin(url.scheme))?;
    station.recorded = url.scheme == LinkScheme::Replay;
    Ok((station, config))
}

/// Masks session and request numbers, which differ on each run, so that a recording matches any run.
fn mask_numbers(entry: TraceEntry) -> TraceEntry {
    const NUMBERS: [usize; 12] = [4, 5, 6, 7, 12, 13, 14, 15, 16, 17, 18, 19];
    let (Direction::Sent, Some(bytes)) = (entry.direction, entry.bytes.to_bytes()) else { return entry };
    TraceEntry { bytes: MaskedBytes::with_masked(&bytes, &NUMBERS), ..entry }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opens_link_or_reports_reason() {
        for text in [
            "sim:",
            "sim:?hub=4&drives=1,0,1&order=big&rpi=5&timeout=500",
            "enip:192.168.1.7",
            "enip:hub:50123?rpi=100&order=little&udp=2222&timeout=250",
            "replay:drives.trace",
        ] {
            assert!(check_link(&text.parse().unwrap()).is_ok(), "{text}");
        }
        for (text, why) in [
            (
                "serial:/dev/ttyUSB0",
                "serial: links cannot be used for this device; valid links begin with sim:, enip:, replay:",
            ),
            ("modbus:plc", "modbus: links cannot be used for this device; valid links begin with sim:, enip:, replay:"),
            ("enip:hub?hub=4", "hub is not a parameter of enip: links; valid parameters are rpi, order, udp, timeout"),
            ("enip:hub?rpi=4", "rpi=4 is not valid (allowed: a time in milliseconds from 5 to 100)"),
            ("sim:?rpi=1000", "rpi=1000 is not valid (allowed: a time in milliseconds from 5 to 100)"),
            ("sim:?what=1", "a virtual"),
        ] {
            let error = check_link(&text.parse().unwrap()).unwrap_err().to_string();
            assert!(error.starts_with(why), "{text}: {error}");
        }
    }
}
