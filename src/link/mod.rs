//! Connections, clocks, and the context in which procedures run.
//!
//! Most devices need a byte stream ([`ByteLink`]). Some also exchange cyclic data as datagrams ([`DatagramChannel`]).
//! The procedures of all protocols use the same [`Ctx`].

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

pub use clock::{Clock, RealClock, VirtualClock, measure_timer_step};
pub use datagram::{BroadcastChannel, DatagramChannel, DatagramPort};
pub use error::{LinkError, LinkErrorKind};
pub use line::{Echo, LineQuality, LineState};
pub use realtime_priority::request_realtime_priority;
pub use replay::ReplayLink;
pub use replies::ReplyTimes;
pub use serial::{PORT_EXAMPLE, PortInfo, SerialLink, ports};
pub use sim::{SimLink, SimPort};
pub use tcp::TcpLink;
pub use trace::{
    Direction, HEADER as TRACE_HEADER, Trace, TraceEntry, TraceFileError, entry_line, read_trace, write_entry,
    write_header,
};
pub use udp::{UdpBroadcast, UdpPort};
pub use url::{LinkScheme, LinkUrl, UrlError, UrlQuery, Wire};

use crate::units::{CharacterFormat, Moment};

/// A connection that transfers bytes in both directions.
pub trait ByteLink: Send {
    /// Sends all bytes of a frame in one call, so that there is no gap within the frame. This function may return
    /// before the last bit has been sent.
    ///
    /// # Errors
    /// Returns an error if the connection was lost.
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError>;

    /// Waits for bytes and appends them to `into`. Appends nothing if no bytes arrive before `until`.
    ///
    /// # Errors
    /// Returns an error if the connection was lost.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError>;

    /// Sets baud rate and parity.
    ///
    /// # Errors
    /// Returns an error if the connection was lost or the format cannot be set.
    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError>;

    /// Returns whether [`set_format`](Self::set_format) has an effect. It has none on a device server, which uses its
    /// configured format. A reply through such a server does not confirm the baud rate and parity.
    fn can_set_format(&self) -> bool {
        true
    }

    /// Checks that the connection still exists, without sending or receiving.
    ///
    /// # Errors
    /// Returns an error if the connection was lost.
    fn check_connection(&mut self) -> Result<(), LinkError>;

    /// Returns the time of the first start bit of the last reply, or `None` if the connection does not measure this
    /// time.
    fn reply_start(&self) -> Option<Moment> {
        None
    }

    /// Restores any state at the remote end that must not outlive the session, such as the supply of the device.
    ///
    /// # Errors
    /// Returns an error if the connection was lost or the remote end rejects the request.
    fn restore_state(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

/// A cancellation flag. All clones share the same flag.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<CancelState>);

#[derive(Debug)]
struct CancelState {
    requested: AtomicBool,
    /// Number of transactions before automatic cancellation, or `u64::MAX` for no limit.
    fuse: AtomicU64,
}

impl Default for CancelState {
    fn default() -> Self {
        CancelState { requested: AtomicBool::new(false), fuse: AtomicU64::new(u64::MAX) }
    }
}

impl CancelToken {
    /// Creates a flag that requests cancellation after the given number of transactions.
    pub fn after_transactions(transactions: u64) -> Self {
        let cancel = CancelToken::default();
        cancel.0.fuse.store(transactions, Ordering::SeqCst);
        cancel
    }

    /// Requests cancellation at the next point where it is possible.
    pub fn request(&self) {
        self.0.requested.store(true, Ordering::SeqCst);
    }

    /// Resets the flag for the next job.
    pub fn reset(&self) {
        self.0.requested.store(false, Ordering::SeqCst);
    }

    /// Returns whether cancellation has been requested.
    pub fn is_requested(&self) -> bool {
        self.0.requested.load(Ordering::SeqCst)
    }

    /// Counts a transaction that is about to begin, and returns whether it is cancelled. This function must be called
    /// before each transaction.
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

/// The resources available to a procedure: connection, clock, cancellation flag and trace.
pub struct Ctx<'a, W: ?Sized = dyn ByteLink> {
    /// Connection over which frames are exchanged.
    pub wire: &'a mut W,
    /// Clock for waits and time stamps.
    pub clock: &'a dyn Clock,
    /// Flag that cancels the procedure.
    pub cancel: &'a CancelToken,
    /// Trace of the frames on the connection.
    pub trace: &'a mut Trace,
}
