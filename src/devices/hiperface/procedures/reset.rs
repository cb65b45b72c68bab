//! Restarts an encoder (53h) and changes its interface temporarily (67h). The waiting times are from figure 38 of the
//! manual.

use std::time::Duration;

use super::identify::read_type_label;
use super::{Error, Master};
use crate::devices::hiperface::protocol::{LineSettings, Request, StatusCode, Timing};
use crate::units::CharacterFormat;

/// Time from the restart to the first request. Between 100 and 900 ms after the restart, the encoder uses its factory
/// settings.
const DEFAULT_WINDOW_DELAY: Duration = Duration::from_millis(200);
/// Margin added to the manual's time for applying the stored settings, because clocks differ.
const CLOCK_MARGIN: Duration = Duration::from_millis(100);

/// Restarts the encoder, waits until it listens with its stored settings, and reads its complete status queue.
/// Initialisation may have added up to four codes to the queue.
///
/// If the stored settings are the factory settings, requests are sent within the default window. Otherwise, nothing is
/// sent until the encoder has applied the stored settings, because a request within the window would keep the encoder
/// at factory settings.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder does not reply with the stored settings.
pub fn reset(master: &mut Master<'_>) -> Result<Vec<StatusCode>, Error> {
    let stored = read_type_label(master)?.settings;
    let format = stored.character_format().ok_or(Error::ReservedFormat { settings: stored })?;
    master.send_broadcast(&Request::Reset)?;
    let factory = format == CharacterFormat::FACTORY && stored.has_long_timeout();
    let wait = if factory { DEFAULT_WINDOW_DELAY } else { Timing::DEFAULT_WINDOW_END + Timing::SWITCH + CLOCK_MARGIN };
    // The encoder restarts even if the user cancels now, so the session must know its settings.
    master.run_uncancellable(|master| {
        master.wait(wait)?;
        master.set_format(format)?;
        master.station().long_timeout = stored.has_long_timeout();
        super::read_status(master)
    })
}

/// Changes the interface settings of the encoder and the port until the next restart. The reply still uses the old
/// settings.
///
/// # Errors
/// Returns an error if the encoder rejects the settings or does not reply with the new settings. Both sides then have
/// the old settings, provided that the encoder still replies.
pub fn set_temporary_line_settings(master: &mut Master<'_>, settings: LineSettings) -> Result<(), Error> {
    let format = settings.character_format().ok_or(Error::ReservedFormat { settings })?;
    let (old_format, old_timeout) = (master.station().format, master.station().long_timeout);
    let request = Request::ConfigureLineTemporarily { settings };
    let outcome = match master.exchange_once(&request)? {
        Ok(answered) => master.acknowledge(&request, answered),
        // The reply was lost. The next request shows whether the encoder has the new settings.
        Err(_) => Ok(()),
    };
    outcome?;
    master.run_uncancellable(|master| {
        master.set_format(format)?;
        master.station().long_timeout = settings.has_long_timeout();
        let Err(error) = read_type_label(master) else { return Ok(()) };
        master.set_format(old_format)?;
        master.station().long_timeout = old_timeout;
        Err(error)
    })
}
