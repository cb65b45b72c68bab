//! Plans single changes. A change is checked against the encoder's rules before anything is sent.

use super::{Base, FieldImage, FieldRange, HiperfacePlan, Op, PlanError, SingleValue};
use crate::devices::hiperface::protocol::{DataFieldStatus, FieldSize, FreeMemory};

/// Plans to write bytes to data fields. Adjacent or overlapping edits become one operation. If a byte is edited twice,
/// the last edit applies. Edits that change nothing are omitted. `fields` contains each edited field once.
///
/// # Errors
/// Returns an error if a field is missing, protected or unreadable, or if the bytes do not fit into the field or into
/// their range.
pub fn plan_store(
    field_count: u8,
    fields: &[FieldImage],
    edits: &[(FieldRange, Vec<u8>)],
) -> Result<HiperfacePlan, PlanError> {
    let mut fields = fields.to_vec();
    fields.sort_by_key(|field| field.number);
    if let Some((range, _)) = edits.iter().find(|(range, _)| !fields.iter().any(|field| field.number == range.field)) {
        return Err(PlanError::NoSuchField { field: range.field, count: field_count });
    }
    let mut ops = Vec::new();
    for field in &fields {
        ops.extend(store_operations(field, edits.iter().filter(|(range, _)| range.field == field.number))?);
    }
    Ok(plan(field_count, fields, ops))
}

/// Returns the operations for one field in ascending order of address. An operation always fits into one transfer,
/// because both fields and transfers are limited to 128 bytes.
fn store_operations<'e>(
    field: &FieldImage,
    edits: impl Iterator<Item = &'e (FieldRange, Vec<u8>)>,
) -> Result<Vec<Op>, PlanError> {
    let number = field.number;
    let content = field.bytes.as_ref().ok_or(PlanError::CodeUnknown { field: number, code: field.status.code() })?;
    let mut wanted = vec![None; content.len()];
    for (range, bytes) in edits {
        let (last, start, count) = (field.status.size().bytes() - 1, range.start, bytes.len());
        let end = start.checked_add(count).filter(|_| count > 0 && range.count.is_none_or(|given| given == count));
        let place = end.and_then(|end| wanted.get_mut(start..end)).ok_or(PlanError::OutOfField {
            field: number,
            last,
            start,
            count,
        })?;
        place.iter_mut().zip(bytes).for_each(|(place, byte)| *place = Some(*byte));
    }
    let mut runs: Vec<(usize, Vec<u8>)> = Vec::new();
    for (at, byte) in wanted.into_iter().enumerate().filter_map(|(at, byte)| Some((at, byte?))) {
        match runs.last_mut() {
            Some((start, run)) if *start + run.len() == at => run.push(byte),
            _ => runs.push((at, vec![byte])),
        }
    }
    let mut ops = Vec::new();
    for (start, new) in runs {
        let old = content.get(start..start + new.len()).unwrap_or_default().to_vec();
        if old == new {
            continue;
        }
        if !field.status.is_writable() {
            return Err(PlanError::WriteProtected { field: number });
        }
        let (last, count) = (field.status.size().bytes() - 1, new.len());
        let address = u8::try_from(start).map_err(|_| PlanError::OutOfField { field: number, last, start, count })?;
        ops.push(Op::Store { field: number, address, status: field.status, old: Some(old), new });
    }
    Ok(ops)
}

/// Plans to create the next data field.
///
/// # Errors
/// Returns an error if `number` is not the next field number or the memory is too small.
pub fn plan_create(memory: FreeMemory, number: u8, status: DataFieldStatus) -> Result<HiperfacePlan, PlanError> {
    if number != memory.fields {
        return Err(PlanError::NotNext { field: number, next: memory.fields });
    }
    if status.size().block_count() > memory.blocks {
        return Err(PlanError::NoMemory { needed: status.size().bytes(), free: memory.bytes() });
    }
    Ok(plan(memory.fields, Vec::new(), vec![Op::Define { field: number, from: None, to: status }]))
}

