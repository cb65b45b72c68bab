//! Shutdown by a signal or by loss of the display. Drives are stopped and released first, on whichever thread can do
//! so.

use std::cell::OnceCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::app::{Action, ActionMailbox, DriveStopHandles, Studio};

const REPLY_TIMEOUT: Duration = Duration::from_secs(2);
/// Exit status after a termination signal: 128 plus 15, which is the number of SIGTERM.
const TERMINATED_STATUS: i32 = 143;

/// A guard that releases the drives when its thread ends or exits the program.
struct ReleaseOnDrop(DriveStopHandles);

impl Drop for ReleaseOnDrop {
    fn drop(&mut self) {
        self.0.begin_stop();
        self.0.wait_for_disconnect(DriveStopHandles::SHUTDOWN_TIMEOUT);
    }
}

thread_local! {
    /// A guard on the window's thread that releases the drives when the display is lost. The display library then exits
    /// the program, but thread-local values are still dropped.
    static RELEASE_GUARD: OnceCell<ReleaseOnDrop> = const { OnceCell::new() };
}

/// Installs a signal handler and a guard for the end of the window's thread.
pub(super) fn install_handlers(studio: &Studio) {
    let (brakes, mailbox) = (studio.drive_stop_handles(), studio.mailbox());
    RELEASE_GUARD.with(|last| last.set(ReleaseOnDrop(brakes.clone())).unwrap_or_default());
    let again = AtomicBool::new(false);
    let heard = ctrlc::set_handler(move || {
        if !stop_and_close(&brakes, &mailbox) || again.swap(true, Ordering::SeqCst) {
            std::process::exit(TERMINATED_STATUS);
        }
    });
    if let Err(why) = heard {
        // Without this handler, a signal ends the program immediately.
        tracing::warn!("{why}");
    }
}

/// Stops and releases the drives, then closes the window without any confirmation. Returns whether the window closes.
fn stop_and_close(brakes: &DriveStopHandles, mailbox: &ActionMailbox) -> bool {
    brakes.begin_stop();
    mailbox.send(Action::Quit);
    brakes.wait_for_disconnect(DriveStopHandles::SHUTDOWN_TIMEOUT);
    brakes.wait_for_window(REPLY_TIMEOUT)
}
