//! Prepares a plan from a change. The encoder is only read and remains in its mode.

use super::{Change, DeviceMessage, Interbus, JobError, JobStep, Prepared, ProgressSink, device_key};
use crate::devices::interbus::procedures::{identify, read_state};
use crate::devices::interbus::profile::{
    Image, InterbusPlan, Item, Restore, check_allowed, other_type, plan_default, plan_edits, plan_preset, plan_restore,
    programs_to_read,
};
use crate::devices::interbus::protocol::ProgramNumber;
use crate::worker::commit::cycles_seen;
use crate::worker::{JobReport, Progress, SessionContext};

pub(super) fn prepare_plan(
    encoder: &mut Interbus,
    context: &mut SessionContext,
    change: &Change,
    tell: ProgressSink<'_>,
) -> Result<Prepared, JobError> {
    let (log, store, is_virtual) = (context.log(), context.store.clone(), context.is_virtual);
    let tell = std::cell::RefCell::new(tell);
    let mut master = encoder
        .create_master(context, |step| (tell.borrow_mut())(JobReport::DeviceMessage(DeviceMessage::Handshake(step))));
    let report = &mut |done, total, program| {
        (tell.borrow_mut())(JobReport::Progress(Progress { done, total, step: JobStep::Program(program) }));
    };
    let identity = identify(&mut master)?;
    let mut state = |programs: &[ProgramNumber]| read_state(&mut master, &identity, programs, report);
    let device;
    let plan = match change {
        Change::Restore { profile, options } => {
            // The type can be checked before the programs are read.
            check_allowed(profile, &identity.profile(), *options)?;
            device = state(&programs_to_read(profile))?;
            plan_restore(profile, &device, *options)?
        }
        Change::Write(wanted) => {
            device = state(&required_programs(wanted))?;
            restore_from_plan(plan_edits(&device.image, wanted)?)
        }
        Change::Item(item, value) => {
            let needed = match item {
                Item::Shift => ProgramNumber::all().take(1).collect(),
                item => item.program().into_iter().collect::<Vec<_>>(),
            };
            device = state(&needed)?;
            let mut wanted = Image { shift: None, ..device.image.clone() };
            wanted.set_value(*item, *value);
            restore_from_plan(plan_edits(&device.image, &wanted)?)
        }
        Change::Preset { value } => {
            device = state(&[])?;
            restore_from_plan(plan_preset(&device.image.parameters, *value)?)
        }
        Change::Default => {
            device = state(&[])?;
            restore_from_plan(plan_default(&device.image.parameters))
        }
    };
    let cycles_seen = cycles_seen(&log, &store, &device_key(&identity, is_virtual));
    let other_type = match change {
        Change::Restore { profile, .. } => other_type(&profile.identity, &identity.profile()),
        _ => None,
    };
    let Restore { plan, unchanged, missing, mounting_left, mounting_written } = plan;
    let parameters = device.image.parameters;
    Ok(Prepared {
        kind: change.kind(),
        plan,
        identity,
        parameters,
        cycles_seen,
        unchanged,
        missing,
        mounting_left,
        other_type,
        mounting_written,
    })
}

/// Returns the programs that must be read before the given values can be planned. The window shift is read with any
/// program.
fn required_programs(wanted: &Image) -> Vec<ProgramNumber> {
    let known: Vec<ProgramNumber> = wanted.known_programs().map(|(number, _)| number).collect();
    match wanted.shift {
        Some(_) if known.is_empty() => ProgramNumber::all().take(1).collect(),
        _ => known,
    }
}

fn restore_from_plan(plan: InterbusPlan) -> Restore {
    Restore { plan, unchanged: 0, missing: Vec::new(), mounting_left: Vec::new(), mounting_written: Vec::new() }
}
