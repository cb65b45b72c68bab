//! Stores status codes before they are displayed. Command 50h removes a code from the encoder, so a code that is read
//! but not stored would be lost.

use std::time::Duration;

use jiff::Timestamp;

use crate::devices::hiperface::protocol::{KIND, StatusCode};
use crate::store::{DeviceKey, EntryKind, Event, Logbook, Store};
use crate::units::Moment;

/// Minimum time before a status code that repeats during polling is stored again.
const REPEAT_INTERVAL: Duration = Duration::from_secs(60);

/// Status codes recorded recently while polling the position.
#[derive(Debug, Default)]
pub(super) struct RecentStatusCodes(Vec<(StatusCode, Moment)>);

impl RecentStatusCodes {
    /// Returns whether any of these codes is new, that is, not recorded within the last minute. Marks all of them as
    /// recorded.
    pub(super) fn insert_codes(&mut self, codes: &[StatusCode], now: Moment) -> bool {
        self.0.retain(|(_, kept)| now.duration_since(*kept) < REPEAT_INTERVAL);
        let mut is_new = false;
        for code in codes {
            if !self.0.iter().any(|(own, _)| own == code) {
                self.0.push((*code, now));
                is_new = true;
            }
        }
        is_new
    }
}

/// Records status codes in the log and in the logbook. They are written to the log even if the logbook cannot be used.
pub(super) fn record_codes(store: &Store, device: &DeviceKey, codes: &[StatusCode]) {
    let words = codes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    tracing::info!("{} {}: status codes read: {words}", device.kind, device.serial_number);
    let event = Event::new(EntryKind::Status, words);
    let noted =
        Logbook::open(&store.logbook_path()).and_then(|mut logbook| logbook.record(Timestamp::now(), device, &event));
    if let Err(error) = noted {
        tracing::warn!("{error}");
    }
}

/// Returns the key for an encoder that has not been identified.
pub(super) fn unknown_device(is_virtual: bool) -> DeviceKey {
    DeviceKey::new(KIND, "", "", is_virtual)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_repeated_status_once_per_minute() {
        let mut keeper = RecentStatusCodes::default();
        let at = |seconds| Moment::default() + Duration::from_secs(seconds);
        let (hot, fast) = (StatusCode::TEMPERATURE, StatusCode::TOO_FAST);
        assert!(keeper.insert_codes(&[hot], at(0)));
        assert!(!keeper.insert_codes(&[hot], at(59)));
        assert!(keeper.insert_codes(&[hot, fast], at(59)), "another one came");
        assert!(keeper.insert_codes(&[hot], at(60)));
        assert!(!keeper.insert_codes(&[fast, hot], at(100)));
    }
}
