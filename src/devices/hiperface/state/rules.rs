//! The encoder's rules for data fields, which are checked before an action is offered. The check creates the same plan
//! as the later write, from the values that were last read.

use super::StagedEdits;
use crate::app::Text;
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::profile::{
    FieldImage, HiperfacePlan, Op, PlanError, plan_create, plan_delete, plan_redefine,
};
use crate::devices::hiperface::protocol::{AccessCodeNumber, DataFieldStatus, FieldSize, FreeMemory};
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::explain;

/// Permission for an action, or the reason why the action is not allowed.
pub type ActionPermission = Result<(), Text>;

/// Checks whether a field of this size can be created.
pub fn create(memory: FreeMemory, size: FieldSize, code: AccessCodeNumber, code_required: bool) -> ActionPermission {
    plan_permission(plan_create(memory, memory.fields, DataFieldStatus::new(size, code, code_required)))
}

pub fn resize(memory: FreeMemory, field: &FieldImage, size: FieldSize, staged: &StagedEdits) -> ActionPermission {
    status(field)?;
    check_edits_preserved(staged, field.number, size.bytes())?;
    plan_permission(plan_redefine(memory, field, field.status.with_size(size)))
}

/// Checks whether the size of the field can be changed. The encoder allows this only for the last field.
pub fn check_resizable(memory: FreeMemory, field: &FieldImage) -> ActionPermission {
    status(field)?;
    plan_permission(plan_delete(memory, field))
}

pub fn delete(memory: FreeMemory, field: &FieldImage, staged: &StagedEdits) -> ActionPermission {
    check_resizable(memory, field)?;
    check_edits_preserved(staged, field.number, 0)
}

/// Checks whether the protection and the access code of the field can be changed. The field's current access code must
/// be known.
pub fn status(field: &FieldImage) -> ActionPermission {
    match field.bytes {
        Some(_) => Ok(()),
        None => Err(TEXTS.text("rules.code_unknown").with("field", field.number).with("number", field.status.code())),
    }
}

/// Checks a change without querying the encoder.
pub(super) fn check_change(staged: &StagedEdits, change: &Change) -> ActionPermission {
    let field = |number: &u8| staged.device().iter().find(|field| field.number == *number);
    match change {
        Change::DeleteField { number }
        | Change::ResizeField { number, .. }
        | Change::LockField { number, .. }
        | Change::Redefine { number, .. } => field(number).map_or(Ok(()), status)?,
        Change::ChangeCode { number, .. } => {
            let mut guarded = staged.device().iter().filter(|field| field.status.code() == *number);
            guarded.try_for_each(status)?;
        }
        _ => {}
    }
    match change {
        Change::DeleteField { number } => check_edits_preserved(staged, *number, 0),
        Change::ResizeField { number, size } => check_edits_preserved(staged, *number, size.bytes()),
        Change::Redefine { number, status } => check_edits_preserved(staged, *number, status.size().bytes()),
        _ => Ok(()),
    }
}

/// Checks that the plan does not delete any byte with an unwritten edit.
pub(super) fn preserves_edits(staged: &StagedEdits, plan: &HiperfacePlan) -> ActionPermission {
    plan.ops.iter().try_for_each(|op| match op {
        Op::Define { field, from: Some(_), to } => {
            check_edits_preserved(staged, *field, if to.exists() { to.size().bytes() } else { 0 })
        }
        _ => Ok(()),
    })
}

/// Checks that the field has no edits after its first `bytes` bytes.
fn check_edits_preserved(staged: &StagedEdits, field: u8, bytes: usize) -> ActionPermission {
    match staged.edited_bytes().filter(|(own, address, _)| *own == field && *address >= bytes).count() {
        0 => Ok(()),
        count => Err(TEXTS.text("rules.edits").with("field", field).with("count", count)),
    }
}

pub fn check_edit(field: &FieldImage) -> ActionPermission {
    if field.bytes.is_none() {
        let error = PlanError::CodeUnknown { field: field.number, code: field.status.code() };
        return Err(explain::plan_error_text(&error));
    }
    if !field.status.is_writable() {
        return Err(explain::plan_error_text(&PlanError::WriteProtected { field: field.number }));
    }
    Ok(())
}

/// Returns the largest possible size of the last field.
pub fn largest_size(memory: FreeMemory, field: &FieldImage) -> FieldSize {
    let fits = |size: &FieldSize| plan_redefine(memory, field, field.status.with_size(*size)).is_ok();
    FieldSize::all().filter(fits).last().unwrap_or(field.status.size())
}

fn plan_permission(plan: Result<HiperfacePlan, PlanError>) -> ActionPermission {
    plan.map(|_| ()).map_err(|error| explain::plan_error_text(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plan that deletes an edited field is rejected, such as a restore that deletes fields and creates them again.
    #[test]
    fn rejects_deleting_edited_field() {
        let status = DataFieldStatus::from_byte(0xC8);
        let field = FieldImage { number: 0, status, bytes: Some(vec![0; 16]) };
        let memory = FreeMemory { blocks: 2, fields: 1 };
        let mut staged = StagedEdits::default();
        staged.refresh(vec![field.clone()]);
        let plan = plan_delete(memory, &field).unwrap();
        assert_eq!(preserves_edits(&staged, &plan), Ok(()));
        staged.edit_bytes(0, 3, &[1]).unwrap();
        assert_eq!(preserves_edits(&staged, &plan).unwrap_err().id(), "rules.edits");
        let grown = plan_redefine(memory, &field, DataFieldStatus::from_byte(0xC9)).unwrap();
        assert_eq!(preserves_edits(&staged, &grown), Ok(()));
    }
}
