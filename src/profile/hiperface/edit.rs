//! Plans for single changes, each with the encoder's own rules checked before anything is sent.

use super::{Base, FieldImage, HiperfacePlan, Op, PlanError, Scalar};
use crate::protocol::hiperface::{DataFieldStatus, FieldSize, FreeMemory};

/// Writes exactly these bytes; nothing when they stand there already.
///
/// # Errors
/// The field is protected or unreadable, or the bytes do not fit into it.
pub fn plan_store(fields: u8, field: &FieldImage, start: usize, bytes: &[u8]) -> Result<HiperfacePlan, PlanError> {
    let number = field.number;
    let content = field.bytes.as_ref().ok_or(PlanError::CodeUnknown { field: number, code: field.status.code() })?;
    let outside =
        PlanError::OutOfField { field: number, last: field.status.size().bytes() - 1, start, count: bytes.len() };
    let end = start.checked_add(bytes.len()).ok_or(outside.clone())?;
    let old = content.get(start..end).filter(|old| !old.is_empty()).ok_or(outside.clone())?;
    let mut ops = Vec::new();
    if old != bytes {
        if !field.status.is_writable() {
            return Err(PlanError::WriteProtected { field: number });
        }
        let address = u8::try_from(start).map_err(|_| outside)?;
        let (old, new) = (Some(old.to_vec()), bytes.to_vec());
        ops.push(Op::Store { field: number, address, status: field.status, old, new });
    }
    Ok(plan(fields, vec![field.clone()], ops))
}

/// Creates the next field.
///
/// # Errors
/// Another number is next, or there is no room.
pub fn plan_create(memory: FreeMemory, number: u8, status: DataFieldStatus) -> Result<HiperfacePlan, PlanError> {
    if number != memory.fields {
        return Err(PlanError::NotNext { field: number, next: memory.fields });
    }
    if status.size().blocks() > memory.blocks {
        return Err(PlanError::NoMemory { needed: status.size().bytes(), free: memory.bytes() });
    }
    Ok(plan(memory.fields, Vec::new(), vec![Op::Define { field: number, from: None, to: status }]))
}

/// Changes protection, access code or, for the last field, the size of a field.
///
/// # Errors
/// Another size for a field that is not the last, or no room for it.
pub fn plan_redefine(memory: FreeMemory, field: &FieldImage, to: DataFieldStatus) -> Result<HiperfacePlan, PlanError> {
    let from = field.status;
    if to.size() != from.size() {
        check_last(memory, field.number)?;
        let more = to.size().blocks().saturating_sub(from.size().blocks());
        if more > memory.blocks {
            let needed = usize::from(more) * FieldSize::BLOCK;
            return Err(PlanError::NoMemory { needed, free: memory.bytes() });
        }
    }
    let ops = if from == to { vec![] } else { vec![Op::Define { field: field.number, from: Some(from), to }] };
    Ok(plan(memory.fields, vec![field.clone()], ops))
}

/// Deletes the last field.
///
/// # Errors
/// It is not the last.
pub fn plan_delete(memory: FreeMemory, field: &FieldImage) -> Result<HiperfacePlan, PlanError> {
    check_last(memory, field.number)?;
    let op = Op::Define { field: field.number, from: Some(field.status), to: field.status.deleted() };
    Ok(plan(memory.fields, vec![field.clone()], vec![op]))
}

/// Changes single values.
pub fn plan_scalar(fields: u8, now: Scalar, op: Option<Op>) -> HiperfacePlan {
    let mut plan = plan(fields, Vec::new(), op.into_iter().collect());
    plan.base.scalars.push(now);
    plan
}

fn check_last(memory: FreeMemory, field: u8) -> Result<(), PlanError> {
    match memory.fields.checked_sub(1) {
        Some(last) if last == field => Ok(()),
        Some(last) => Err(PlanError::NotLast { field, last }),
        None => Err(PlanError::NoSuchField { field, count: 0 }),
    }
}

fn plan(field_count: u8, fields: Vec<FieldImage>, ops: Vec<Op>) -> HiperfacePlan {
    HiperfacePlan { base: Base { field_count, fields, scalars: Vec::new() }, ops }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEMORY: FreeMemory = FreeMemory { blocks: 2, fields: 2 };

    fn field(number: u8, status: u8) -> FieldImage {
        let status = DataFieldStatus::from_byte(status);
        FieldImage { number, status, bytes: Some(vec![0; status.size().bytes()]) }
    }

    #[test]
    fn bytes_are_stored_as_given_or_not_at_all() {
        let plan = plan_store(2, &field(1, 0xE8), 5, &[0x08, 0x00, 0x15]).unwrap();
        assert!(matches!(&plan.ops[..], [Op::Store { field: 1, address: 5, new, .. }] if *new == [0x08, 0x00, 0x15]));
        assert!(plan_store(2, &field(1, 0xE8), 5, &[0, 0]).unwrap().is_empty());
        assert_eq!(plan_store(2, &field(1, 0xA8), 5, &[1]), Err(PlanError::WriteProtected { field: 1 }));
        let outside = PlanError::OutOfField { field: 1, last: 15, start: 15, count: 2 };
        assert_eq!(plan_store(2, &field(1, 0xE8), 15, &[1, 2]), Err(outside));
        assert!(plan_store(2, &field(1, 0xE8), usize::MAX, &[1, 2]).is_err());
        assert!(plan_store(2, &field(1, 0xE8), 0, &[]).is_err());
    }

    #[test]
    fn the_rules_of_the_memory_are_held() {
        let status = DataFieldStatus::from_byte;
        assert!(plan_create(MEMORY, 2, status(0xC9)).is_ok());
        assert_eq!(plan_create(MEMORY, 3, status(0xC9)), Err(PlanError::NotNext { field: 3, next: 2 }));
        assert_eq!(plan_create(MEMORY, 2, status(0xCA)), Err(PlanError::NoMemory { needed: 48, free: 32 }));
        assert!(plan_redefine(MEMORY, &field(1, 0xC8), status(0xCA)).is_ok());
        let grown = plan_redefine(MEMORY, &field(1, 0xC8), status(0xCB));
        assert_eq!(grown, Err(PlanError::NoMemory { needed: 48, free: 32 }));
        let not_last = plan_redefine(MEMORY, &field(0, 0xC8), status(0xC9));
        assert_eq!(not_last, Err(PlanError::NotLast { field: 0, last: 1 }));
        assert!(plan_redefine(MEMORY, &field(0, 0xC8), status(0x88)).is_ok());
        assert_eq!(plan_delete(MEMORY, &field(0, 0xC8)), Err(PlanError::NotLast { field: 0, last: 1 }));
        assert_eq!(plan_delete(MEMORY, &field(1, 0xC8)).unwrap().ops.len(), 1);
    }
}
