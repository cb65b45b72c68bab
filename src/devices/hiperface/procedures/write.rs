//! Executes a plan. The values on which the plan is based are read again before the operations, and all changes are
//! read back after them.

pub use crate::profile::WrittenChanges;

use super::{
    Error, Identity, Master, ReadBackValue, ensure_standstill, read_all_fields, read_counter, read_field,
    read_field_status, read_range,
};
use crate::bits::hex_compact;
use crate::devices::hiperface::procedures::identify::{read_serial, read_type_label};
use crate::devices::hiperface::procedures::master::ExchangeFailure;
use crate::devices::hiperface::procedures::position::{position_range, shortest_distance};
use crate::devices::hiperface::profile::{
    Base, FieldImage, FieldRange, HiperfacePlan, Item, Op, PlanItem, SingleValue,
};
use crate::devices::hiperface::protocol::{
    AccessCodeNumber, BROADCAST, Command, DataFieldStatus, DeviceAddress, FreeMemory, Geometry, Reply, Request,
    StatusCode,
};
use crate::profile::Write;

type ConfirmedPlan<'p> = crate::profile::ConfirmedPlan<'p, Base, Op>;

/// A write that ended before all operations were executed.
pub type InterruptedWrite = crate::profile::InterruptedWrite<Op, Error, WrittenChanges, EndState>;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EndState {
    /// Fields that should be write-protected but are still writable, because the encoder stopped replying.
    pub unlocked: Vec<u8>,
}

pub struct EncoderWriter<'w, 'm> {
    master: Master<'m>,
    identity: &'w Identity,
    left: EndState,
}

impl<'w, 'm> EncoderWriter<'w, 'm> {
    /// Creates a writer for an encoder with the identity on which the plan is based.
    pub fn new(master: Master<'m>, identity: &'w Identity) -> Self {
        EncoderWriter { master, identity, left: EndState::default() }
    }
}

impl Write for EncoderWriter<'_, '_> {
    type Base = Base;
    type Op = Op;
    type Error = Error;
    type Written = WrittenChanges;
    type EndState = EndState;

    /// Checks that the plan was made for this encoder. The memory is compared too, because two new encoders can have
    /// the same identity.
    fn confirm_base(&mut self, plan: &HiperfacePlan) -> Result<(), Error> {
        let (master, identity) = (&mut self.master, self.identity);
        let label = read_type_label(master)?;
        if label.encoder_type != identity.label.encoder_type || read_serial(master)? != identity.serial {
            return Err(Error::Changed { item: PlanItem::Encoder });
        }
        if read_memory(master)?.fields != plan.base.field_count {
            return Err(Error::Changed { item: PlanItem::FieldCount });
        }
        for field in &plan.base.fields {
            if read_field(master, field.number)? != *field {
                return Err(Error::Changed {
                    item: PlanItem::Item(Item::Field(FieldRange::whole_field(field.number))),
                });
            }
        }
        plan.base.scalars.iter().try_for_each(|scalar| ensure_scalar_unchanged(master, *scalar, identity.geometry))
    }

    fn apply(&mut self, op: &Op, confirmed: &ConfirmedPlan<'_>, done: &mut WrittenChanges) -> Result<(), Error> {
        let sent = execute(&mut self.master, op, confirmed, position_range(self.identity.geometry));
        // A change that was rejected or not sent has no effect. Any other change may have been executed.
        done.write_cycles += match &sent {
            Ok(sent) => u64::from(*sent),
            Err(cause) => u64::from(may_have_been_executed(cause)),
        };
        sent?;
        done.count_operation(op.change_count());
        Ok(())
    }

    fn finish(&mut self, confirmed: &ConfirmedPlan<'_>, done: &mut WrittenChanges) -> Result<(), Error> {
        let range = position_range(self.identity.geometry);
        done.verified = self.master.run_uncancellable(|master| verify_plan(master, confirmed.plan(), range))?;
        Ok(())
    }

