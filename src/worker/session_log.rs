//! Entries that a session adds to the logbook without writing to the device. A logbook that cannot be used is reported
//! in the log, and the job continues.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use jiff::Timestamp;

use crate::analysis::check::Verdict;
use crate::store::{AssetName, DeviceHold, DeviceKey, EntryKind, Event, Logbook, LogbookError, Store};

/// The part of the logbook that belongs to one session. Copies refer to the same session.
#[derive(Clone, Debug, Default)]
pub struct SessionLog(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    /// Asset to which an identified device is assigned.
    asset: Option<AssetName>,
    /// The device that was identified last.
    device: Option<DeviceKey>,
    /// Whether the last device was assigned to the asset, now or earlier.
    is_assigned: bool,
    /// Announcement of the last device to other benches.
    hold: Option<DeviceHold>,
}

impl SessionLog {
    /// Assigns the devices of the session to an asset when they are identified.
    pub fn assign(&self, asset: AssetName) {
        self.state().asset = Some(asset);
    }

    /// Returns the device that was identified last in this session.
    pub fn device(&self) -> Option<DeviceKey> {
        self.state().device.clone()
    }

    /// Tells other benches with the next transfer that the device is no longer connected.
    pub fn release_device(&self) {
        self.state().hold = None;
    }

    /// Returns whether the device that was identified last is assigned to the asset of the session.
    pub fn is_assigned(&self) -> bool {
        self.state().is_assigned
    }

    /// Records that a device was identified, once until another one is identified.
    pub fn record_identity(&self, store: &Store, device: &DeviceKey) {
        let mut state = self.state();
        if state.device.as_ref() == Some(device) {
            return;
        }
        state.device = Some(device.clone());
        state.hold = store.logbook_server().hold(device);
        // Devices without a serial number cannot be told apart.
        let asset = state.asset.clone().filter(|_| !device.serial_number.is_empty());
        state.is_assigned = write(store, |logbook| {
            let now = Timestamp::now();
            if let Some(asset) = &asset {
                logbook.assign(now, device, asset)?;
            }
            logbook.record(now, device, &Event::new(EntryKind::Connected, "identified"))?;
            Ok(asset.is_some())
        })
        .unwrap_or(false);
    }

    /// Records an event of the device that was identified last. Without such a device, nothing is recorded.
    pub fn record(&self, store: &Store, event: &Event) {
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

/// Records an event of a device.
pub fn record_event(store: &Store, device: &DeviceKey, event: &Event) {
    write(store, |logbook| logbook.record(Timestamp::now(), device, event).map(drop));
}

fn write<T>(store: &Store, record: impl FnOnce(&mut Logbook) -> Result<T, LogbookError>) -> Option<T> {
    let written = Logbook::open(&store.logbook_path()).and_then(|mut logbook| record(&mut logbook));
    written.inspect_err(|error| tracing::warn!("{error}")).ok()
}
