//! Execution of plans on an encoder.

use super::{
    ChangeKind, Commit, Committed, DeviceMessage, Interbus, JobError, JobStep, Prepared, ProgressSink, device_key,
    wear_limit,
};
use crate::devices::interbus::procedures::write::EncoderWriter;
use crate::devices::interbus::profile::{Base, Image, InterbusProfile, Op, RecordedValues};
use crate::profile::{Body, ChangedItem, ProfileDocument};
use crate::store::{DeviceKey, EntryKind};
use crate::worker::commit::{PlanHeader, PlannedWrite, backup_document, write_plan};
use crate::worker::{JobReport, SessionContext};

pub(super) fn commit_plan(
    encoder: &mut Interbus,
    context: &mut SessionContext,
    commit: &Commit,
    tell: ProgressSink<'_>,
) -> Result<Committed, JobError> {
    let (store, is_virtual) = (context.store.clone(), context.is_virtual);
    let tell = std::cell::RefCell::new(tell);
    let master = encoder
        .create_master(context, |step| (tell.borrow_mut())(JobReport::DeviceMessage(DeviceMessage::Handshake(step))));
    let mut write = EncoderWriter { master, identity: &commit.prepared.identity };
    write_plan(&store, is_virtual, commit, &mut write, &mut |at| {
        (tell.borrow_mut())(JobReport::Progress(at.map_step(|op| JobStep::Operation(op.item_names()))));
    })
}

impl PlannedWrite for Prepared {
    type Base = Base;
    type Op = Op;
    type Kind = ChangeKind;

    fn header(&self) -> PlanHeader<'_, Self> {
        let wear_limit = wear_limit(self.plan.write_cycles());
        PlanHeader { plan: &self.plan, kind: self.kind, cycles_seen: self.cycles_seen, wear_limit }
    }

    fn device(&self, is_virtual: bool) -> DeviceKey {
        device_key(&self.identity, is_virtual)
    }

    fn changed_items(&self, op: &Op) -> Vec<ChangedItem> {
        op.changed_items()
    }

    fn entry_kind(&self) -> EntryKind {
        self.kind.entry_kind()
    }

    fn backup(&self) -> ProfileDocument {
        let (base, identity) = (&self.plan.base, &self.identity);
        let mut image = Image::from_parameters(self.parameters);
        image.shift = base.shift;
        for (number, program) in &base.programs {
            if let Some(place) = image.program_mut(*number) {
                *place = Some(*program);
            }
        }
        let profile = InterbusProfile::new(identity.profile(), image, RecordedValues::default());
        backup_document(Body::new(profile))
    }
}