    /// Write-protects fields again that were made writable, if the encoder still replies.
    fn return_to_safe_state(
        &mut self,
        confirmed: &ConfirmedPlan<'_>,
        ended: Result<(), Error>,
        done: &mut WrittenChanges,
    ) -> Result<(), Error> {
        let Err(cause) = &ended else { return Ok(()) };
        let ops = &confirmed.plan().ops;
        let (before, after) = ops.split_at(done.ops.min(ops.len()));
        let begun = before.iter().chain(after.first().filter(|_| may_have_been_executed(cause)));
        let unlocked: Vec<u8> = begun.filter(|op| op.removes_protection()).filter_map(Op::field).collect();
        let range = position_range(self.identity.geometry);
        for field in unlocked {
            let Some(lock) = after.iter().find(|op| op.locks_field(field)) else { continue };
            let lock_again = |master: &mut Master<'_>| restore_write_protection(master, lock, confirmed, range, done);
            if cause.is_lost() || self.master.run_uncancellable(lock_again).is_err() {
                self.left.unlocked.push(field);
            }
        }
        ended
    }

    fn end_state(&mut self, _: &Error) -> EndState {
        std::mem::take(&mut self.left)
    }
}

fn may_have_been_executed(cause: &Error) -> bool {
    !matches!(cause, Error::Cancelled | Error::Rejected { .. })
}

fn ensure_scalar_unchanged(
    master: &mut Master<'_>,
    scalar: SingleValue,
    geometry: Option<Geometry>,
) -> Result<(), Error> {
    let (same, item) = match scalar {
        SingleValue::Position(then) => {
            let now = ensure_standstill(master, geometry)?;
            if shortest_distance(now, then, position_range(geometry)) > 1 {
                return Err(Error::Moving { readings: vec![then, now] });
            }
            (true, PlanItem::Position)
        }
        SingleValue::Counter(then) => (read_counter(master)? == then, PlanItem::Item(Item::Counter)),
        SingleValue::Settings(then) => (read_type_label(master)?.settings == then, PlanItem::Item(Item::Settings)),
        SingleValue::Address(then) => (master.station().address == then, PlanItem::Item(Item::Address)),
    };
    if same { Ok(()) } else { Err(Error::Changed { item }) }
}

fn restore_write_protection(
    master: &mut Master<'_>,
    lock: &Op,
    confirmed: &ConfirmedPlan<'_>,
    range: u64,
    done: &mut WrittenChanges,
) -> Result<(), Error> {
    let Op::Define { field, to, .. } = lock else { return Ok(()) };
    let now = match read_field_status(master, *field) {
        Ok(now) if now.is_writable() => now,
        Ok(_) => return Ok(()),
        // The field has not been created yet.
        Err(error) if error.is_rejection(StatusCode::NO_SUCH_FIELD) => return Ok(()),
        Err(error) => return Err(error),
    };
    // Only the protection is restored. Other changes of the plan are not made.
    let lock = Op::Define { field: *field, from: Some(now), to: now.with_write_enable(to.is_writable()) };
    let sent = execute(master, &lock, confirmed, range)?;
    done.write_cycles += u64::from(sent);
    Ok(())
}

