//! Stops the drives of all sessions when the program ends: when the window is closed, on a signal, or when the display
//! is lost. The drives are stopped and switched off, and their connections are closed. This works even if the window is
//! no longer drawn.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::worker::WorkerStopHandle;

/// A handle that stops the drives of a session when the program ends. It works from any thread and in any state of the
/// session, even if the window is no longer drawn.
pub trait DriveStopHandle: Send {
    /// Stops and switches off all drives, and closes their connection. Later requests cannot start a motion. This
    /// function does not block, and it may be called repeatedly.
    fn release_drives(&self);

    /// Returns whether the device has a connection over which drives can move. After
    /// [`release_drives`](Self::release_drives), this becomes `false` once the drives have stopped and the connection
    /// is closed.
    fn is_connected(&self) -> bool;

    /// Returns whether the session has ended. After that, this program can no longer move its drives.
    fn is_orphaned(&self) -> bool;
}

/// The stop handles of all sessions. Clones share the same state.
#[derive(Clone, Default)]
pub struct DriveStopHandles(Arc<Shared>);

/// The stop handles of one session: one for its drives and one for its jobs.
type SessionStopHandles = (Box<dyn DriveStopHandle>, WorkerStopHandle);

#[derive(Default)]
struct Shared {
    sessions: Mutex<Vec<SessionStopHandles>>,
    /// Whether the drives have been released. Afterwards, no motion can be started.
    released: AtomicBool,
    closing: AtomicBool,
}

/// Interval between checks for closed connections.
const CHECK_INTERVAL: Duration = Duration::from_millis(5);

impl DriveStopHandles {
    /// Maximum time for stopping the drives and closing the connections. The program ends no later than this.
    pub const SHUTDOWN_TIMEOUT: Duration = Duration::from_secs(1);

    pub(crate) fn add(&self, brake: Box<dyn DriveStopHandle>, stop_handle: WorkerStopHandle) {
        let mut sessions = self.lock_sessions();
        sessions.retain(|(own, _)| !own.is_orphaned());
        // `begin` takes the same lock, so one of the two functions always releases the session.
        if self.has_begun() {
            brake.release_drives();
            stop_handle.stop();
        }
        sessions.push((brake, stop_handle));
    }

    pub fn begin_stop(&self) {
        self.0.released.store(true, Ordering::SeqCst);
        let sessions = self.lock_sessions();
        sessions.iter().for_each(|(brake, _)| brake.release_drives());
        // This ends the jobs and wakes waiting threads.
        sessions.iter().for_each(|(_, stop_handle)| stop_handle.stop());
    }

    pub fn has_begun(&self) -> bool {
        self.0.released.load(Ordering::SeqCst)
    }

    /// Returns whether all drives are disconnected.
    pub fn is_done(&self) -> bool {
        !self.lock_sessions().iter().any(|(brake, _)| brake.is_connected())
    }

    /// Waits for at most `patience` until all drives are disconnected, and returns whether they are.
    pub fn wait_for_disconnect(&self, patience: Duration) -> bool {
        wait_for(patience, || self.is_done())
    }

    pub(super) fn set_closing(&self) {
        self.0.closing.store(true, Ordering::SeqCst);
    }

    /// Waits for at most `patience` until the window begins to close, and returns whether it has.
    pub fn wait_for_window(&self, patience: Duration) -> bool {
        wait_for(patience, || self.0.closing.load(Ordering::SeqCst))
    }

    fn lock_sessions(&self) -> MutexGuard<'_, Vec<SessionStopHandles>> {
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
        sleep(CHECK_INTERVAL);
    }
}
