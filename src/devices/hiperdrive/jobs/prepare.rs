//! Plans a change. The device is only read.

use super::{Change, Hiperdrive, JobError, JobStep, Prepared, ProgressSink, device_key};
use crate::devices::hiperdrive::procedures::write::{FaultReset, find_remedy};
use crate::devices::hiperdrive::procedures::{Error, Identity, Master, read_state, settings};
use crate::devices::hiperdrive::profile::{
    HiperdrivePlan, Image, Op, Restore, Service, plan_edits, plan_network, plan_restore, plan_service,
    plan_set_position, type_differences,
};
use crate::devices::hiperdrive::protocol::ParameterNumber;
use crate::worker::commit::cycles_seen;
use crate::worker::{JobReport, Progress, SessionContext};

pub(super) fn prepare_plan(
    device: &mut Hiperdrive,
    context: &mut SessionContext,
    change: &Change,
    tell: ProgressSink<'_>,
) -> Result<Prepared, JobError> {
    let (log, store, is_virtual) = (context.log(), context.store.clone(), context.is_virtual);
    let mut master = device.create_master(context);
    let report = &mut |done, total, number| {
        tell(JobReport::Progress(Progress { done, total, step: JobStep::Parameter(number) }));
    };
    let beside = |wanted: &Image| wanted.values.keys().copied().collect::<Vec<_>>();
    let mut state = |master: &mut Master<'_>, numbers: Vec<ParameterNumber>| {
        let (identity, state) = read_state(master, numbers, report)?;
        ensure_drives_present(&identity, change)?;
        Ok::<_, Error>((identity, state))
    };
    let (identity, image, plan) = match change {
        Change::Restore { profile, options } => {
            let (identity, state) = state(&mut master, Vec::new())?;
            let plan = plan_restore(profile, &state, *options)?;
            (identity, state.image, plan)
        }
        Change::Write(wanted) => {
            let (identity, state) = state(&mut master, beside(wanted))?;
            let plan = plan_edits(&state, wanted)?;
            (identity, state.image, restore_from_plan(plan))
        }
        Change::Try(wanted) => {
            let (identity, state) = state(&mut master, beside(wanted))?;
            let plan = plan_edits(&state, wanted)?.without_save();
            (identity, state.image, restore_from_plan(plan))
        }
        Change::SetPosition { drive, position, save } => {
            let (identity, state) = state(&mut master, Vec::new())?;
            let plan = plan_set_position(&state, *drive, *position)?;
            (identity, state.image, restore_from_plan(if *save { plan } else { plan.without_save() }))
        }
        Change::Do(service) => {
            let (identity, state) = state(&mut master, Vec::new())?;
            let mut plan = plan_service(&state.image, *service);
            if let Service::Acknowledge(drive) = service {
                match find_remedy(&mut master, *drive)? {
                    FaultReset::Nothing => plan.ops.clear(),
                    FaultReset::Acknowledgement => {}
                    FaultReset::Reset => {
                        // A reset concerns all drives, so the plan shows it as a reset.
                        plan = plan_service(&state.image, Service::Reset);
                        plan.ops.push(Op::Service(*service));
                    }
                }
            }
            (identity, state.image, restore_from_plan(plan))
        }
        Change::Network(wanted) => {
            let (identity, state) = state(&mut master, Vec::new())?;
            let now = settings(&mut master)?;
            let switch = ParameterNumber::new(12).map(|number| master.read_number(number)).transpose()?;
            let plan = plan_network(&now, switch, wanted)?;
            (identity, state.image, restore_from_plan(plan))
        }
    };
    let cycles_seen = cycles_seen(&log, &store, &device_key(&identity, is_virtual));
    let other_types = match change {
        Change::Restore { profile, .. } => type_differences(&profile.identity, &identity.profile()),
        _ => Vec::new(),
    };
    let Restore { plan, unchanged, missing, mounting_left, mounting_written } = plan;
    Ok(Prepared {
        kind: change.kind(),
        plan,
        identity,
        image,
        cycles_seen,
        unchanged,
        missing,
        mounting_left,
        other_types,
        mounting_written,
    })
}

/// Checks that the drives selected by the user exist. A profile may contain other drives as well.
fn ensure_drives_present(identity: &Identity, change: &Change) -> Result<(), Error> {
    let named = match change {
        Change::Write(wanted) | Change::Try(wanted) => wanted.drives(),
        Change::SetPosition { drive, .. } | Change::Do(Service::Acknowledge(drive)) => vec![*drive],
        Change::Restore { .. } | Change::Do(_) | Change::Network(_) => Vec::new(),
    };
    named.into_iter().try_for_each(|drive| identity.drive_identity(drive).map(|_| ()))
}

fn restore_from_plan(plan: HiperdrivePlan) -> Restore {
    Restore { plan, unchanged: 0, missing: Vec::new(), mounting_left: Vec::new(), mounting_written: Vec::new() }
}
