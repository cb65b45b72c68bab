//! Stops the drives of all sessions when the program ends: when the window is closed, on a signal, or when the display
//! is lost. Drives are stopped and switched off and their connections are closed, whether or not the window still
//! draws.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::worker::WorkerStopHandle;

/// A handle that stops the drives of a session when the program ends. It works from any thread, regardless of the state
/// of the session and of whether the window still draws.
pub trait DriveStopHandle: Send {
    /// Stops and switches off all drives and closes their connection because the program is ending. Later requests
    /// cannot start a motion. This does not block and may be called repeatedly.
    fn leave(&self);

    /// Returns whether the device holds a connection over which drives can move. After [`leave`](Self::leave), this
    /// becomes `false` as soon as the drives are stopped and the connection is closed.
    fn is_connected(&self) -> bool;

    /// Returns whether the session has ended. Nothing else then holds a handle to its drives, so this program can no
    /// longer move them.
    fn is_orphaned(&self) -> bool;
}

/// All drives that this program can move. Clones share the same state.
#[derive(Clone, Default)]
pub struct DriveStopHandles(Arc<Shared>);

/// The brake of a session with drives, and the stopper of its jobs.
type Session = (Box<dyn DriveStopHandle>, WorkerStopHandle);

#[derive(Default)]
struct Shared {
    sessions: Mutex<Vec<Session>>,
    /// Whether the drives have been released, after which no motion is allowed.
    released: AtomicBool,
    closing: AtomicBool,
}

/// Interval between checks for closed connections.
const LOOKS: Duration = Duration::from_millis(5);

impl DriveStopHandles {
    /// Time allowed for stopping drives and closing connections before the program ends regardless.
    pub const PATIENCE: Duration = Duration::from_secs(1);

    pub(crate) fn add(&self, brake: Box<dyn DriveStopHandle>, stopper: WorkerStopHandle) {
        let mut sessions = self.sessions();
        sessions.retain(|(own, _)| !own.is_orphaned());
        // Under the lock that `begin` takes as well: one of the two releases the session.
        if self.has_begun() {
            brake.leave();
            stopper.stop();
        }
        sessions.push((brake, stopper));
    }

    pub fn begin(&self) {
        self.0.released.store(true, Ordering::SeqCst);
        let sessions = self.sessions();
        sessions.iter().for_each(|(brake, _)| brake.leave());
        // Jobs end, and waiting threads wake up.
        sessions.iter().for_each(|(_, stopper)| stopper.stop());
    }

    pub fn has_begun(&self) -> bool {
        self.0.released.load(Ordering::SeqCst)
    }

    /// Returns whether no drive is connected.
    pub fn is_done(&self) -> bool {
        !self.sessions().iter().any(|(brake, _)| brake.is_connected())
    }

    /// Waits until no drive is connected, for at most `patience`. Returns whether all drives are disconnected.
    pub fn wait(&self, patience: Duration) -> bool {
        wait_for(patience, || self.is_done())
    }

    pub(super) fn set_closing(&self) {
        self.0.closing.store(true, Ordering::SeqCst);
    }

    /// Blocks until the window has begun to close, for at most `patience`. Returns whether it has.
    pub fn wait_for_window(&self, patience: Duration) -> bool {
        wait_for(patience, || self.0.closing.load(Ordering::SeqCst))
    }

    fn sessions(&self) -> MutexGuard<'_, Vec<Session>> {
        self.0.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn wait_for(patience: Duration, condition: impl Fn() -> bool) -> bool {
    let until = Instant::now() + patience;
    loop {
        if condition() {
            return true;
        }
        if Instant::now() >= until {
            return false;
        }
        sleep(LOOKS);
    }
}
