//! Opens a session with an INTERBUS encoder from a link URL.

use std::sync::Arc;

use super::Interbus;
use crate::bits::MaskedBytes;
use crate::buses::ubicom::protocol::FORMAT;
use crate::devices::interbus::procedures::{LinkParameters, Station};
use crate::devices::interbus::sim::{Config, Gateway};
use crate::link::{Clock, Direction, LinkScheme, LinkUrl, RealClock, ReplayLink, TraceEntry, Wire};
use crate::store::Store;
use crate::worker::open::{
    connect_simulated, open_byte_stream, read_recording, reply_margin, simulator_settings, wrong_target_error,
};
use crate::worker::{OpenError, Session};

/// Checks the link URL of an INTERBUS encoder without opening the link.
///
/// # Errors
/// Returns [`OpenError::Url`] or [`OpenError::Sim`] if a setting is invalid.
pub fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
    read(url).map(|_| ())
}

/// Opens a link to an INTERBUS encoder: `modbus:` to a real gateway, `sim:` to a virtual encoder, `replay:` to a
/// recording.
///
/// # Errors
/// Returns an [`OpenError`] if the link cannot be opened. In this case, nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Interbus>, OpenError> {
    let (station, config) = read(url)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    if let Wire::File(path) = url.wire() {
        let entries = read_recording(path)?.into_iter().map(mask_numbers).collect();
        let wire = Box::new(ReplayLink::new(path, entries, clock.clone()));
        return Ok(Session::for_gateway(wire, clock, station, store, None));
    }
    let mut motor = None;
    // The connection to a gateway has no character format.
    let wire = open_byte_stream(url, FORMAT, &clock, || {
        let gateway = Gateway::new(&config);
        motor = Some(gateway.shaft_motor());
        Ok(connect_simulated(gateway, &clock))
    })?;
    Ok(Session::for_gateway(wire, clock, station, store, motor))
}

/// Returns the settings of the gateway and of the virtual encoder, which only `sim:` links use.
fn read(url: &LinkUrl) -> Result<(Station, Config), OpenError> {
    if !matches!(url.scheme, LinkScheme::Sim | LinkScheme::Modbus | LinkScheme::Replay) {
        return Err(wrong_target_error(url.scheme, "sim:, modbus:, replay:"));
    }
    let config = Config::from_pairs(&simulator_settings(url, LinkParameters::KEYS, Config::KEYS)?)?;
    let mut station = Station::from_query(&url.query, reply_margin(url.scheme))?;
    station.recorded = url.scheme == LinkScheme::Replay;
    Ok((station, config))
}

/// Masks the transaction number of a sent request. The number differs in every request and would prevent matches with a
/// recording.
fn mask_numbers(entry: TraceEntry) -> TraceEntry {
    let (Direction::Sent, Some(bytes)) = (entry.direction, entry.bytes.to_bytes()) else { return entry };
    TraceEntry { bytes: MaskedBytes::with_masked(&bytes, &[0, 1]), ..entry }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opens_gateway_or_reports_reason() {
        for text in [
            "sim:",
            "sim:?steps=360&rpm=60&order=low-first&unit=3&input=16&output=32&cycle=1",
            "modbus:192.168.0.7",
            "modbus:plc:1502?unit=0&input=0&output=2048&order=high-first&handshake=500",
            "replay:words.trace?unit=1",
        ] {
            assert!(check_link(&text.parse().unwrap()).is_ok(), "{text}");
        }
        for (text, why) in [
            (
                "serial:/dev/ttyUSB0",
                "serial: links cannot be used for this device; valid links begin with sim:, modbus:, replay:",
            ),
            (
                "tcp:host:502",
                "tcp: links cannot be used for this device; valid links begin with sim:, modbus:, replay:",
            ),
            (
                "bridge:/dev/x",
                "bridge: links cannot be used for this device; valid links begin with sim:, modbus:, replay:",
            ),
            (
                "modbus:plc?rpm=1",
                "rpm is not a parameter of modbus: links; valid parameters are unit, input, output, order",
            ),
            ("modbus:plc?unit=300", "unit=300 is not valid (allowed: a unit ID from 0 to 255)"),
            ("sim:?order=first", "`order=first`"),
            ("sim:?what=1", "a virtual"),
        ] {
            let error = check_link(&text.parse().unwrap()).unwrap_err().to_string();
            assert!(error.starts_with(why), "{text}: {error}");
        }
    }
}
