//! Execution of plans on an encoder.

use super::{Biss, ChangeKind, Commit, Committed, JobError, JobStep, Prepared, WEAR_LIMIT, device_key};
use crate::devices::biss::procedures::procedure::ProcedureProgress;
use crate::devices::biss::procedures::write::EncoderWriter;
use crate::devices::biss::profile::{Base, BissProfile, DataImage, Op, PresetSetting, RecordedValues};
use crate::profile::{Body, ChangedItem, ProfileDocument, UnknownValues};
use crate::store::{DeviceKey, EntryKind};
use crate::worker::commit::{PlanHeader, PlannedWrite, backup_document, write_plan};
use crate::worker::{Progress, SessionContext};

pub(super) fn commit_plan(
    encoder: &mut Biss,
    context: &mut SessionContext,
    commit: Commit,
    tell: &mut dyn FnMut(Progress<JobStep>),
) -> Result<Committed, JobError> {
    let (store, is_virtual) = (context.store.clone(), context.is_virtual);
    let Commit { agreed, mut attendance } = commit;
    let Prepared { identity, plan, .. } = &agreed.prepared;
    // Report each step of an operation, including its start.
    let report = &mut |news: ProcedureProgress| {
        let (done, total) = (news.op as u64, plan.ops.len() as u64);
        let item = plan.ops.get(news.op).map(Op::item_name).unwrap_or_default();
        tell(Progress { done, total, step: JobStep::Operation { item, progress: Box::new(news) } });
    };
    encoder.ensure_identified(context)?;
    let mut master = encoder.create_master(context);
    let mut write = EncoderWriter::new(&mut master, identity, &mut attendance, report)?;
    let ended = write_plan(&store, is_virtual, &agreed, &mut write, &mut |_| {});
    match &ended {
        Ok(_) => encoder.station.unfinished = false,
        Err(JobError::Interrupted { interrupted, .. }) => {
            encoder.station.unfinished = interrupted.end_state.standing.is_some();
        }
        Err(_) => {}
    }
    ended
}

impl PlannedWrite for Prepared {
    type Base = Base;
    type Op = Op;
    type Kind = ChangeKind;

    fn header(&self) -> PlanHeader<'_, Self> {
        PlanHeader { plan: &self.plan, kind: self.kind, cycles_seen: self.cycles_seen, wear_limit: WEAR_LIMIT }
    }

    fn device(&self, is_virtual: bool) -> DeviceKey {
        device_key(&self.identity, is_virtual)
    }

    fn changed_items(&self, op: &Op) -> Vec<ChangedItem> {
        op.changed_items(&self.identity.description)
    }

    fn entry_kind(&self) -> EntryKind {
        self.kind.entry_kind()
    }

    fn backup(&self) -> ProfileDocument {
        let base = &self.plan.base;
        let description = &self.identity.description;
        let touched = description.areas().iter().map(|area| {
            let banks = base.banks.iter().filter(|bank| area.contains(bank.number)).copied();
            DataImage::new(area, banks.collect())
        });
        let mut profile = BissProfile {
            identity: self.identity.profile(),
            filter: base.filter,
            preset: base.preset.map(|value| PresetSetting { value, unknown: UnknownValues::new() }),
            recorded: RecordedValues::default(),
            mounting: Vec::new(),
            data: touched.filter(|image| image.all_banks().next().is_some()).collect(),
        };
        profile.mark_mounting_dependent_values();
        let mut document = backup_document(Body::new(profile));
        let note = document.note.get_or_insert_default();
        for (address, value) in &base.registers {
            // A profile cannot contain these registers.
            note.push_str(&format!("; {address} was 0x{value:02X}"));
        }
        document
    }
}