/// Plans to change the protection, the access code or, for the last field, the size of a data field.
///
/// # Errors
/// Returns an error if the size of a field other than the last would change, or if the memory is too small.
pub fn plan_redefine(memory: FreeMemory, field: &FieldImage, to: DataFieldStatus) -> Result<HiperfacePlan, PlanError> {
    let from = field.status;
    if to.size() != from.size() {
        check_is_last_field(memory, field.number)?;
        let more = to.size().block_count().saturating_sub(from.size().block_count());
        if more > memory.blocks {
            let needed = usize::from(more) * FieldSize::BLOCK;
            return Err(PlanError::NoMemory { needed, free: memory.bytes() });
        }
    }
    let ops = if from == to { vec![] } else { vec![Op::Define { field: field.number, from: Some(from), to }] };
    Ok(plan(memory.fields, vec![field.clone()], ops))
}

/// Plans to delete the last data field.
///
/// # Errors
/// Returns an error if the field is not the last one.
pub fn plan_delete(memory: FreeMemory, field: &FieldImage) -> Result<HiperfacePlan, PlanError> {
    check_is_last_field(memory, field.number)?;
    let op = Op::Define { field: field.number, from: Some(field.status), to: field.status.as_deleted() };
    Ok(plan(memory.fields, vec![field.clone()], vec![op]))
}

/// Plans to change a single value.
pub fn plan_scalar(fields: u8, now: SingleValue, op: Option<Op>) -> HiperfacePlan {
    let mut plan = plan(fields, Vec::new(), op.into_iter().collect());
    plan.base.scalars.push(now);
    plan
}

fn check_is_last_field(memory: FreeMemory, field: u8) -> Result<(), PlanError> {
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

    fn store(field: &FieldImage, start: usize, bytes: &[u8]) -> Result<HiperfacePlan, PlanError> {
        plan_store(
            2,
            std::slice::from_ref(field),
            &[(FieldRange::new(field.number, start, bytes.len()), bytes.to_vec())],
        )
    }

    #[test]
    fn plans_only_valid_stores() {
        let plan = store(&field(1, 0xE8), 5, &[0x08, 0x00, 0x15]).unwrap();
        assert!(matches!(&plan.ops[..], [Op::Store { field: 1, address: 5, new, .. }] if *new == [0x08, 0x00, 0x15]));
        assert!(store(&field(1, 0xE8), 5, &[0, 0]).unwrap().is_empty());
        assert_eq!(store(&field(1, 0xA8), 5, &[1]), Err(PlanError::WriteProtected { field: 1 }));
        let outside = PlanError::OutOfField { field: 1, last: 15, start: 15, count: 2 };
        assert_eq!(store(&field(1, 0xE8), 15, &[1, 2]), Err(outside));
        assert!(store(&field(1, 0xE8), usize::MAX, &[1, 2]).is_err());
        assert!(store(&field(1, 0xE8), 0, &[]).is_err());
        let miscounted = plan_store(2, &[field(1, 0xE8)], &[(FieldRange::new(1, 3, 1), vec![1, 2])]);
        assert_eq!(miscounted, Err(PlanError::OutOfField { field: 1, last: 15, start: 3, count: 2 }));
        let absent = plan_store(2, &[field(1, 0xE8)], &[(FieldRange::new(2, 0, 1), vec![1])]);
        assert_eq!(absent, Err(PlanError::NoSuchField { field: 2, count: 2 }));
    }

    #[test]
    fn combines_edits_into_one_plan() {
        let fields = [field(1, 0xE8), field(0, 0xE9)];
        let edit = |field, start, bytes: &[u8]| (FieldRange::new(field, start, bytes.len()), bytes.to_vec());
        let edits = [
            edit(1, 4, &[5]),
            edit(0, 30, &[9, 9]),
            edit(1, 2, &[3, 4]),
            edit(0, 8, &[0, 0, 0]),
            edit(1, 0, &[7]),
            edit(0, 0, &[1, 1]),
            edit(0, 1, &[2]),
        ];
        let plan = plan_store(2, &fields, &edits).unwrap();
        let base: Vec<u8> = plan.base.fields.iter().map(|field| field.number).collect();
        assert_eq!(base, [0, 1], "each once");
        let ops: Vec<(u8, u8, Vec<u8>)> = plan
            .ops
            .iter()
            .map(|op| match op {
                Op::Store { field, address, new, .. } => (*field, *address, new.clone()),
                other => panic!("{other:?}"),
            })
            .collect();
        let expected = [(0, 0, vec![1, 2]), (0, 30, vec![9, 9]), (1, 0, vec![7]), (1, 2, vec![3, 4, 5])];
        assert_eq!(ops, expected, "what stands there already is not sent");
        assert!(plan_store(2, &[], &[]).unwrap().is_empty());
    }

    #[test]
    fn enforces_memory_rules() {
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
