//! Carrying a plan out: consent and base → before-image on disk → logbook: intent → the operations → read back →
//! logbook: result.

use std::path::Path;

use jiff::Timestamp;

use super::{Commit, Committed, Hiperface, JobError, Prepared, WEAR_LIMIT};
use crate::device::hiperface::write::{Written, carry_out, confirm};
use crate::device::hiperface::{Error, Identity, profile_of};
use crate::profile::hiperface::{Recorded, Scalar};
use crate::profile::{Body, Document};
use crate::store::{DeviceKey, EntryId, Logbook, LogbookError, Outcome};
use crate::worker::{Desk, Progress};

pub(super) fn commit(
    encoder: &mut Hiperface,
    desk: &mut Desk,
    commit: &Commit,
    tell: &mut dyn FnMut(Progress),
) -> Result<Committed, JobError> {
    let prepared = &commit.prepared;
    let plan = &prepared.plan;
    if plan.is_empty() {
        return Ok(Committed::default());
    }
    check_wear(prepared, commit.force_wear)?;
    let store = desk.store.clone();
    let is_virtual = desk.is_virtual;
    let mut master = encoder.master(desk);
    let confirmed = confirm(&mut master, plan, commit.consent, &prepared.identity)?;
    let backup = store
        .backups()
        .keep("hiperface", &prepared.identity.serial.serial_number, Timestamp::now(), &before_image(prepared))
        .map_err(JobError::NotKept)?;
    let mut note = Note::intend(&store.logbook_path(), prepared, is_virtual, &backup);
    let total = plan.ops.len() as u64;
    let progress = &mut |at: usize, op: &crate::profile::hiperface::Op| {
        tell(Progress { done: at as u64, total, what: op.item() });
    };
    match carry_out(&mut master, &confirmed, progress) {
        Ok(written) => {
            note.conclude(Outcome::Done, &written);
            Ok(Committed { written, backup: Some(backup), logbook_warning: note.warning() })
        }
        Err(interrupted) => {
            let outcome = match &interrupted.cause {
                Error::Cancelled => Outcome::Cancelled,
                cause => Outcome::Failed(cause.to_string()),
            };
            note.conclude(outcome, &interrupted.done);
            if let Some(why) = note.warning() {
                tracing::warn!("logbook: {why}");
            }
            Err(JobError::Interrupted { interrupted, backup, planned: plan.ops.len() })
        }
    }
}

/// How the logbook knows an encoder.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    DeviceKey {
        kind: "hiperface".to_owned(),
        device_type: format!("{:02X}h", identity.label.encoder_type),
        serial_number: identity.serial.serial_number.clone(),
        is_virtual,
    }
}

fn check_wear(prepared: &Prepared, force: bool) -> Result<(), JobError> {
    let (used, cost) = (prepared.cycles_seen.unwrap_or(0), prepared.plan.write_cycles());
    if !force && used.saturating_add(cost) > WEAR_LIMIT {
        return Err(JobError::Worn { used, cost, limit: WEAR_LIMIT });
    }
    Ok(())
}

/// A profile of what the plan touches, as it was.
fn before_image(prepared: &Prepared) -> String {
    let base = &prepared.plan.base;
    let mut recorded = Recorded::default();
    for scalar in &base.scalars {
        match scalar {
            Scalar::Position(position) => recorded.position = Some(*position),
            Scalar::Counter(counter) => recorded.counter = Some(*counter),
            Scalar::Address(_) | Scalar::Settings(_) => {}
        }
    }
    let profile = profile_of(&prepared.identity, base.fields.clone(), recorded);
    let mut document = Document::new(Timestamp::now().to_string(), Body::Hiperface(profile));
    document.note = Some("before-image of a write".to_owned());
    document.emit()
}

/// An entry of the logbook that may fail without stopping the write.
struct Note {
    entry: Result<(Logbook, EntryId), LogbookError>,
    warning: Option<String>,
}

impl Note {
    fn intend(path: &Path, prepared: &Prepared, is_virtual: bool, backup: &Path) -> Self {
        let what: Vec<String> = prepared.plan.ops.iter().map(|op| op.item()).collect();
        let key = device_key(&prepared.identity, is_virtual);
        let entry = Logbook::open(path).and_then(|mut logbook| {
            let cycles = prepared.plan.write_cycles();
            let id = logbook.intend(Timestamp::now(), &key, &what.join(", "), cycles, Some(backup))?;
            Ok((logbook, id))
        });
        Note { entry, warning: None }
    }

    fn conclude(&mut self, outcome: Outcome, written: &Written) {
        match &mut self.entry {
            Ok((logbook, id)) => {
                let concluded = logbook.conclude(*id, Timestamp::now(), outcome, written.write_cycles);
                self.warning = concluded.err().map(|error| error.to_string());
            }
            Err(error) => self.warning = Some(error.to_string()),
        }
    }

    fn warning(&self) -> Option<String> {
        self.warning.clone()
    }
}
