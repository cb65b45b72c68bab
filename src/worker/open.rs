//! From a link URL to a session.

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::Session;
use crate::device::hiperface::{PARAMETERS, Station};
use crate::link::{
    ByteLink, Clock, LinkError, LinkUrl, Query, RealClock, ReplayLink, Scheme, SerialLink, SimLink, TcpLink,
    TraceFileError, UrlError, read_trace,
};
use crate::sim::hiperface::{Bus, Config, ConfigError};
use crate::store::{FileError, Store, StoreError, read_text};

/// Why a link cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// A parameter.
    #[error(transparent)]
    Url(#[from] UrlError),
    /// A parameter of the virtual encoder.
    #[error(transparent)]
    Sim(#[from] ConfigError),
    /// The wire.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The recording cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The recording is not one.
    #[error("{path}: {cause}")]
    Recording {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: TraceFileError,
    },
    /// The user's table of encoder types.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// How much later than the protocol's worst case a reply may come, by kind of wire: USB adapters deliver in packets,
/// device servers over a network, and even a thread has to be woken up.
const fn margin(scheme: Scheme) -> Duration {
    match scheme {
        Scheme::Serial => Duration::from_millis(50),
        Scheme::Tcp => Duration::from_millis(100),
        Scheme::Sim | Scheme::Replay => Duration::from_millis(20),
    }
}

/// Opens a link to a HIPERFACE encoder.
///
/// # Errors
/// See [`OpenError`]; nothing has been sent.
pub fn open(url: &LinkUrl, store: Store) -> Result<Session, OpenError> {
    let types = store.encoder_types()?;
    let mut station = Station::from_query(&url.query, margin(url.scheme))?;
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let wire: Box<dyn ByteLink> = match url.scheme {
        Scheme::Sim => {
            // The virtual encoder's converter may echo; whether it does is learned as with a real one.
            station.echo = crate::device::hiperface::Echo::Unknown;
            let line_only = ["baud", "parity", "timeout", "margin", "periods", "turns"];
            let config = Config::from_pairs(&url.query.without(&line_only))?;
            let mut link = SimLink::connect(Arc::new(Mutex::new(Bus::new(&config))), clock.clone());
            link.set_format(station.format)?;
            Box::new(link)
        }
        Scheme::Serial => {
            check_parameters(&url.query, url.scheme)?;
            Box::new(SerialLink::open(&url.target, station.format, clock.clone())?)
        }
        Scheme::Tcp => {
            check_parameters(&url.query, url.scheme)?;
            Box::new(TcpLink::connect(&url.target, clock.clone())?)
        }
        Scheme::Replay => {
            check_parameters(&url.query, url.scheme)?;
            let text = read_text(Path::new(&url.target))?;
            let entries =
                read_trace(&text).map_err(|cause| OpenError::Recording { path: url.target.clone(), cause })?;
            Box::new(ReplayLink::new(&url.target, entries, clock.clone()))
        }
    };
    Ok(Session::new(wire, clock, station, store, types, url.scheme == Scheme::Sim))
}

fn check_parameters(query: &Query, scheme: Scheme) -> Result<(), UrlError> {
    match query.without(&PARAMETERS).into_iter().next() {
        None => Ok(()),
        Some((name, _)) => Err(UrlError::Unknown { name, scheme: scheme.word(), known: PARAMETERS.join(", ") }),
    }
}
