//! INTERBUS profiles: the saved content of a K3 encoder, the differences between two profiles, and the effect of a
//! write.

#![warn(missing_docs)]

mod edit;
mod entry_error;
mod error;
mod image;
mod item;
mod note;
mod plan;
mod record;
mod restore;
mod scale;
mod table;
#[cfg(test)]
mod test_profiles;
mod text;

pub use edit::{plan_default, plan_edits, plan_preset};
pub use entry_error::EntryError;
pub use error::{PlanError, TypeMismatch};
pub use image::{Direction, DirectionError, Image, Parameters};
pub use item::{Item, ItemError, ItemValue};
pub use note::ValueChange;
pub use plan::{Base, CamChange, Edge, InterbusPlan, Op, ParameterChange, ProgramChange};
pub use record::{CamNames, InterbusProfile, MountingMark, ProfileIdentity, RecordedValues, UnknownEntries};
pub use restore::{
    DeviceState, Restore, RestoreOptions, check_allowed, check_device, other_type, plan_restore, programs_to_read,
};
pub use scale::{OutsideRangeError, RoundedPosition, Scale, ScaleError, Unit};
pub use table::{
    CamTable, Column, ImportedProgram, LONGEST_NAME, TableEdge, TableNote, TableOptions, TableProblem,
    TableProblemKind, TableRow, emit_table,
};
