//! The world at the other end of a cable: wires, clocks and the context in which a procedure runs.
//!
//! Most devices need one kind of wire, a stream of bytes ([`ByteLink`]); cyclic data are packets beside it ([`Datagrams`]).
//! What else a protocol makes of them (registers, process data, explicit messages) takes the same [`Ctx`].

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
    /// Hands bytes to the line, all in one call, so that no gap arises inside a frame. It may return before the last
    /// bit has left.
    ///
    /// # Errors
    /// When the line is gone.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits until something arrives, at most until `until`, and appends it to `into`. Nothing appended: the time is up.
    ///
    /// # Errors
    /// When the line is gone.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError>;

    /// Sets baud rate and parity from now on.
    ///
    /// # Errors
    /// When the line is gone or cannot be set so.
    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError>;

    /// Returns whether [`set_format`](Self::set_format) has an effect. A device server has its own settings, which are
    /// not visible here: a reply through it proves nothing about baud rate and parity.
    fn sets_format(&self) -> bool {
        true
    }

    /// Looks whether the line is still there, without sending or taking anything.
    ///
    /// # Errors
    /// When the line is gone.
    fn check(&mut self) -> Result<(), LinkError>;
}

/// The wish to end what is going on. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<CancelState>);

#[derive(Debug)]
struct CancelState {
    requested: AtomicBool,
    /// Transactions left until the wish comes by itself.
    fuse: AtomicU64,
}

impl Default for CancelState {
    fn default() -> Self {
        CancelState { requested: AtomicBool::new(false), fuse: AtomicU64::new(u64::MAX) }
    }
}

impl Cancel {
    /// A wish that comes by itself when `transactions` transactions have been carried out.
    pub fn after(transactions: u64) -> Self {
        let cancel = Cancel::default();
        cancel.0.fuse.store(transactions, Ordering::SeqCst);
        cancel
    }

    /// Wishes an end at the next possible point.
    pub fn request(&self) {
        self.0.requested.store(true, Ordering::SeqCst);
    }

    /// Withdraws the request, for the next job.
    pub fn reset(&self) {
        self.0.requested.store(false, Ordering::SeqCst);
    }

    /// The end is wished.
    pub fn is_requested(&self) -> bool {
        self.0.requested.load(Ordering::SeqCst)
    }

    /// Called before each transaction: whether it may not begin any more.
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

/// All that a procedure gets: a wire, a clock, the wish to end and the trace.
pub struct Ctx<'a, W: ?Sized = dyn ByteLink> {
    /// The wire.
    pub wire: &'a mut W,
    /// The time.
    pub clock: &'a dyn Clock,
    /// The wish to end.
    pub cancel: &'a Cancel,
    /// The trace of the line.
    pub trace: &'a mut Trace,
}
