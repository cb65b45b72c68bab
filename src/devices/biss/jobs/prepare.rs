//! Planning a change. The encoder is only read, and its device mode does not change.

use std::collections::BTreeSet;

use super::{Biss, Change, JobError, JobStep, Prepared, device_key};
use crate::devices::biss::procedures::write::{read_bank, read_state};
use crate::devices::biss::procedures::{Error, Identity, Master, ensure_standstill, identify, write};
use crate::devices::biss::profile::{
    Base, BissPlan, RegisterKind, RegisterRange, Restore, check_allowed, other_type, plan_edits, plan_filter,
    plan_mounting, plan_preset, plan_restore, register_kind, required_banks,
};
use crate::devices::biss::protocol::{Area, RegisterAddress};
use crate::worker::commit::cycles_seen;
use crate::worker::{Progress, SessionContext};

pub(super) fn prepare_plan(
    encoder: &mut Biss,
    context: &mut SessionContext,
    change: &Change,
    tell: &mut dyn FnMut(Progress<JobStep>),
) -> Result<Prepared, JobError> {
    let types = encoder.types.clone();
    let mut master = encoder.create_master(context);
    let identity = identify(&mut master, &types)?;
    let description = identity.description.clone();
    let plan = match change {
        Change::Restore { profile, options } => {
            // This can be checked before the banks are read.
            check_allowed(profile, &identity.profile(), *options)?;
            let areas: Vec<Area> = description.areas().to_vec();
            let state = state(&mut master, &identity, &required_banks(profile, &areas), tell)?;
            plan_restore(profile, &state, *options)?
        }
        Change::Write(edits) => restore_from_plan(plan_register_edits(&mut master, &identity, edits)?),
        Change::SelectFilter(to) => {
            restore_from_plan(plan_filter(&description, &state(&mut master, &identity, &[], tell)?, *to)?)
        }
        Change::Preset { value, parts } => {
            restore_from_plan(plan_preset(&description, &state(&mut master, &identity, &[], tell)?, *value, *parts)?)
        }
        Change::Guided { run, motor } => {
            // A rejection is reported before anything else is read.
            run.check_motor(*motor)?;
            let areas: Vec<Area> = description.areas().to_vec();
            let banks = run.data.as_ref().map(|profile| required_banks(profile, &areas)).unwrap_or_default();
            let state = state(&mut master, &identity, &banks, tell)?;
            restore_from_plan(plan_mounting(&description, &state, run, *motor)?)
        }
    };
    let cycles_seen = cycles_seen(&context.log(), &context.store, &device_key(&identity, context.is_virtual));
    let Restore { plan, unchanged, missing, mounting_left, mounting_written } = plan;
    let (unsaved, other_type) = match change {
        Change::Restore { profile, .. } => {
            (profile.recorded.device_mode, other_type(&profile.identity, &identity.profile()))
        }
        _ => (None, None),
    };
    Ok(Prepared {
        kind: change.kind(),
        plan,
        identity,
        cycles_seen,
        unchanged,
        missing,
        mounting_left,
        mounting_written,
        unsaved,
        other_type,
    })
}

fn restore_from_plan(plan: BissPlan) -> Restore {
    Restore { plan, unchanged: 0, missing: Vec::new(), mounting_left: Vec::new(), mounting_written: Vec::new() }
}

fn state(
    master: &mut Master<'_>,
    identity: &Identity,
    banks: &[u8],
    tell: &mut dyn FnMut(Progress<JobStep>),
) -> Result<crate::devices::biss::profile::DeviceState, Error> {
    let total = banks.len() as u64;
    let report = &mut |done, bank| tell(Progress { done, total, step: JobStep::Bank(bank) });
    read_state(master, identity, banks, report)
}

fn plan_register_edits(
    master: &mut Master<'_>,
    identity: &Identity,
    edits: &[(RegisterRange, Vec<u8>)],
) -> Result<BissPlan, JobError> {
    let description = &identity.description;
    let mut banks = BTreeSet::new();
    let mut singles: BTreeSet<RegisterAddress> = BTreeSet::new();
    for address in edits.iter().flat_map(|(range, _)| range.addresses()) {
        match register_kind(description, address)? {
            RegisterKind::Data(_) => banks.extend(address.bank()),
            RegisterKind::Register => {
                singles.insert(address);
            }
        }
    }
    write::ensure_operation_mode(master, description)?;
    if !banks.is_empty() {
        ensure_standstill(master)?;
    }
    let banks = banks.into_iter().map(|bank| read_bank(master, bank)).collect::<Result<Vec<_>, _>>()?;
    let mut registers = Vec::new();
    for address in singles {
        let reads = description.access_at(address).is_none_or(|access| access.is_readable());
        let value = match reads.then(|| master.read(address)) {
            Some(Err(Error::NoSuchRegister { .. })) | None => None,
            Some(value) => Some(value?),
        };
        registers.push((address, value));
    }
    if edits.is_empty() {
        return Ok(BissPlan { base: Base::default(), ops: Vec::new() });
    }
    Ok(plan_edits(description, &banks, &registers, edits)?)
}
