//! Connections, clocks, and the execution context of procedures.
//!
//! Most devices require a byte stream ([`ByteLink`]); some also exchange cyclic data as datagrams
//! ([`DatagramChannel`]). Protocols with registers, process data or explicit messages share the same [`Ctx`].

#![warn(missing_docs)]

mod clock;
mod datagram;
mod error;
pub(crate) mod line;
mod realtime_priority;
mod replay;
mod replies;
mod serial;
mod sim;
mod tcp;
mod trace;
mod udp;
mod url;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

pub use clock::{Clock, RealClock, VirtualClock};
pub use datagram::{BroadcastChannel, DatagramChannel, DatagramPort};
pub use error::{LinkError, LinkErrorKind};
pub use line::{Echo, LineQuality, LineState};
pub use realtime_priority::wake_before_others;
pub use replay::ReplayLink;
pub use replies::ReplyTimes;
pub use serial::{PortInfo, SerialLink, ports};
pub use sim::{SimLink, SimPort};
pub use tcp::TcpLink;
pub use trace::{
    Direction, HEADER as TRACE_HEADER, Trace, TraceEntry, TraceFileError, entry_line, read_trace, write_entry,
    write_header,
};
pub use udp::{UdpBroadcast, UdpPort};
pub use url::{LinkScheme, LinkUrl, UrlError, UrlQuery, Wire};

use crate::units::{CharacterFormat, Moment};

/// A connection that transports bytes in both directions.
pub trait ByteLink: Send {
    /// Writes bytes in a single call, so that there is no gap within a frame. May return before the last bit has been
    /// sent.
    ///
    /// # Errors
    /// The line was lost.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits until `until` for bytes and appends them to `into`. Appends nothing on time-out.
    ///
    /// # Errors
    /// The line was lost.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError>;

    /// Sets baud rate and parity.
    ///
    /// # Errors
    /// The line was lost, or the format cannot be set.
    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError>;

    /// Returns whether [`set_format`](Self::set_format) has an effect. A device server has its own settings, which are
    /// not visible here, so a reply through it proves nothing about baud rate and parity.
    fn can_set_format(&self) -> bool {
        true
    }

    /// Checks that the line still exists, without sending or receiving.
    ///
    /// # Errors
    /// The line was lost.
    fn check(&mut self) -> Result<(), LinkError>;
}

/// A cancellation flag shared by its clones.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<CancelState>);

#[derive(Debug)]
struct CancelState {
    requested: AtomicBool,
    /// Number of transactions left before cancellation is requested automatically.
    fuse: AtomicU64,
}

impl Default for CancelState {
    fn default() -> Self {
        CancelState { requested: AtomicBool::new(false), fuse: AtomicU64::new(u64::MAX) }
    }
}

impl CancelToken {
    /// Creates a flag that requests cancellation after the given number of transactions.
    pub fn after(transactions: u64) -> Self {
        let cancel = CancelToken::default();
        cancel.0.fuse.store(transactions, Ordering::SeqCst);
        cancel
    }

    /// Requests cancellation at the next possible point.
    pub fn request(&self) {
        self.0.requested.store(true, Ordering::SeqCst);
    }

    /// Clears the request before the next job.
    pub fn reset(&self) {
        self.0.requested.store(false, Ordering::SeqCst);
    }

    /// Returns whether cancellation has been requested.
    pub fn is_requested(&self) -> bool {
        self.0.requested.load(Ordering::SeqCst)
    }

    /// Returns whether the next transaction must not begin. Must be called before each transaction.
    pub fn stops_transaction(&self) -> bool {
        let left = self.0.fuse.load(Ordering::SeqCst);
        if left == 0 {
            self.request();
        } else if left != u64::MAX {
            self.0.fuse.store(left - 1, Ordering::SeqCst);
        }
        self.is_requested()
    }
}

/// Execution context of a procedure, with connection, clock, cancellation and trace.
pub struct Ctx<'a, W: ?Sized = dyn ByteLink> {
    /// Connection to the device.
    pub wire: &'a mut W,
    /// Source of time.
    pub clock: &'a dyn Clock,
    /// Cancellation flag.
    pub cancel: &'a CancelToken,
    /// Trace of the line.
    pub trace: &'a mut Trace,
}
