//! The operations that change an encoder's memory, and their base.

use super::item::PlanItem;
use super::{FieldImage, FieldRange, Item};
use crate::devices::hiperface::protocol::{AccessCode, CodeNumber, DataFieldStatus, DeviceAddress, LineSettings};
use crate::profile::{Operation, Plan};

/// A planned write to a HIPERFACE encoder.
pub type HiperfacePlan = Plan<Base, Op>;

/// The values that a plan is based on.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Number of data fields.
    pub field_count: u8,
    /// The fields that the plan touches.
    pub fields: Vec<FieldImage>,
    /// The single values that the plan touches.
    pub scalars: Vec<Scalar>,
}

/// A single value of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scalar {
    /// Position in steps, with the shaft at rest.
    Position(u32),
    /// The counter.
    Counter(u32),
    /// The address.
    Address(u8),
    /// Stored interface settings.
    Settings(LineSettings),
}

/// One persistent write.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// 4Dh: creates a field (no status before), changes one, or deletes one (E = 0 after).
    Define {
        /// The field.
        field: u8,
        /// Present status; `None` if the field does not exist yet.
        from: Option<DataFieldStatus>,
        /// New status.
        to: DataFieldStatus,
    },
    /// 4Bh: writes bytes.
    Store {
        /// The field.
        field: u8,
        /// First byte.
        address: u8,
        /// Status of the field at that time: it contains the number of the access code.
        status: DataFieldStatus,
        /// The old bytes; `None` if not known, in a field that is yet to be created.
        old: Option<Vec<u8>>,
        /// The new bytes, 1…128.
        new: Vec<u8>,
    },
    /// 4Fh: changes an access code.
    ChangeCode {
        /// The access code.
        number: CodeNumber,
        /// Present value.
        old: AccessCode,
        /// New value.
        new: AccessCode,
    },
    /// 43h, or 63h with `synchronise`.
    SetPosition {
        /// The position at the shaft's present place.
        from: u32,
        /// The new value.
        to: u32,
        /// Align the code tracks as well.
        synchronise: bool,
    },
    /// 55h.
    SetAddress {
        /// Now.
        from: u8,
        /// New address.
        to: DeviceAddress,
    },
    /// 57h.
    Configure {
        /// Stored now.
        from: LineSettings,
        /// New settings, used after the next restart.
        to: LineSettings,
    },
    /// 49h.
    ClearCounter {
        /// The counter now.
        from: u32,
    },
    /// 47h.
    IncrementCounter {
        /// The counter now.
        from: u32,
    },
}

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        1
    }
}

impl Op {
    /// Returns the name of the changed item, as `read` takes it if it can be read.
    pub fn item(&self) -> PlanItem {
        PlanItem::Item(match self {
            Op::Define { field, .. } => Item::Status(*field),
            Op::Store { field, address, new, .. } => {
                Item::Field(FieldRange::new(*field, usize::from(*address), new.len()))
            }
            Op::ChangeCode { number, .. } => return PlanItem::Code(*number),
            Op::SetPosition { .. } => return PlanItem::Position,
            Op::SetAddress { .. } => Item::Address,
            Op::Configure { .. } => Item::Settings,
            Op::ClearCounter { .. } | Op::IncrementCounter { .. } => Item::Counter,
        })
    }

    /// Returns the number of changes as a comparison counts them: bytes of a field, or one.
    pub fn weight(&self) -> u64 {
        match self {
            Op::Store { new, .. } => new.len() as u64,
            _ => 1,
        }
    }

    /// Returns whether it leaves a field writable that was not: an operation that protects it again must then be carried
    /// out whatever happens in between.
    pub fn unlocks(&self) -> bool {
        matches!(self, Op::Define { from, to, .. }
            if to.exists() && to.is_writable() && from.is_none_or(|from| !from.is_writable()))
    }

    /// Returns whether it protects this field.
    pub fn locks(&self, number: u8) -> bool {
        matches!(self, Op::Define { field, to, .. } if *field == number && to.exists() && !to.is_writable())
    }

    /// Returns the field it touches.
    pub fn field(&self) -> Option<u8> {
        match self {
            Op::Define { field, .. } | Op::Store { field, .. } => Some(*field),
            _ => None,
        }
    }
}
