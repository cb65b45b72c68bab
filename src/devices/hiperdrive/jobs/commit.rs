//! Carries a plan out.

use super::{ChangeKind, Commit, Committed, Hiperdrive, JobError, JobStep, Prepared, ProgressSink, device_key};
use crate::devices::hiperdrive::procedures::write::DeviceWrite;
use crate::devices::hiperdrive::profile::{Base, HiperdrivePlan, HiperdriveProfile, Op};
use crate::profile::Body;
use crate::store::DeviceKey;
use crate::worker::commit::{Planned, backup_of, write_plan};
use crate::worker::{JobReport, SessionContext};

pub(super) fn commit(
    device: &mut Hiperdrive,
    context: &mut SessionContext,
    commit: &Commit,
    tell: ProgressSink<'_>,
) -> Result<Committed, JobError> {
    let (store, is_virtual) = (context.store.clone(), context.is_virtual);
    let mut write = DeviceWrite { master: device.master(context), identity: &commit.prepared.identity };
    write_plan(&store, is_virtual, commit, &mut write, &mut |at| {
        tell(JobReport::Progress(at.map(|op| JobStep::Operation(op.item()))));
    })
}

impl Planned for Prepared {
    type Base = Base;
    type Op = Op;
    type Kind = ChangeKind;

    fn plan(&self) -> &HiperdrivePlan {
        &self.plan
    }

    fn kind(&self) -> ChangeKind {
        self.kind
    }

    fn device(&self, is_virtual: bool) -> DeviceKey {
        device_key(&self.identity, is_virtual)
    }

    fn cycles_seen(&self) -> Option<u64> {
        self.cycles_seen
    }

    /// Returns no limit, since none is known (`U`). Saves are counted and reported, and refused only if they cannot be
    /// counted.
    fn wear_limit(&self) -> u64 {
        u64::MAX
    }

    fn note(&self, op: &Op) -> String {
        op.note()
    }

    /// Returns everything that the device stores.
    fn before_image(&self) -> String {
        backup_of(Body::new(HiperdriveProfile::of(self.identity.profile(), self.image.clone()))).emit()
    }
}
