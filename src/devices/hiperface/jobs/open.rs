//! Opens a session with a HIPERFACE encoder from a link.

use std::sync::Arc;

use super::{Hiperface, encoder_types};
use crate::buses::bridge::jobs::FORMAT;
use crate::buses::bridge::procedures::{AdapterSerialLink, DeviceLine};
use crate::devices::hiperface::procedures::{AdapterParameters, Echo, LinkParameters, Station};
use crate::devices::hiperface::protocol::MAX_TRANSFER;
use crate::devices::hiperface::sim::{Bus, Config};
use crate::link::{ByteLink, Clock, LinkScheme, LinkUrl, RealClock};
use crate::parameter::ParameterGroup;
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
/// sine and cosine, so a drive may be present even if the line is silent.
pub fn may_have_other_master(url: &LinkUrl) -> bool {
    matches!(url.scheme, LinkScheme::Serial | LinkScheme::Tcp | LinkScheme::Bridge)
}

/// Opens a link to a HIPERFACE encoder.
///
/// # Errors
/// Returns an [`OpenError`] if the link cannot be opened. In this case, nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Hiperface>, OpenError> {
    let (station, config, adapter) = read(url)?;
    let types = encoder_types(&store)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let format = if url.scheme == LinkScheme::Bridge { FORMAT } else { station.format };
    let mut wire = open_byte_stream(url, format, &clock, || {
        let mut link = connect_simulated(Bus::new(&config), &clock);
        link.set_format(station.format)?;
        Ok(link)
    })?;
    if url.scheme == LinkScheme::Bridge {
        wire = adapter_link(wire, &clock, url, &station, adapter);
    }
    Ok(Session::new(wire, clock, station, store, types, url.scheme == LinkScheme::Sim))
}

/// Returns a link to the encoder through an adapter's serial line.
fn adapter_link(
    wire: Box<dyn ByteLink>,
    clock: &Arc<dyn Clock>,
    url: &LinkUrl,
    station: &Station,
    parameters: AdapterParameters,
) -> Box<dyn ByteLink> {
    // Address, command, three arguments and the checksum surround the data.
    let max_reply = MAX_TRANSFER + 6;
    let line = DeviceLine { format: station.format, margin: station.line.margin, max_reply };
    let supply = (parameters.supply(), parameters.after);
    Box::new(AdapterSerialLink::new(wire, clock.clone(), &url.target, line, supply))
}

/// Parses the line settings, the settings of an adapter, and the configuration of the virtual encoder. Only a link to a
/// virtual encoder uses this configuration.
fn read(url: &LinkUrl) -> Result<(Station, Config, AdapterParameters), OpenError> {
    if matches!(url.scheme, LinkScheme::Modbus | LinkScheme::Enip) {
        return Err(wrong_target_error(url.scheme, "sim:, serial:, tcp:, bridge:, replay:"));
    }
    let mut station = Station::from_query(&url.query, reply_margin(url.scheme))?;
    let at_adapter = url.scheme == LinkScheme::Bridge;
    let keys = [LinkParameters::KEYS, if at_adapter { AdapterParameters::KEYS } else { &[] }].concat();
    let settings = simulator_settings(url, &keys, Config::KEYS)?;
    let adapter = AdapterParameters::read(url.query.pairs())?;
    if url.scheme == LinkScheme::Sim {
        // The converter of the virtual encoder may produce an echo, which is detected as it is for a real converter.
        station.line.echo = Echo::Unknown;
        let line = LinkParameters::KEYS.iter().filter(|key| !Config::KEYS.contains(key));
        check_parameters(&url.query, url.scheme, &line.chain(Config::KEYS).copied().collect::<Vec<_>>())?;
    }
    Ok((station, Config::from_pairs(&settings)?, adapter))
}
