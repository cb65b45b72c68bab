//! Execution of plans on an encoder.

use super::{ChangeKind, Commit, Committed, Hiperface, JobError, JobStep, Prepared, WEAR_LIMIT};
use crate::devices::hiperface::procedures::write::EncoderWriter;
use crate::devices::hiperface::procedures::{Identity, create_profile};
use crate::devices::hiperface::profile::{Base, Op, RecordedValues, SingleValue, created_fields};
use crate::devices::hiperface::protocol::KIND;
use crate::profile::{Body, ChangedItem, ProfileDocument};
use crate::store::{DeviceKey, EntryKind};
use crate::worker::commit::{PlanHeader, PlannedWrite, backup_document, write_plan};
use crate::worker::{Progress, SessionContext};

pub(super) fn commit_plan(
    encoder: &mut Hiperface,
    context: &mut SessionContext,
    commit: &Commit,
    tell: &mut dyn FnMut(Progress<JobStep>),
) -> Result<Committed, JobError> {
    let (store, is_virtual) = (context.store.clone(), context.is_virtual);
    let mut write = EncoderWriter::new(encoder.create_master(context), &commit.prepared.identity);
    write_plan(&store, is_virtual, commit, &mut write, &mut |at| tell(at.map_step(|op| JobStep::Operation(op.clone()))))
}

pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    logbook_key(identity.label.encoder_type, &identity.serial.serial_number, is_virtual)
}

pub(super) fn logbook_key(encoder_type: u8, serial_number: &str, is_virtual: bool) -> DeviceKey {
    DeviceKey::new(KIND, &format!("{encoder_type:02X}h"), serial_number, is_virtual)
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
        vec![op.changed_item()]
    }

    fn entry_kind(&self) -> EntryKind {
        match self.plan.ops.as_slice() {
            [Op::SetPosition { .. }] => EntryKind::Preset,
            _ => self.kind.entry_kind(),
        }
    }

    fn backup(&self) -> ProfileDocument {
        let base = &self.plan.base;
        let mut recorded = RecordedValues::default();
        for scalar in &base.scalars {
            match scalar {
                SingleValue::Position(position) => recorded.position = Some(*position),
                SingleValue::Counter(counter) => recorded.counter = Some(*counter),
                SingleValue::Address(_) | SingleValue::Settings(_) => {}
            }
        }
        let mut profile = create_profile(&self.identity, base.fields.clone(), recorded);
        profile.created = created_fields(&self.plan);
        backup_document(Body::new(profile))
    }
}
