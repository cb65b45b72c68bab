//! From a link URL to a session with a BiSS encoder.

use std::sync::{Arc, Mutex};

use super::Biss;
use crate::device::biss::{Echo, Station, Way};
use crate::link::{ByteLink, Clock, LinkUrl, RealClock, Scheme, SimLink, UrlError};
use crate::protocol::ubicom::FORMAT;
use crate::sim::biss::{Config, Motor, Port};
use crate::sim::bridge::{self, Adapter};
use crate::store::Store;
use crate::worker::open::{check_parameters, margin, open_bytes};
use crate::worker::{OpenError, Session};

/// Whether an adapter is in between, where the kind of link does not tell.
const BRIDGE: &str = "bridge";
/// Link parameters that describe the line and nothing of the virtual device; `echo` and `order` describe both.
const LINE_ONLY: [&str; 5] = [BRIDGE, "timeout", "margin", "clock", "voltage"];

/// Opens a link to a BiSS encoder: `serial:` and `tcp:` lead to its configuration pin, `bridge:` to an adapter on its bus,
/// `sim:` and `replay:` to the one or, with `bridge=on`, to the other.
///
/// # Errors
/// See [`OpenError`]; nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session<Biss>, OpenError> {
    let way = way(url)?;
    let is_virtual = url.scheme == Scheme::Sim;
    if !is_virtual {
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
    let wire = open_bytes(url, FORMAT, &clock, || {
        let (link, turning) = simulated(&url.query.without(&LINE_ONLY), way, &clock)?;
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
