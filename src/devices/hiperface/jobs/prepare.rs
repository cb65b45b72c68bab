//! Prepares a plan for a change. Nothing is written.

use std::collections::BTreeSet;

use super::{Change, Hiperface, JobError, JobStep, Prepared, TypeMismatch, device_key};
use crate::devices::hiperface::procedures::write::{check_address_is_free, read_memory, read_protected_fields};
use crate::devices::hiperface::procedures::{
    Error, Master, ensure_standstill, identify, read_all_fields, read_counter, read_field, read_settings,
};
use crate::devices::hiperface::profile::{
    Base, DeviceState, FieldImage, HiperfacePlan, HiperfaceProfile, Op, PlanError, Restore, RestoreOptions,
    SingleValue, check_allowed, plan_create, plan_delete, plan_redefine, plan_restore, plan_scalar, plan_store,
};
use crate::devices::hiperface::protocol::{
    AccessCodeNumber, BROADCAST, FreeMemory, Geometry, LineSettings, nearest_in_phase,
};
use crate::worker::commit::cycles_seen;
use crate::worker::{Progress, SessionContext};

pub(super) fn prepare_plan(
    encoder: &mut Hiperface,
    context: &mut SessionContext,
    change: Change,
    tell: &mut dyn FnMut(Progress<JobStep>),
) -> Result<Prepared, JobError> {
    let types = encoder.types.clone();
    let mut master = encoder.create_master(context);
    let identity = identify(&mut master, &types)?;
    let mut prepared = Prepared {
        kind: change.kind(),
        plan: HiperfacePlan { base: Base::default(), ops: Vec::new() },
        identity,
        cycles_seen: None,
        unchanged: 0,
        missing: Vec::new(),
        mounting_left: Vec::new(),
        mounting_written: Vec::new(),
        unknown_fields: Vec::new(),
        created_left: Vec::new(),
        other_type: None,
        wanted_position: None,
    };
    prepared.plan = match change {
        Change::Restore { profile, options } => restore(&mut master, &mut prepared, &profile, options, tell)?,
        Change::SetPosition { wanted, exact, synchronise, kit } => {
            set_position(&mut master, &mut prepared, wanted, exact, synchronise, kit)?
        }
        Change::ShiftPosition { steps } => {
            let now = ensure_standstill(&mut master, prepared.identity.geometry)?;
            let range = prepared.identity.geometry.and_then(Geometry::position_count).unwrap_or(1 << 32);
            let to = (i64::from(now) + steps).rem_euclid(i64::try_from(range).unwrap_or(i64::MAX));
            let to = u32::try_from(to).unwrap_or(now);
            let fields = prepared.identity.memory.map_or(0, |memory| memory.fields);
            let op = (to != now).then_some(Op::SetPosition { from: now, to, synchronise: false });
            plan_scalar(fields, SingleValue::Position(now), op)
        }
        Change::Store(edits) => {
            let memory = read_memory(&mut master)?;
            let touched: BTreeSet<u8> = edits.iter().map(|(range, _)| range.field).collect();
            let fields = touched
                .into_iter()
                .map(|field| existing_field(&mut master, memory, field))
                .collect::<Result<Vec<_>, _>>()?;
            plan_store(memory.fields, &fields, &edits)?
        }
        Change::CreateField { number, status } => plan_create(read_memory(&mut master)?, number, status)?,
        Change::Redefine { number, status } => {
            let memory = read_memory(&mut master)?;
            let field = existing_field(&mut master, memory, number)?;
            plan_redefine(memory, &field, status)?
        }
        Change::LockField { number, lock } => {
            let memory = read_memory(&mut master)?;
            let field = existing_field(&mut master, memory, number)?;
            plan_redefine(memory, &field, field.status.with_write_enable(!lock))?
        }
        Change::ResizeField { number, size } => {
            let memory = read_memory(&mut master)?;
            let field = existing_field(&mut master, memory, number)?;
            plan_redefine(memory, &field, field.status.with_size(size))?
        }
        Change::DeleteField { number } => {
            let memory = read_memory(&mut master)?;
            let field = existing_field(&mut master, memory, number)?;
            plan_delete(memory, &field)?
        }
        Change::ChangeCode { number, new } => change_code(&mut master, number, new)?,
        Change::SetAddress(to) => {
            let memory = read_memory(&mut master)?;
            let from = master.station().address;
            // A broadcast requires that a single encoder is connected, which may itself have this address.
            if from != to.byte() && from != BROADCAST {
                check_address_is_free(&mut master, to)?;
            }
            let op = (from != to.byte()).then_some(Op::SetAddress { from, to });
            plan_scalar(memory.fields, SingleValue::Address(from), op)
        }
        Change::Configure(to) => {
            let memory = read_memory(&mut master)?;
            let from: LineSettings = read_settings(&mut master)?;
            plan_scalar(memory.fields, SingleValue::Settings(from), (from != to).then_some(Op::Configure { from, to }))
        }
        Change::ClearCounter => {
            let memory = read_memory(&mut master)?;
            let from = read_counter(&mut master)?;
            plan_scalar(memory.fields, SingleValue::Counter(from), (from != 0).then_some(Op::ClearCounter { from }))
        }
        Change::IncrementCounter => {
            let memory = read_memory(&mut master)?;
            let from = read_counter(&mut master)?;
            plan_scalar(memory.fields, SingleValue::Counter(from), Some(Op::IncrementCounter { from }))
        }
    };
    prepared.cycles_seen =
        cycles_seen(&context.log(), &context.store, &device_key(&prepared.identity, context.is_virtual));
    Ok(prepared)
}

