//! Operations that change the memory of an encoder, and the values on which they are based.

use super::item::PlanItem;
use super::{FieldImage, FieldRange, Item};
use crate::devices::hiperface::protocol::{AccessCode, CodeNumber, DataFieldStatus, DeviceAddress, LineSettings};
use crate::profile::{Operation, Plan};

/// A planned write to a HIPERFACE encoder.
pub type HiperfacePlan = Plan<Base, Op>;

/// The values on which a plan is based.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Number of data fields.
    pub field_count: u8,
    /// The affected fields.
    pub fields: Vec<FieldImage>,
    /// The affected single values.
    pub scalars: Vec<Scalar>,
}

/// A single value of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scalar {
    /// Position in steps, with the shaft at rest.
    Position(u32),
    /// Counter.
    Counter(u32),
    /// Address.
    Address(u8),
    /// Stored interface settings.
    Settings(LineSettings),
}

/// A single persistent write.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// 4Dh: creates a field (no status before), changes it, or deletes it (E = 0 after).
    Define {
        /// Field number.
        field: u8,
        /// Present status, or `None` if the field does not exist yet.
        from: Option<DataFieldStatus>,
        /// New status.
        to: DataFieldStatus,
    },
    /// 4Bh: writes bytes.
    Store {
        /// Field number.
        field: u8,
        /// Index of the first byte.
        address: u8,
        /// Status of the field at that time, which contains the number of the access code.
        status: DataFieldStatus,
        /// Old bytes, or `None` if unknown or if the field has yet to be created.
        old: Option<Vec<u8>>,
        /// New bytes, 1…128.
        new: Vec<u8>,
    },
    /// 4Fh: changes an access code.
    ChangeCode {
        /// Number of the access code.
        number: CodeNumber,
        /// Present code.
        old: AccessCode,
        /// New code.
        new: AccessCode,
    },
    /// 43h, or 63h with `synchronise`: sets the position.
    SetPosition {
        /// Position at the present shaft angle.
        from: u32,
        /// New position.
        to: u32,
        /// Whether to align the code tracks as well.
        synchronise: bool,
    },
    /// 55h: sets the address.
    SetAddress {
        /// Present address.
        from: u8,
        /// New address.
        to: DeviceAddress,
    },
    /// 57h: configures the interface.
    Configure {
        /// Stored settings.
        from: LineSettings,
        /// New settings, which apply after the next restart.
        to: LineSettings,
    },
    /// 49h: clears the counter.
    ClearCounter {
        /// Present count.
        from: u32,
    },
    /// 47h: increments the counter.
    IncrementCounter {
        /// Present count.
        from: u32,
    },
}

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        1
    }
}

impl Op {
    /// Returns the name of the changed item, as accepted by `read` if the item is readable.
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

    /// Returns the number of changes, counted as in a comparison: the bytes of a field, or one.
    pub fn weight(&self) -> u64 {
        match self {
            Op::Store { new, .. } => new.len() as u64,
            _ => 1,
        }
    }

    /// Returns whether the operation makes a protected field writable. The operation that protects the field again must
    /// then be carried out whatever happens in between.
    pub fn is_unlock(&self) -> bool {
        matches!(self, Op::Define { from, to, .. }
            if to.exists() && to.is_writable() && from.is_none_or(|from| !from.is_writable()))
    }

    /// Returns whether the operation protects the given field.
    pub fn locks(&self, number: u8) -> bool {
        matches!(self, Op::Define { field, to, .. } if *field == number && to.exists() && !to.is_writable())
    }

    /// Returns the affected field.
    pub fn field(&self) -> Option<u8> {
        match self {
            Op::Define { field, .. } | Op::Store { field, .. } => Some(*field),
            _ => None,
        }
    }
}
