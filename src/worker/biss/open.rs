//! From a link URL to a session with a BiSS encoder.

use std::sync::{Arc, Mutex};

use super::Biss;
use crate::device::biss::{Echo, Station, Way};
use crate::link::{ByteLink, Clock, LinkUrl, Query, RealClock, Scheme, SimLink, UrlError};
use crate::sim::biss::{Config, Motor, Port};
use crate::sim::bridge::{self, Adapter};
use crate::store::Store;
use crate::worker::open::{check_parameters, margin, open_bytes};
use crate::worker::{OpenError, Session};

/// Whether an adapter is in between, where the kind of link does not tell.
const BRIDGE: &str = "bridge";
/// Link parameters that describe the line and nothing of the virtual device; `echo` and `order` describe both.
const LINE_ONLY: [&str; 7] = [BRIDGE, "baud", "parity", "timeout", "margin", "clock", "voltage"];

/// Opens a link to a BiSS encoder: `serial:` and `tcp:` lead to its configuration pin, `bridge:` to an adapter on its bus,
/// `sim:` and `replay:` to the one or, with `bridge=on`, to the other.
///
/// # Errors
/// See [`OpenError`]; nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Biss>, OpenError> {
    let way = way(url)?;
    let is_virtual = url.scheme == Scheme::Sim;
    if is_virtual {
        check_virtual(&url.query, way)?;
    } else {
        let mut known = way.parameters().to_vec();
        known.extend((url.scheme == Scheme::Replay).then_some(BRIDGE));
        check_parameters(&url.query, url.scheme, &known)?;
    }
    let mut station = Station::from_query(&url.query, way, margin(url.scheme))?;
    if is_virtual {
        // Echo and order are the virtual encoder's: they are learned as with a real one.
        (station.line.echo, station.order) = (Echo::Unknown, None);
    }
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let mut motor = None;
    let wire = open_bytes(url, station.format, &clock, || {
        let (mut link, turning) = simulated(&url.query.without(&LINE_ONLY), way, &clock)?;
        link.set_format(station.format)?;
        motor = Some(turning);
        Ok(link)
    })?;
    Ok(Session::over(wire, clock, station, store, motor))
}

fn way(url: &LinkUrl) -> Result<Way, UrlError> {
    let by_word = |text: &str| match text {
        "on" => Some(Way::Adapter),
        "off" => Some(Way::ConfigPin),
        _ => None,
    };
    match url.scheme {
        Scheme::Bridge => Ok(Way::Adapter),
        Scheme::Serial | Scheme::Tcp => Ok(Way::ConfigPin),
        Scheme::Sim | Scheme::Replay => Ok(url.query.read(BRIDGE, "on or off", by_word)?.unwrap_or(Way::ConfigPin)),
    }
}

/// Refuses what neither the line nor the virtual device has, and tells what needs an adapter in between.
fn check_virtual(query: &Query, way: Way) -> Result<(), UrlError> {
    let own = |way: Way| {
        let adapter = if way == Way::Adapter { &bridge::Config::KEYS[..] } else { &[] };
        let line = way.parameters().iter().filter(|name| !Config::KEYS.contains(name));
        let own = [BRIDGE].iter().chain(line).chain(adapter).chain(&Config::KEYS);
        own.copied().collect::<Vec<_>>()
    };
    let known = own(way);
    let Some((name, _)) = query.without(&known).into_iter().next() else { return Ok(()) };
    let other = if way == Way::Adapter { Way::ConfigPin } else { Way::Adapter };
    let switch = if way == Way::Adapter { "off" } else { "on" };
    let elsewhere = own(other).into_iter().filter(|name| !known.contains(name));
    let elsewhere = elsewhere.map(|name| format!("{name} ({BRIDGE}={switch})"));
    let known: Vec<String> = known.iter().map(ToString::to_string).chain(elsewhere).collect();
    Err(UrlError::Unknown { name, scheme: Scheme::Sim.word(), known: known.join(", ") })
}

fn simulated(
    pairs: &[(String, String)],
    way: Way,
    clock: &Arc<dyn Clock>,
) -> Result<(Box<dyn ByteLink>, Motor), OpenError> {
    match way {
        Way::ConfigPin => {
            let port = Port::new(&Config::from_pairs(pairs)?);
            let motor = port.encoder().motor();
            Ok((Box::new(SimLink::connect(Arc::new(Mutex::new(port)), clock.clone())), motor))
        }
        Way::Adapter => {
            let adapter = Adapter::new(&bridge::Config::from_pairs(pairs)?);
            let motor = adapter.encoder().motor();
            Ok((Box::new(SimLink::connect(Arc::new(Mutex::new(adapter)), clock.clone())), motor))
        }
    }
}
