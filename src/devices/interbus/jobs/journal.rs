//! Records that outlive a job: the mode in which an encoder was found, and the EEPROM write cycles that reading may
//! have caused.

use std::collections::BTreeMap;

use jiff::Timestamp;

use crate::devices::interbus::procedures::{Journal, ModeSwitch};
use crate::devices::interbus::protocol::{KIND, StartupMode, Value};
use crate::profile::ChangedItem;
use crate::store::{DeviceKey, Drafts, EntryId, EntryKind, Intent, Logbook, LogbookError, Outcome, Store};
use crate::worker::{SessionContext, SessionLog};

use super::job::logbook_key;

/// Description of the logbook entry for reading cam programs.
pub const PROGRAM_READ_NOTE: &str = "cam programs read, each of which may be stored when it is left";

pub(super) struct WriteJournal {
    store: Store,
    log: SessionLog,
    is_virtual: bool,
    begun: BTreeMap<String, (Logbook, EntryId)>,
}

impl WriteJournal {
    pub(super) fn new(context: &SessionContext) -> Self {
        let (store, log, is_virtual) = (context.store.clone(), context.log(), context.is_virtual);
        WriteJournal { store, log, is_virtual, begun: BTreeMap::new() }
    }

    fn pending_mode_restores(&self) -> Drafts {
        self.store.pending_mode_restores()
    }

    /// Returns the name under which an encoder is recorded. Virtual encoders are marked, because their serial numbers
    /// may equal those of real ones.
    fn name(&self, serial_number: &str) -> String {
        format!("{serial_number}{}", if self.is_virtual { " (virtual)" } else { "" })
    }

    fn device_key(&self, serial_number: &str) -> DeviceKey {
        logbook_key(serial_number, self.is_virtual)
    }

    fn record_intent(&self, serial_number: &str, stores: u64) -> Result<(Logbook, EntryId), LogbookError> {
        // The connection is logged before anything that happens during it.
        self.log.record_identity(&self.store, &self.device_key(serial_number));
        let mut logbook = Logbook::open(&self.store.logbook_path())?;
        let items = vec![ChangedItem::new(PROGRAM_READ_NOTE, None, None)];
        let intent = Intent { kind: EntryKind::Procedure, items, planned_cycles: stores, backup: None, undoes: None };
        let entry = logbook.record_intent(Timestamp::now(), &self.device_key(serial_number), &intent)?;
        Ok((logbook, entry))
    }
}

/// Logs a failure to record something and returns `None`, so that the job continues.
fn log_error<T, E: std::fmt::Display>(ended: Result<T, E>) -> Option<T> {
    ended.inspect_err(|why| tracing::warn!("{why}")).ok()
}

impl Journal for WriteJournal {
    fn has_modes_to_restore(&self) -> bool {
        self.pending_mode_restores().has_drafts(KIND)
    }

    fn recorded_mode_switch(&self, serial_number: &str) -> Option<ModeSwitch> {
        let text = log_error(self.pending_mode_restores().load(KIND, &self.name(serial_number)))??;
        parse(&text)
    }

    fn save_mode_switch(&mut self, serial_number: &str, excursion: &ModeSwitch) {
        log_error(self.pending_mode_restores().save(KIND, &self.name(serial_number), &emit(excursion)));
    }

    fn record_mode_restored(&mut self, serial_number: &str) {
        log_error(self.pending_mode_restores().remove(KIND, &self.name(serial_number)));
    }

    fn record_planned_stores(&mut self, serial_number: &str, stores: u64) {
        if !self.begun.contains_key(serial_number)
            && let Some(entry) = log_error(self.record_intent(serial_number, stores))
        {
            self.begun.insert(serial_number.to_owned(), entry);
        }
    }

    fn record_possible_stores(&mut self, serial_number: &str, stores: u64) {
        let begun = match self.begun.remove(serial_number) {
            None if stores > 0 => log_error(self.record_intent(serial_number, stores)),
            begun => begun,
        };
        if let Some((mut logbook, entry)) = begun {
            log_error(logbook.record_outcome(entry, Timestamp::now(), Outcome::Done, stores));
        }
    }
}

/// Formats a mode switch as a list of mode numbers (read-out 9): the original mode, then the modes entered since.
fn emit(excursion: &ModeSwitch) -> String {
    let modes: Vec<u32> =
        std::iter::once(excursion.found).chain(excursion.sent.iter().copied()).map(StartupMode::emit).collect();
    format!("{modes:?}\n")
}

fn parse(text: &str) -> Option<ModeSwitch> {
    let modes: Vec<u32> = log_error(ron::from_str(text))?;
    let mut modes = modes.into_iter().map(|mode| StartupMode::parse(Value::from_word(mode)));
    Some(ModeSwitch { found: modes.next()?, sent: modes.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mode number 1 is position mode, and 6 is cam program 4.
    #[test]
    fn stores_mode_switch_as_numbers() {
        let mode = |number| StartupMode::parse(Value::from_word(number));
        let excursion = ModeSwitch { found: mode(1), sent: vec![mode(3), mode(6)] };
        assert_eq!(emit(&excursion), "[1, 3, 6]\n");
        assert_eq!(parse("[1, 3, 6]\n"), Some(excursion));
        assert_eq!((parse("[]"), parse("cam 4")), (None, None));
    }
}
