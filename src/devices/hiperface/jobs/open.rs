//! Opening a session with a HIPERFACE encoder from a link.

use std::sync::Arc;

use super::{Hiperface, encoder_types};
use crate::devices::hiperface::procedures::{Echo, LinkParameters, Station};
use crate::devices::hiperface::sim::{Bus, Config};
use crate::link::{Clock, LinkScheme, LinkUrl, RealClock};
use crate::store::Store;
use crate::worker::open::{
    check_parameters, connect_simulated, open_byte_stream, reply_margin, simulator_settings, wrong_target_error,
};
use crate::worker::{OpenError, Session};

/// Checks a link to a HIPERFACE encoder without opening it.
///
/// # Errors
/// Returns [`OpenError::Url`] or [`OpenError::Sim`] if a setting is invalid.
pub fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
    read(url).map(|_| ())
}

/// Returns whether a drive may be a second master on the line. A drive reads the encoder only at power-up and then uses
/// sine and cosine, so it may be present even if the line is silent.
pub fn may_have_other_master(url: &LinkUrl) -> bool {
    matches!(url.scheme, LinkScheme::Serial | LinkScheme::Tcp)
}

/// Opens a link to a HIPERFACE encoder.
///
/// # Errors
/// Returns an [`OpenError`] if the link cannot be opened. In this case, nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Hiperface>, OpenError> {
    let (station, config) = read(url)?;
    let types = encoder_types(&store)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let wire = open_byte_stream(url, station.format, &clock, || {
        let mut link = connect_simulated(Bus::new(&config), &clock);
        link.set_format(station.format)?;
        Ok(link)
    })?;
    Ok(Session::new(wire, clock, station, store, types, url.scheme == LinkScheme::Sim))
}

/// Parses the line settings and the configuration of the virtual encoder. The latter is used only by a link to a
/// virtual encoder.
fn read(url: &LinkUrl) -> Result<(Station, Config), OpenError> {
    if matches!(url.scheme, LinkScheme::Bridge | LinkScheme::Modbus | LinkScheme::Enip) {
        return Err(wrong_target_error(url.scheme, "sim:, serial:, tcp:, replay:"));
    }
    let mut station = Station::from_query(&url.query, reply_margin(url.scheme))?;
    let settings = simulator_settings(url, LinkParameters::KEYS, Config::KEYS)?;
    if url.scheme == LinkScheme::Sim {
        // The converter of the virtual encoder may echo. This is detected as with a real one.
        station.line.echo = Echo::Unknown;
        let line = LinkParameters::KEYS.iter().filter(|key| !Config::KEYS.contains(key));
        check_parameters(&url.query, url.scheme, &line.chain(Config::KEYS).copied().collect::<Vec<_>>())?;
    }
    Ok((station, Config::from_pairs(&settings)?))
}