fn restore(
    master: &mut Master<'_>,
    prepared: &mut Prepared,
    profile: &HiperfaceProfile,
    options: RestoreOptions,
    tell: &mut dyn FnMut(Progress<JobStep>),
) -> Result<HiperfacePlan, JobError> {
    let serial_number = prepared.identity.serial.serial_number.clone();
    let encoder_type = prepared.identity.label.encoder_type;
    // This check comes first because it does not need the fields.
    check_allowed(profile, &serial_number, encoder_type, &options)?;
    let memory = read_memory(master)?;
    let progress = &mut |done, total| tell(Progress { done, total, step: JobStep::Field(done) });
    let fields = read_all_fields(master, memory.fields, progress)?;
    let restore = plan_restore(profile, &DeviceState { serial_number, encoder_type, memory, fields }, options)?;
    let Restore { common, unknown_fields, created_left } = restore;
    prepared.unchanged = common.unchanged;
    prepared.missing = common.missing;
    prepared.mounting_left = common.mounting_left;
    prepared.mounting_written = common.mounting_written;
    prepared.unknown_fields = unknown_fields;
    prepared.created_left = created_left;
    let of_profile = profile.identity.encoder_type;
    prepared.other_type =
        (of_profile != encoder_type).then_some(TypeMismatch { profile: of_profile, device: encoder_type });
    Ok(common.plan)
}

fn set_position(
    master: &mut Master<'_>,
    prepared: &mut Prepared,
    wanted: u32,
    exact: bool,
    synchronise: bool,
    kit: bool,
) -> Result<HiperfacePlan, JobError> {
    if synchronise && !prepared.identity.kit.unwrap_or(kit) {
        return Err(Error::NotAKit { encoder: prepared.identity.name.clone() }.into());
    }
    let range = prepared.identity.geometry.and_then(Geometry::position_count);
    if let Some(range) = range.filter(|range| u64::from(wanted) >= *range) {
        return Err(Error::PositionRange { wanted: wanted.into(), last: range - 1 }.into());
    }
    let now = ensure_standstill(master, prepared.identity.geometry)?;
    let to = if exact { wanted } else { nearest_in_phase(now, wanted, range) };
    prepared.wanted_position = (to != wanted).then_some(wanted);
    let fields = prepared.identity.memory.map_or(0, |memory| memory.fields);
    // Synchronising aligns the tracks even if the position remains the same.
    let op = (to != now || synchronise).then_some(Op::SetPosition { from: now, to, synchronise });
    Ok(plan_scalar(fields, SingleValue::Position(now), op))
}

fn change_code(
    master: &mut Master<'_>,
    number: AccessCodeNumber,
    new: crate::devices::hiperface::protocol::AccessCode,
) -> Result<HiperfacePlan, JobError> {
    let old = master.station().codes.get(number);
    let (memory, fields) = read_protected_fields(master, number)?;
    let ops = if old == new { vec![] } else { vec![Op::ChangeCode { number, old, new }] };
    Ok(HiperfacePlan { base: Base { field_count: memory.fields, fields, scalars: Vec::new() }, ops })
}

fn existing_field(master: &mut Master<'_>, memory: FreeMemory, number: u8) -> Result<FieldImage, JobError> {
    if number >= memory.fields {
        return Err(PlanError::NoSuchField { field: number, count: memory.fields }.into());
    }
    Ok(read_field(master, number)?)
}
