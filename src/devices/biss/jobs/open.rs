//! Opening a link to a BiSS encoder as a session.

use std::sync::Arc;

use super::Biss;
use crate::buses::bridge::jobs::FORMAT;
use crate::buses::bridge::procedures::{AdapterSerialLink, DeviceLine, LineSupply, MAX_TIMEOUT_MS, SupplyAfterSession};
use crate::buses::bridge::sim::{self as bridge, Adapter};
use crate::buses::ubicom::protocol::{Frame, MAX_PAYLOAD};
use crate::devices::biss::procedures::{Echo, Station, Supply, Transport};
use crate::devices::biss::sim::{Config, UbicomPort};
use crate::kinds::attachable_kinds;
use crate::link::{ByteLink, Clock, LinkScheme, LinkUrl, RealClock, UrlError, UrlQuery};
use crate::parameter::{Keywords, Milliseconds, Millivolts, OptionalValue, ParameterGroup, SWITCH};
use crate::parameters;
use crate::sim::{ConfigError, Motor};
use crate::store::Store;
use crate::worker::open::{check_parameters, connect_simulated, open_byte_stream, reply_margin, wrong_target_error};
use crate::worker::{OpenError, Session};

/// Link parameter that selects an adapter if the link scheme does not imply one.
const BRIDGE: &str = "bridge";

parameters! {
    /// Link parameters for a configuration pin that is wired to the serial line of an adapter.
    struct AdapterPinParameters: UrlError {
        is_pin: bool = false, "pin" => SWITCH;
        /// Supply voltage that the adapter provides to the encoder, in millivolts, or `None` for no supply.
        millivolt: Option<u16> = None, "voltage" => OptionalValue(Millivolts(Supply::RANGE));
        after: SupplyAfterSession = SupplyAfterSession::AsFound, "leave-supply" => SupplyAfterSession::KEYWORDS;
    }
}

/// Checks a link to a BiSS encoder without opening it.
///
/// # Errors
/// Returns [`OpenError::Url`] or [`OpenError::Sim`] if a setting is invalid.
pub fn check_link(url: &LinkUrl) -> Result<(), OpenError> {
    read(url).map(|_| ())
}

/// Opens a link to a BiSS encoder. `serial:` and `tcp:` links connect to its configuration pin. `bridge:` links connect
/// to an adapter on its bus or, with `pin=on`, to the configuration pin through the adapter's serial line. `sim:` and
/// `replay:` links use the pin or, with `bridge=on`, an adapter.
///
/// # Errors
/// Returns an [`OpenError`] if the link cannot be opened. In this case, nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Biss>, OpenError> {
    let (station, simulated) = read(url)?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let mut motor = None;
    let format = if url.scheme == LinkScheme::Bridge { FORMAT } else { station.format };
    let mut wire = open_byte_stream(url, format, &clock, || {
        let (mut link, turning) = simulated.connect(&clock);
        link.set_format(station.format)?;
        motor = turning;
        Ok(link)
    })?;
    if url.scheme == LinkScheme::Bridge && station.transport == Transport::ConfigPin {
        let AdapterPinParameters { millivolt, after, .. } = AdapterPinParameters::read(url.query.pairs())?;
        let supply = millivolt.map(|own| LineSupply { voltage: Supply::with_voltage(own), power_up: Supply::POWER_UP });
        let max_reply = Frame::OVERHEAD + MAX_PAYLOAD;
        let line = DeviceLine { format: station.format, margin: station.line.margin, max_reply };
        wire = Box::new(AdapterSerialLink::new(wire, clock.clone(), &url.target, line, (supply, after)));
    }
    Ok(Session::from_connection(wire, clock, station, store, motor))
}

