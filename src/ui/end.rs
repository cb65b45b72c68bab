//! The end of the program, where it does not come from the window: a signal, or a display that is gone. Drives are stopped
//! and let go before, from whichever thread that can be done.

use std::cell::OnceCell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::app::{Action, Brakes, Mailbox, Studio};

/// A window that is drawn answers in this time.
const ANSWERS: Duration = Duration::from_secs(2);
/// Exit status of a program ended by a signal: 128 plus the number of SIGTERM.
const ENDED: i32 = 143;

/// Lets go of the drives when its thread ends, or when that thread ends the program.
struct ReleaseOnDrop(Brakes);

impl Drop for ReleaseOnDrop {
    fn drop(&mut self) {
        self.0.begin();
        self.0.wait(Brakes::PATIENCE);
    }
}

thread_local! {
    /// The library of the display ends the program itself when the display is gone: what a thread owns goes even then.
    static LAST: OnceCell<ReleaseOnDrop> = const { OnceCell::new() };
}

/// Hears signals from now on, and that the thread of the window ends.
pub(super) fn prepare(studio: &Studio) {
    let (brakes, mailbox) = (studio.brakes(), studio.mailbox());
    LAST.with(|last| last.set(ReleaseOnDrop(brakes.clone())).unwrap_or_default());
    let again = AtomicBool::new(false);
    let heard = ctrlc::set_handler(move || {
        if !end(&brakes, &mailbox) || again.swap(true, Ordering::SeqCst) {
            std::process::exit(ENDED);
        }
    });
    if let Err(why) = heard {
        // Signals end it at once then.
        tracing::warn!("{why}");
    }
}

/// Drives first, then the window as if it were closed, but nothing is asked. Whether the window closes.
fn end(brakes: &Brakes, mailbox: &Mailbox) -> bool {
    brakes.begin();
    mailbox.send(Action::Quit);
    brakes.wait(Brakes::PATIENCE);
    brakes.wait_for_window(ANSWERS)
}
