//! Logbook entries made by a session without writing to the device. If the logbook cannot be used, the log file reports
//! this and the job continues.

use std::collections::VecDeque;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use jiff::Timestamp;

use crate::analysis::check::Verdict;
use crate::store::{
    AssetName, DeviceHold, DeviceKey, EntryKind, Event, Logbook, LogbookError, LogbookErrorKind, Store,
};

/// Maximum time that a job waits for a logbook in use by another process. After this time, the connection is recorded
/// later.
const LOGBOOK_TIMEOUT: Duration = Duration::from_millis(50);

/// Access to the logbook for one session. Clones refer to the same session.
#[derive(Clone, Debug, Default)]
pub struct SessionLog(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    /// The device that was identified last.
    last: Option<Connection>,
    /// Claim that shows other computers that the last device is connected here.
    hold: Option<DeviceHold>,
    /// Connections still to be recorded because the logbook was in use, oldest first.
    pending: VecDeque<Connection>,
}

/// A device that was identified.
#[derive(Clone, Debug)]
struct Connection {
    store: Store,
    at: Timestamp,
    device: DeviceKey,
}

impl SessionLog {
    /// Assigns the last identified device to an asset, starting when it was identified: what was recorded since belongs
    /// to the asset. Returns whether the device is assigned.
    pub fn assign(&self, asset: &AssetName) -> bool {
        let last = self.state().last.clone();
        // Devices without a serial number cannot be distinguished.
        last.filter(|last| !last.device.serial_number.is_empty()).is_some_and(|Connection { store, at, device }| {
            write(&store, |logbook| logbook.assign(at, &device, asset)).is_some()
        })
    }

    /// Returns the device that was identified last in this session.
    pub fn device(&self) -> Option<DeviceKey> {
        self.state().last.as_ref().map(|last| last.device.clone())
    }

    /// Releases the device, so that the next transfer reports it as no longer connected.
    pub fn release_device(&self) {
        self.state().hold = None;
    }

    /// Records the pending connections. Waits for the logbook for as long as a write does.
    pub fn complete(&self) {
        self.state().record_pending(Logbook::open);
    }

    /// Records the pending connections, unless the logbook is still in use.
    pub(super) fn try_to_complete(&self) {
        self.state().record_pending(|path| Logbook::open_with_timeout(path, Duration::ZERO));
    }

    /// Records that a device was identified. Repeated calls have no effect until another device is identified. If the
    /// logbook is in use, the connection is recorded later, because the first reading must not wait.
    pub fn record_identity(&self, store: &Store, device: &DeviceKey) {
        let mut state = self.state();
        if state.last.as_ref().is_some_and(|last| last.device == *device) {
            return;
        }
        state.hold = store.logbook_server().hold(device);
        let connection = Connection { store: store.clone(), at: Timestamp::now(), device: device.clone() };
        state.last = Some(connection.clone());
        state.pending.push_back(connection);
        state.record_pending(|path| Logbook::open_with_timeout(path, LOGBOOK_TIMEOUT));
    }

    /// Records an event of the last identified device. Does nothing if there is none.
    pub fn record(&self, store: &Store, event: &Event) {
        self.complete();
        if let Some(device) = self.device() {
            record_event(store, &device, event);
        }
    }

    /// Records the verdicts of a device check.
    pub fn record_check(&self, store: &Store, verdicts: impl IntoIterator<Item = Verdict>) {
        let verdicts: Vec<Verdict> = verdicts.into_iter().collect();
        let count = |wanted: Verdict, word: &str| {
            let count = verdicts.iter().filter(|verdict| **verdict == wanted).count();
            (count > 0).then(|| format!("{count} {word}"))
        };
        let counts = [
            count(Verdict::Bad, "bad"),
            count(Verdict::Attention, "warning"),
            count(Verdict::Good, "good"),
            count(Verdict::Skipped, "skipped"),
        ];
        let counts: Vec<String> = counts.into_iter().flatten().collect();
        self.record(store, &Event::new(EntryKind::Check, counts.join(", ")));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn record_pending(&mut self, open: impl Fn(&Path) -> Result<Logbook, LogbookError>) {
        while let Some(connection) = self.pending.front() {
            let path = connection.store.logbook_path();
            match open(&path).and_then(|mut logbook| connection.record(&mut logbook)) {
                Err(LogbookError { problem: LogbookErrorKind::Locked, .. }) => return,
                Err(error) => tracing::warn!("{error}"),
                Ok(()) => {}
            }
            self.pending.pop_front();
        }
    }
}

impl Drop for State {
    fn drop(&mut self) {
        self.record_pending(|path| Logbook::open_with_timeout(path, LOGBOOK_TIMEOUT));
        for Connection { device, .. } in &self.pending {
            let DeviceKey { kind, device_type, serial_number, .. } = device;
            tracing::warn!(
                "the connection of {kind} {device_type} {serial_number} was not recorded, because the logbook is in use"
            );
        }
    }
}

impl Connection {
    fn record(&self, logbook: &mut Logbook) -> Result<(), LogbookError> {
        logbook.record(self.at, &self.device, &Event::new(EntryKind::Connected, "identified")).map(drop)
    }
}

/// Records an event of a device.
pub fn record_event(store: &Store, device: &DeviceKey, event: &Event) {
    write(store, |logbook| logbook.record(Timestamp::now(), device, event).map(drop));
}

fn write<T>(store: &Store, record: impl FnOnce(&mut Logbook) -> Result<T, LogbookError>) -> Option<T> {
    let written = Logbook::open(&store.logbook_path()).and_then(|mut logbook| record(&mut logbook));
    written.inspect_err(|error| tracing::warn!("{error}")).ok()
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;
    use crate::store::EntryFilter;

    #[test]
    fn records_connection_after_logbook_is_free() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at_root(root.path());
        let path = store.logbook_path();
        let kinds = || {
            let entries = Logbook::open(&path).unwrap().entries(&EntryFilter::default(), 10).unwrap();
            entries.into_iter().map(|entry| entry.kind).collect::<Vec<_>>()
        };
        assert_eq!(kinds(), []);
        let other = rusqlite::Connection::open(&path).unwrap();
        other.execute_batch("BEGIN IMMEDIATE").unwrap();
        let log = SessionLog::default();
        let began = Instant::now();
        log.record_identity(&store, &DeviceKey::new("hiperface", "37h", "1", false));
        assert!(began.elapsed() < Duration::from_secs(1), "{:?}", began.elapsed());
        log.try_to_complete();
        assert_eq!(kinds(), []);
        other.execute_batch("ROLLBACK").unwrap();
        log.try_to_complete();
        log.complete();
        assert_eq!(kinds(), [EntryKind::Connected]);
        assert!(log.assign(&"motor 17".parse().unwrap()));
        assert_eq!(kinds(), [EntryKind::Assigned, EntryKind::Connected]);
    }
}
