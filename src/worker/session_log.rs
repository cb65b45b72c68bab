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
    /// Asset to which identified devices are assigned.
    asset: Option<AssetName>,
    /// The device that was identified last.
    device: Option<DeviceKey>,
    /// Whether the last device is assigned to the asset.
    is_assigned: bool,
    /// Claim that shows other computers that the last device is connected here.
    hold: Option<DeviceHold>,
    /// Connections still to be recorded because the logbook was in use, oldest first.
    pending: VecDeque<Connection>,
}

/// A device that was identified.
#[derive(Debug)]
struct Connection {
    store: Store,
    at: Timestamp,
    device: DeviceKey,
    asset: Option<AssetName>,
}

impl SessionLog {
    /// Assigns the session's devices to an asset as soon as they are identified.
    pub fn assign(&self, asset: AssetName) {
        self.state().asset = Some(asset);
    }

    /// Returns the device that was identified last in this session.
    pub fn device(&self) -> Option<DeviceKey> {
        self.state().device.clone()
    }

    /// Releases the device, so that the next transfer reports it as no longer connected.
    pub fn release_device(&self) {
        self.state().hold = None;
    }

    /// Returns whether the last identified device is assigned to the session's asset.
    pub fn is_assigned(&self) -> bool {
        self.state().is_assigned
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
        if state.device.as_ref() == Some(device) {
            return;
        }
        state.device = Some(device.clone());
        state.hold = store.logbook_server().hold(device);
        // Devices without a serial number cannot be distinguished.
        let asset = state.asset.clone().filter(|_| !device.serial_number.is_empty());
        state.is_assigned = false;
        let connection = Connection { store: store.clone(), at: Timestamp::now(), device: device.clone(), asset };
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
                Ok(()) => {
                    let is_last = self.device.as_ref() == Some(&connection.device);
                    self.is_assigned |= is_last && connection.asset.is_some();
                }
            }
            self.pending.pop_front();
        }
    }
}

impl Drop for State {
    fn drop(&mut self) {
        self.record_pending(|path| Logbook::open_with_timeout(path, LOGBOOK_TIMEOUT));
        for Connection { device, .. } in &self.pending {
            tracing::warn!("the connection of {device:?} was not recorded, because the logbook is in use");
        }
    }
}

impl Connection {
    fn record(&self, logbook: &mut Logbook) -> Result<(), LogbookError> {
        if let Some(asset) = &self.asset {
            logbook.assign(self.at, &self.device, asset)?;
        }
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
        log.assign("motor 17".parse().unwrap());
        let began = Instant::now();
        log.record_identity(&store, &DeviceKey::new("hiperface", "37h", "1", false));
        assert!(began.elapsed() < Duration::from_secs(1), "{:?}", began.elapsed());
        log.try_to_complete();
        assert_eq!((kinds(), log.is_assigned()), (vec![], false));
        other.execute_batch("ROLLBACK").unwrap();
        log.try_to_complete();
        log.complete();
        assert_eq!((kinds(), log.is_assigned()), (vec![EntryKind::Connected, EntryKind::Assigned], true));
    }
}
