//! Restarting an encoder (53h) and changing the interface for now (67h), with the waits of the manual's figure 38.

use std::time::Duration;

use super::identify::read_type_label;
use super::{Error, Master};
use crate::devices::hiperface::protocol::{LineSettings, Request, StatusCode, Timing};
use crate::units::CharacterFormat;

/// Within 100…900 ms after the restart the encoder listens with factory settings; in its middle, early.
const INTO_DEFAULT_WINDOW: Duration = Duration::from_millis(200);
/// Reserve over the figure's times for the stored settings, as clocks differ.
const RESERVE: Duration = Duration::from_millis(100);

/// Restarts the encoder, waits until it listens with its stored settings, and reads its whole status queue: up to four
/// codes may wait from the initialisation.
///
/// With factory settings stored, the encoder is asked within the default window; with others, it is left alone until it
/// has taken them up, because a request within the window would keep it at factory settings.
///
/// # Errors
/// The line; or no reply at the stored settings.
pub fn reset(master: &mut Master<'_>) -> Result<Vec<StatusCode>, Error> {
    let stored = read_type_label(master)?.settings;
    let format = stored.format().ok_or(Error::ReservedFormat { settings: stored })?;
    master.tell_all(&Request::Reset)?;
    let factory = format == CharacterFormat::FACTORY && stored.long_timeout();
    let wait = if factory { INTO_DEFAULT_WINDOW } else { Timing::DEFAULT_WINDOW_END + Timing::SWITCH + RESERVE };
    // The encoder restarts whatever the user wishes now; afterwards the session has to know how to talk to it.
    master.shielded(|master| {
        master.wait(wait)?;
        master.set_format(format)?;
        master.station().long_timeout = stored.long_timeout();
        super::read_status(master)
    })
}

/// Changes the encoder's interface and ours until the next restart. The reply still comes at the old settings.
///
/// # Errors
/// A refusal, or no reply at the new settings; then both sides are at the old ones, as far as the encoder can be asked.
pub fn change_line_for_now(master: &mut Master<'_>, settings: LineSettings) -> Result<(), Error> {
    let format = settings.format().ok_or(Error::ReservedFormat { settings })?;
    let (old_format, old_timeout) = (master.station().format, master.station().long_timeout);
    let request = Request::ConfigureLineTemporarily { settings };
    let outcome = match master.attempt(&request)? {
        Ok(answered) => master.acknowledge(&request, answered),
        // The reply was lost: whether the encoder changed is found out by talking to it.
        Err(_) => Ok(()),
    };
    outcome?;
    master.shielded(|master| {
        master.set_format(format)?;
        master.station().long_timeout = settings.long_timeout();
        let Err(error) = read_type_label(master) else { return Ok(()) };
        master.set_format(old_format)?;
        master.station().long_timeout = old_timeout;
        Err(error)
    })
}