/// Parses the line settings from a link, and the device settings if the link is to a virtual encoder.
fn read(url: &LinkUrl) -> Result<(Station, VirtualEncoder), OpenError> {
    let way = parse_transport(url)?;
    let is_virtual = url.scheme == LinkScheme::Sim;
    if is_virtual {
        check_virtual_parameters(&url.query, way)?;
    } else {
        let mut known = way.parameters();
        known.extend((url.scheme == LinkScheme::Replay).then_some(BRIDGE));
        let of_the_pin = if url.scheme == LinkScheme::Bridge { AdapterPinParameters::KEYS } else { &[] };
        // The bus has some of these parameters as well.
        known.extend(of_the_pin.iter().filter(|name| !way.parameters().contains(name)));
        check_parameters(&url.query, url.scheme, &known)?;
        if url.scheme == LinkScheme::Bridge && way == Transport::ConfigPin {
            // The adapter does not support longer time-outs.
            url.query.read("timeout", &Milliseconds(1..=MAX_TIMEOUT_MS))?;
        }
    }
    let mut station = Station::from_query(&url.query, way, reply_margin(url.scheme))?;
    if !is_virtual {
        return Ok((station, VirtualEncoder::new(way, &[])?));
    }
    // The parameters for echo and byte order configure the virtual encoder. The host detects both, as it does for a
    // real encoder.
    (station.line.echo, station.order) = (Echo::Unknown, None);
    let line = [Transport::ConfigPin, Transport::Adapter].map(Transport::parameters).concat();
    let of_the_encoder = |name: &str| name != BRIDGE && (Config::KEYS.contains(&name) || !line.contains(&name));
    let settings: Vec<_> = url.query.pairs().iter().filter(|(name, _)| of_the_encoder(name)).cloned().collect();
    Ok((station, VirtualEncoder::new(way, &settings)?))
}

fn parse_transport(url: &LinkUrl) -> Result<Transport, OpenError> {
    const TRANSPORT_KEYWORDS: Keywords<Transport> =
        Keywords(&[("on", Transport::Adapter), ("off", Transport::ConfigPin)]);
    match url.scheme {
        LinkScheme::Bridge if AdapterPinParameters::read(url.query.pairs())?.is_pin => Ok(Transport::ConfigPin),
        LinkScheme::Bridge => Ok(Transport::Adapter),
        LinkScheme::Serial | LinkScheme::Tcp => Ok(Transport::ConfigPin),
        LinkScheme::Modbus | LinkScheme::Enip => {
            Err(wrong_target_error(url.scheme, "sim:, serial:, tcp:, bridge:, replay:"))
        }
        LinkScheme::Sim | LinkScheme::Replay => {
            Ok(url.query.read(BRIDGE, &TRANSPORT_KEYWORDS)?.unwrap_or(Transport::ConfigPin))
        }
    }
}

/// Rejects parameters that neither the line nor the virtual device accepts. The error lists the valid ones, including
/// those of the other transport.
fn check_virtual_parameters(query: &UrlQuery, way: Transport) -> Result<(), UrlError> {
    let own = |way: Transport| {
        let line = way.parameters().into_iter().filter(|name| !Config::KEYS.contains(name));
        let device = if way == Transport::Adapter {
            bridge::all_setting_names(attachable_kinds())
        } else {
            Config::KEYS.to_vec()
        };
        [BRIDGE].into_iter().chain(line).chain(device).collect::<Vec<_>>()
    };
    let known = own(way);
    let Some((name, _)) = query.without(&known).into_iter().next() else { return Ok(()) };
    let other = if way == Transport::Adapter { Transport::ConfigPin } else { Transport::Adapter };
    let switch = if way == Transport::Adapter { "off" } else { "on" };
    let elsewhere = own(other).into_iter().filter(|name| !known.contains(name));
    let elsewhere = elsewhere.map(|name| format!("{name} ({BRIDGE}={switch})"));
    let known: Vec<String> = known.iter().map(ToString::to_string).chain(elsewhere).collect();
    Err(UrlError::Unknown { name, scheme: LinkScheme::Sim.keyword(), known: known.join(", ") })
}

/// A virtual encoder with the settings from its link, connected to the configuration pin or to an adapter.
enum VirtualEncoder {
    Pin(Box<Config>),
    Bus(Box<Adapter>),
}

impl VirtualEncoder {
    fn new(way: Transport, pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        Ok(match way {
            Transport::ConfigPin => VirtualEncoder::Pin(Box::new(Config::from_pairs(pairs)?)),
            Transport::Adapter => VirtualEncoder::Bus(Box::new(Adapter::from_pairs(pairs, attachable_kinds())?)),
        })
    }

    fn connect(self, clock: &Arc<dyn Clock>) -> (Box<dyn ByteLink>, Option<Motor>) {
        match self {
            VirtualEncoder::Pin(config) => {
                let port = UbicomPort::new(&config);
                let motor = port.encoder().motor();
                (connect_simulated(port, clock), Some(motor))
            }
            VirtualEncoder::Bus(adapter) => {
                let motor = adapter.motor();
                (connect_simulated(*adapter, clock), Some(motor))
            }
        }
    }
}
