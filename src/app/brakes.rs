//! The drives of all sessions, for what ends the program: the window that closes, a signal, a display that is gone. They
//! stop, are switched off and their connections are closed, whether the window still draws or not.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::devices::hiperdrive::jobs::Motion;
use crate::worker::Stopper;

/// All drives that can be moved from here. Clones share them.
#[derive(Clone, Default)]
pub struct Brakes(Arc<Shared>);

#[derive(Default)]
struct Shared {
    sessions: Mutex<Vec<(Motion, Stopper)>>,
    /// Nothing moves any more.
    released: AtomicBool,
    /// The window closes.
    closing: AtomicBool,
}

/// How often it is looked whether connections are closed.
const LOOKS: Duration = Duration::from_millis(5);

impl Brakes {
    /// How long drives get to stop and connections to close, before the program ends all the same.
    pub const PATIENCE: Duration = Duration::from_secs(1);

    /// Drives of a session that begins.
    pub(crate) fn add(&self, motion: Motion, stopper: Stopper) {
        let mut sessions = self.sessions();
        sessions.retain(|(own, _)| !own.is_left_over());
        // Under the lock that `begin` takes as well: a session is left by the one or by the other.
        if self.has_begun() {
            motion.leave();
            stopper.stop();
        }
        sessions.push((motion, stopper));
    }

    /// Stops all drives, switches them off and closes their connections. Nothing moves any more. Does not wait.
    pub fn begin(&self) {
        self.0.released.store(true, Ordering::SeqCst);
        let sessions = self.sessions();
        sessions.iter().for_each(|(motion, _)| motion.leave());
        // Jobs end, and what waits wakes up.
        sessions.iter().for_each(|(_, stopper)| stopper.stop());
    }

    /// [`begin`](Self::begin) was called.
    pub fn has_begun(&self) -> bool {
        self.0.released.load(Ordering::SeqCst)
    }

    /// No drive is connected.
    pub fn is_done(&self) -> bool {
        !self.sessions().iter().any(|(motion, _)| motion.is_connected())
    }

    /// Waits until no drive is connected, for at most so long. Whether that is so.
    pub fn wait(&self, patience: Duration) -> bool {
        wait_for(patience, || self.is_done())
    }

    /// The window has begun to close.
    pub(super) fn note_closing(&self) {
        self.0.closing.store(true, Ordering::SeqCst);
    }

    /// Waits until the window has begun to close, for at most so long. Whether it has.
    pub fn wait_for_window(&self, patience: Duration) -> bool {
        wait_for(patience, || self.0.closing.load(Ordering::SeqCst))
    }

    fn sessions(&self) -> MutexGuard<'_, Vec<(Motion, Stopper)>> {
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
