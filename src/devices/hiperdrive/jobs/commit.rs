//! Execution of plans on a device.

use super::{ChangeKind, Commit, Committed, Hiperdrive, JobError, JobStep, Prepared, ProgressSink, device_key};
use crate::devices::hiperdrive::procedures::write::DeviceWriter;
use crate::devices::hiperdrive::profile::{Base, HiperdriveProfile, Op};
use crate::profile::{Body, ChangedItem, ProfileDocument};
use crate::store::{DeviceKey, EntryKind};
use crate::worker::commit::{PlanHeader, PlannedWrite, backup_document, write_plan};
use crate::worker::{JobReport, SessionContext};

pub(super) fn commit_plan(
    device: &mut Hiperdrive,
    context: &mut SessionContext,
    commit: &Commit,
    tell: ProgressSink<'_>,
) -> Result<Committed, JobError> {
    let (store, is_virtual) = (context.store.clone(), context.is_virtual);
    let mut write = DeviceWriter { master: device.create_master(context), identity: &commit.prepared.identity };
    write_plan(&store, is_virtual, commit, &mut write, &mut |at| {
        tell(JobReport::Progress(at.map_step(|op| JobStep::Operation(op.item_name()))));
    })
}

impl PlannedWrite for Prepared {
    type Base = Base;
    type Op = Op;
    type Kind = ChangeKind;

    fn header(&self) -> PlanHeader<'_, Self> {
        // The manual does not state a limit (`U`). Saves are counted and reported, and rejected only if they cannot be
        // counted.
        PlanHeader { plan: &self.plan, kind: self.kind, cycles_seen: self.cycles_seen, wear_limit: u64::MAX }
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
        backup_document(Body::new(HiperdriveProfile::from_image(self.identity.profile(), self.image.clone())))
    }
}
