//! What the encoder's own rules allow with its data fields, asked before anything is offered: the same plans that a write
//! would make, on the memory as it was read.

use crate::app::Text;
use crate::app::explain;
use crate::profile::hiperface::{FieldImage, HiperfacePlan, PlanError, plan_create, plan_delete, plan_redefine};
use crate::protocol::hiperface::{CodeNumber, DataFieldStatus, FieldSize, FreeMemory};

/// Whether something may be done; if not, why.
pub type Allowed = Result<(), Text>;

/// A new field of this size may be created, and which number it would get.
pub fn create(memory: FreeMemory, size: FieldSize, code: CodeNumber, code_required: bool) -> Allowed {
    allowed(plan_create(memory, memory.fields, DataFieldStatus::new(size, code, code_required)))
}

/// The field may get this size.
pub fn resize(memory: FreeMemory, field: &FieldImage, size: FieldSize) -> Allowed {
    allowed(plan_redefine(memory, field, field.status.with_size(size)))
}

/// The field may change its size at all: it is the last.
pub fn resizable(memory: FreeMemory, field: &FieldImage) -> Allowed {
    delete(memory, field)
}

/// The field may be deleted.
pub fn delete(memory: FreeMemory, field: &FieldImage) -> Allowed {
    allowed(plan_delete(memory, field))
}

/// The field's bytes may be edited.
pub fn edit(field: &FieldImage) -> Allowed {
    if field.bytes.is_none() {
        let error = PlanError::CodeUnknown { field: field.number, code: field.status.code() };
        return Err(explain::hiperface::plan(&error));
    }
    if !field.status.is_writable() {
        return Err(explain::hiperface::plan(&PlanError::WriteProtected { field: field.number }));
    }
    Ok(())
}

/// The largest size that the last field can get.
pub fn largest(memory: FreeMemory, field: &FieldImage) -> FieldSize {
    let fits = |size: &FieldSize| resize(memory, field, *size).is_ok();
    FieldSize::all().filter(fits).last().unwrap_or(field.status.size())
}

fn allowed(plan: Result<HiperfacePlan, PlanError>) -> Allowed {
    plan.map(|_| ()).map_err(|error| explain::hiperface::plan(&error))
}
