//! Opening of connections from links, for all devices on a byte stream.

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::link::{
    ByteLink, Clock, LinkError, LinkScheme, LinkUrl, ReplayLink, SerialLink, SimLink, TcpLink, TraceEntry,
    TraceFileError, UrlError, UrlQuery, Wire, read_trace,
};
use crate::sim::{ByteDevice, ConfigError};
use crate::store::{FileError, StoreError, read_text};
use crate::units::CharacterFormat;

/// The reason why a link cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// A link parameter is invalid.
    #[error(transparent)]
    Url(#[from] UrlError),
    /// A setting of the virtual device is invalid.
    #[error(transparent)]
    Sim(#[from] ConfigError),
    /// The connection failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The trace file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not a valid trace.
    #[error("{path}: {cause}")]
    Recording {
        /// Path of the file.
        path: String,
        /// Cause of the error.
        cause: TraceFileError,
    },
    /// The user's table of encoder types is invalid.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Returns the time by which a connection may delay replies beyond the worst case of the protocol. USB adapters deliver
/// data in packets, device servers reply over a network, and a thread needs time to wake up.
pub(crate) const fn reply_margin(scheme: LinkScheme) -> Duration {
    match scheme {
        LinkScheme::Serial => Duration::from_millis(50),
        LinkScheme::Tcp | LinkScheme::Bridge | LinkScheme::Modbus | LinkScheme::Enip => Duration::from_millis(100),
        LinkScheme::Sim | LinkScheme::Replay => Duration::from_millis(20),
    }
}

/// Opens a byte stream. `simulated` creates the virtual device.
///
/// # Errors
/// Returns an [`OpenError`] if the stream cannot be opened. In this case, nothing has been sent.
pub fn open_byte_stream(
    url: &LinkUrl,
    format: CharacterFormat,
    clock: &Arc<dyn Clock>,
    simulated: impl FnOnce() -> Result<Box<dyn ByteLink>, OpenError>,
) -> Result<Box<dyn ByteLink>, OpenError> {
    Ok(match url.wire() {
        Wire::InProcess => simulated()?,
        Wire::Port(path) if url.scheme == LinkScheme::Bridge => {
            Box::new(SerialLink::open_adapter(path, format, clock.clone())?)
        }
        Wire::Port(path) => Box::new(SerialLink::open(path, format, clock.clone())?),
        Wire::Host(host) => Box::new(TcpLink::connect(host, clock.clone())?),
        Wire::File(path) => Box::new(ReplayLink::new(path, read_recording(path)?, clock.clone())),
    })
}

/// Connects to a virtual device in this process.
pub fn connect_simulated(device: impl ByteDevice + 'static, clock: &Arc<dyn Clock>) -> Box<dyn ByteLink> {
    Box::new(SimLink::connect(Arc::new(Mutex::new(device)), clock.clone()))
}

/// Creates the error for a link that does not lead to this kind of device. `known` lists the allowed schemes.
pub fn wrong_target_error(scheme: LinkScheme, known: &'static str) -> OpenError {
    UrlError::Device { scheme: scheme.keyword(), known }.into()
}

/// Reads a trace file for replay.
///
/// # Errors
/// Returns [`OpenError::File`] if the file cannot be read, or [`OpenError::Recording`] if it is not a valid recording.
pub(crate) fn read_recording(path: &str) -> Result<Vec<TraceEntry>, OpenError> {
    let text = read_text(Path::new(path))?;
    read_trace(&text).map_err(|cause| OpenError::Recording { path: path.to_owned(), cause })
}

/// Checks that `query` contains only the parameters listed in `known`.
///
/// # Errors
/// Returns [`UrlError::Unknown`] for any other parameter.
pub fn check_parameters(query: &UrlQuery, scheme: LinkScheme, known: &[&str]) -> Result<(), UrlError> {
    match query.pairs().iter().find(|(name, _)| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some((name, _)) => {
            Err(UrlError::Unknown { name: name.clone(), scheme: scheme.keyword(), known: known.join(", ") })
        }
    }
}

/// Returns the settings of the virtual device in a link: all parameters except those of the `line`. A link to a real
/// device has no settings.
///
/// # Errors
/// Returns [`UrlError::Unknown`] if the link refers to a real device and has a parameter that the line does not
/// support.
pub(crate) fn simulator_settings(
    url: &LinkUrl,
    line: &[&str],
    device: &[&str],
) -> Result<Vec<(String, String)>, UrlError> {
    if url.scheme != LinkScheme::Sim {
        check_parameters(&url.query, url.scheme, line)?;
        return Ok(Vec::new());
    }
    let concerns_it = |name: &str| device.contains(&name) || !line.contains(&name);
    Ok(url.query.pairs().iter().filter(|(name, _)| concerns_it(name)).cloned().collect())
}