/// Executes one operation on an encoder with `range` positions, and returns the number of times it was sent.
fn execute(master: &mut Master<'_>, op: &Op, confirmed: &ConfirmedPlan<'_>, range: u64) -> Result<u32, Error> {
    let code0 = master.station().codes.get(AccessCodeNumber::ZERO);
    match op {
        Op::Define { field, from, to } => {
            let guarded_by = from.unwrap_or(*to).code();
            let code = master.station().codes.get(guarded_by);
            let request = Request::DefineField { field: *field, status: *to, code };
            master.send_verified(&request, |master| field_status_matches(master, *field, *to))
        }
        Op::Store { field, address, status, new, .. } => {
            let code = master.station().codes.get(status.code());
            let request = Request::StoreData { field: *field, address: *address, code, data: new.clone() };
            let start = usize::from(*address);
            master.send_verified(&request, |master| Ok(read_range(master, *field, start, new.len(), code)? == *new))
        }
        Op::ChangeCode { number, old, new } => {
            let request = Request::ChangeCode { number: *number, old: *old, new: *new };
            let sent = master
                .send_verified(&request, |master| is_code_accepted(master, &confirmed.plan().base, *number, *new))?;
            master.station().codes.set_code(*number, *new);
            Ok(sent)
        }
        Op::SetPosition { from, to, synchronise } => {
            let request = if *synchronise {
                Request::Synchronise { position: *to, code0 }
            } else {
                Request::SetPosition { position: *to, code0 }
            };
            let telling = shortest_distance(*from, *to, range) > 1;
            master.send_verified(&request, |master| {
                if !telling {
                    return Err(Error::PositionUnchanged);
                }
                Ok(shortest_distance(super::read_position(master, None)?.raw, *to, range) <= 1)
            })
        }
        Op::SetAddress { to, .. } => set_address(master, *to),
        Op::Configure { to, .. } => {
            let request = Request::ConfigureLine { settings: *to, code0 };
            master.send_verified(&request, |master| Ok(read_type_label(master)?.settings == *to))
        }
        Op::ClearCounter { .. } => {
            master.send_verified(&Request::ClearCounter { code0 }, |master| Ok(read_counter(master)? == 0))
        }
        Op::IncrementCounter { from } => {
            let next = increment_counter_value(*from);
            match master.send_verified(&Request::IncrementCounter, |master| Ok(read_counter(master)? == next)) {
                // Some types report the overflow this way although the counter was incremented (manual, "Zähler
                // erhöhen").
                Err(Error::Rejected { codes, .. }) if codes == [StatusCode::COUNTER_OVERFLOW] => {
                    master.station().queue_codes(codes);
                    Ok(1)
                }
                result => result,
            }
        }
    }
}

fn increment_counter_value(counter: u32) -> u32 {
    counter.wrapping_add(1) & 0x00FF_FFFF
}

fn set_address(master: &mut Master<'_>, to: DeviceAddress) -> Result<u32, Error> {
    let code0 = master.station().codes.get(AccessCodeNumber::ZERO);
    let before = master.station().address;
    let request = Request::SetAddress { new: to, code0 };
    let sent = master.send_verified(&request, |master| {
        master.station().address = to.byte();
        let moved = read_type_label(master).is_ok();
        master.station().address = before;
        // An encoder that does not reply at the new address must reply at the old address. Otherwise, it cannot be
        // reached.
        if moved { Ok(true) } else { read_type_label(master).map(|_| false) }
    })?;
    if before != BROADCAST {
        master.station().address = to.byte();
    }
    Ok(sent)
}

fn field_status_matches(master: &mut Master<'_>, field: u8, wanted: DataFieldStatus) -> Result<bool, Error> {
    match read_field_status(master, field) {
        Ok(status) => Ok(status == wanted),
        Err(error) if error.is_rejection(StatusCode::NO_SUCH_FIELD) => Ok(!wanted.exists()),
        Err(error) => Err(error),
    }
}

/// Returns whether the encoder accepts an access code for a field that it protects. Without such a field, the code
/// cannot be tested.
fn is_code_accepted(
    master: &mut Master<'_>,
    base: &Base,
    number: AccessCodeNumber,
    code: crate::devices::hiperface::protocol::AccessCode,
) -> Result<bool, Error> {
    let guarded = |field: &&FieldImage| field.status.code() == number && field.status.code_required();
    let Some(field) = base.fields.iter().find(guarded) else {
        return Err(Error::CodeGuardsNothing { number });
    };
    match read_range(master, field.number, 0, 1, code) {
        Ok(_) => Ok(true),
        Err(error) if error.is_rejection(StatusCode::WRONG_CODE) => Ok(false),
        Err(error) => Err(error),
    }
}

