//! Connections, clocks, and the context in which a procedure runs.
//!
//! Most devices need one kind of connection, a stream of bytes ([`ByteLink`]); some also exchange cyclic data as packets
//! ([`Datagrams`]). Protocols with registers, process data or explicit messages use the same [`Ctx`].

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
pub use datagram::{Broadcast, DatagramPort, Datagrams};
pub use error::{LinkError, LinkErrorKind};
pub use line::{Echo, LineQuality, LineState};
pub use realtime_priority::wake_before_others;
pub use replay::ReplayLink;
pub use replies::Replies;
pub use serial::{PortInfo, SerialLink, ports};
pub use sim::{SimLink, SimPort};
pub use tcp::TcpLink;
pub use trace::{
    Direction, HEADER as TRACE_HEADER, Trace, TraceEntry, TraceFileError, read_trace, write_entry, write_header,
};
pub use udp::{UdpBroadcast, UdpPort};
pub use url::{LinkUrl, Query, Scheme, UrlError, Wire};

use crate::units::{CharacterFormat, Moment};

/// A wire on which bytes come and go.
pub trait ByteLink: Send {
    /// Writes bytes to the line in one call, so that no gap arises inside a frame. It may return before the last bit is
    /// sent.
    ///
    /// # Errors
    /// Returns an error if the line is lost.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits for bytes until `until` and appends them to `into`. Appends nothing when the time is up.
    ///
    /// # Errors
    /// Returns an error if the line is lost.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError>;

    /// Sets baud rate and parity from now on.
    ///
    /// # Errors
    /// Returns an error if the line is lost or the format cannot be set.
    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError>;

    /// Returns whether [`set_format`](Self::set_format) has an effect. A device server has its own settings, which are
    /// not visible here: a reply through it proves nothing about baud rate and parity.
    fn sets_format(&self) -> bool {
        true
    }

    /// Checks that the line still exists, without sending or receiving.
    ///
    /// # Errors
    /// Returns an error if the line is lost.
    fn check(&mut self) -> Result<(), LinkError>;
}

/// A request to cancel the running work. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<CancelState>);

#[derive(Debug)]
struct CancelState {
    requested: AtomicBool,
    /// Number of transactions left until the automatic cancellation.
    fuse: AtomicU64,
}

impl Default for CancelState {
    fn default() -> Self {
        CancelState { requested: AtomicBool::new(false), fuse: AtomicU64::new(u64::MAX) }
    }
}

impl Cancel {
    /// Creates a cancellation that takes effect by itself after `transactions` transactions.
    pub fn after(transactions: u64) -> Self {
        let cancel = Cancel::default();
        cancel.0.fuse.store(transactions, Ordering::SeqCst);
        cancel
    }

    /// Requests cancellation at the next possible point.
    pub fn request(&self) {
        self.0.requested.store(true, Ordering::SeqCst);
    }

    /// Withdraws the request, for the next job.
    pub fn reset(&self) {
        self.0.requested.store(false, Ordering::SeqCst);
    }

    /// Returns whether cancellation is requested.
    pub fn is_requested(&self) -> bool {
        self.0.requested.load(Ordering::SeqCst)
    }

    /// Returns whether the next transaction must not begin; called before each.
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

/// The context of a procedure: connection, clock, cancellation and trace.
pub struct Ctx<'a, W: ?Sized = dyn ByteLink> {
    /// The wire.
    pub wire: &'a mut W,
    /// The time.
    pub clock: &'a dyn Clock,
    /// The cancellation.
    pub cancel: &'a Cancel,
    /// The trace of the line.
    pub trace: &'a mut Trace,
}