/// Reads back the final value of every field and byte that the plan changed.
fn verify_plan(master: &mut Master<'_>, plan: &HiperfacePlan, range: u64) -> Result<u64, Error> {
    let mut verified = 0;
    for (at, op) in plan.ops.iter().enumerate() {
        let later = plan.ops.get(at + 1..).unwrap_or_default();
        match op {
            Op::Define { field, to, .. } => {
                let redefined = |op: &Op| matches!(op, Op::Define { field: other, .. } if other == field);
                if !later.iter().any(redefined) && !field_status_matches(master, *field, *to)? {
                    let (item, expected) = (op.plan_item(), format!("{:02X}", to.byte()));
                    return Err(Error::NotVerified { item, expected, got: ReadBackValue::StatusMismatch });
                }
                verified += 1;
            }
            Op::Store { field, address, new, .. } => {
                let status = read_field_status(master, *field)?;
                let code = master.station().codes.get(status.code());
                // A field whose size was reduced afterwards no longer contains all of the written bytes.
                let size = status.size().bytes().saturating_sub(usize::from(*address)).min(new.len());
                let expected = new.get(..size).unwrap_or_default();
                let got = read_range(master, *field, usize::from(*address), size, code)?;
                if got != expected {
                    return Err(mismatch_error(op, hex_compact(expected), hex_compact(&got)));
                }
                verified += op.change_count();
            }
            Op::SetPosition { to, .. } => {
                let raw = super::read_position(master, None)?.raw;
                if shortest_distance(raw, *to, range) > 1 {
                    return Err(mismatch_error(op, to.to_string(), raw.to_string()));
                }
                verified += 1;
            }
            Op::SetAddress { .. } => {
                read_type_label(master)?;
                verified += 1;
            }
            Op::Configure { to, .. } => {
                let settings = read_type_label(master)?.settings;
                if settings != *to {
                    return Err(mismatch_error(op, format!("{to:?}"), format!("{settings:?}")));
                }
                verified += 1;
            }
            Op::ClearCounter { .. } | Op::IncrementCounter { .. } => {
                let expected = match op {
                    Op::IncrementCounter { from } => increment_counter_value(*from),
                    _ => 0,
                };
                let counter = read_counter(master)?;
                if counter != expected {
                    return Err(mismatch_error(op, expected.to_string(), counter.to_string()));
                }
                verified += 1;
            }
            // An access code cannot be read back. Only the encoder's reply confirms the change.
            Op::ChangeCode { .. } => {}
        }
    }
    Ok(verified)
}

fn mismatch_error(op: &Op, expected: String, got: String) -> Error {
    Error::NotVerified { item: op.plan_item(), expected, got: ReadBackValue::Value(got) }
}

/// Checks that no encoder replies at an address, because two encoders with the same address cannot be distinguished.
///
/// # Errors
/// Returns [`Error::AddressTaken`] if anything is received, or another error if the connection fails or the job is
/// cancelled.
pub fn check_address_is_free(master: &mut Master<'_>, address: DeviceAddress) -> Result<(), Error> {
    let before = std::mem::replace(&mut master.station().address, address.byte());
    let answers = (0..2).map(|_| master.exchange_once(&Request::ReadTypeLabel)).collect::<Result<Vec<_>, _>>();
    master.station().address = before;
    match answers?.iter().all(|answer| matches!(answer, Err(ExchangeFailure::Silence { .. }))) {
        true => Ok(()),
        false => Err(Error::AddressTaken { address: address.byte() }),
    }
}

pub fn read_memory(master: &mut Master<'_>) -> Result<FreeMemory, Error> {
    match master.request_confirmed(&Request::FreeMemory)? {
        Reply::FreeMemory(memory) => Ok(memory),
        other => Err(Error::unexpected_reply(Command::FreeMemory, &other)),
    }
}

/// Reads all fields that require this access code, to check whether the code was changed.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_protected_fields(
    master: &mut Master<'_>,
    number: AccessCodeNumber,
) -> Result<(FreeMemory, Vec<FieldImage>), Error> {
    let memory = read_memory(master)?;
    let mut fields = read_all_fields(master, memory.fields, &mut |_, _| {})?;
    fields.retain(|field| field.status.code() == number && field.status.code_required());
    Ok((memory, fields))
}
