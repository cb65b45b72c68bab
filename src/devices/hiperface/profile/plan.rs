//! Operations that change an encoder's memory, and the values on which they are based.

use super::item::PlanItem;
use super::{FieldImage, FieldRange, Item};
use crate::bits::hex_compact;
use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, DataFieldStatus, DeviceAddress, LineSettings};
use crate::profile::{ChangedItem, Operation, Plan};

/// Planned write to a HIPERFACE encoder.
pub type HiperfacePlan = Plan<Base, Op>;

/// Values in the encoder on which a plan is based.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Number of data fields.
    pub field_count: u8,
    /// The affected fields.
    pub fields: Vec<FieldImage>,
    /// The affected single values.
    pub scalars: Vec<SingleValue>,
}

/// A single value stored in an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SingleValue {
    /// Position in steps, with the shaft at rest.
    Position(u32),
    /// Value of the counter.
    Counter(u32),
    /// Address.
    Address(u8),
    /// Stored interface settings.
    Settings(LineSettings),
}

/// A single persistent write.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Creates, changes or deletes a field with command 4Dh. If bit E of the new status is 0, the field is deleted.
    Define {
        /// Field number.
        field: u8,
        /// Current status, or `None` if the field does not exist yet.
        from: Option<DataFieldStatus>,
        /// New status.
        to: DataFieldStatus,
    },
    /// Writes bytes to a field with command 4Bh.
    Store {
        /// Field number.
        field: u8,
        /// Index of the first byte.
        address: u8,
        /// Status of the field at the time of the write. It contains the number of the access code.
        status: DataFieldStatus,
        /// Previous bytes, or `None` if they are unknown or the field does not exist yet.
        old: Option<Vec<u8>>,
        /// New bytes, 1 to 128.
        new: Vec<u8>,
    },
    /// Changes an access code with command 4Fh.
    ChangeCode {
        /// Number of the access code.
        number: AccessCodeNumber,
        /// Present code.
        old: AccessCode,
        /// New code.
        new: AccessCode,
    },
    /// Sets the position with command 43h, or 63h if `synchronise` is set.
    SetPosition {
        /// Position before the change, at the current shaft angle.
        from: u32,
        /// New position.
        to: u32,
        /// Whether to align the code tracks as well.
        synchronise: bool,
    },
    /// Sets the address with command 55h.
    SetAddress {
        /// Current address.
        from: u8,
        /// New address.
        to: DeviceAddress,
    },
    /// Stores interface settings with command 57h.
    Configure {
        /// Stored settings.
        from: LineSettings,
        /// New settings, which take effect after the next restart.
        to: LineSettings,
    },
    /// Clears the counter with command 49h.
    ClearCounter {
        /// Present count.
        from: u32,
    },
    /// Increments the counter with command 47h.
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
    /// Returns the item that the operation changes. The `read` command accepts its name if the item is readable.
    pub fn plan_item(&self) -> PlanItem {
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

    /// Returns the changed item with its old and new value, for the logbook. Field statuses and line settings are
    /// recorded as bytes, and access codes without any value.
    pub fn changed_item(&self) -> ChangedItem {
        let byte = |byte: u8| Some(format!("{byte:02X}"));
        let number = |number: u32| Some(number.to_string());
        let (old, new) = match self {
            Op::Define { from, to, .. } => (from.and_then(|from| byte(from.byte())), byte(to.byte())),
            Op::Store { old, new, .. } => (old.as_deref().map(hex_compact), Some(hex_compact(new))),
            Op::ChangeCode { .. } => (None, None),
            Op::SetPosition { from, to, .. } => (number(*from), number(*to)),
            Op::SetAddress { from, to } => (byte(*from), byte(to.byte())),
            Op::Configure { from, to } => (byte(from.byte()), byte(to.byte())),
            Op::ClearCounter { from } => (number(*from), number(0)),
            Op::IncrementCounter { from } => (number(*from), number(from.saturating_add(1))),
        };
        ChangedItem::new(self.plan_item(), old, new)
    }

    /// Returns the number of changes as a comparison would count them: each byte of a data field is one change.
    pub fn change_count(&self) -> u64 {
        match self {
            Op::Store { new, .. } => new.len() as u64,
            _ => 1,
        }
    }

    /// Returns whether the operation makes a protected field writable. If so, the operation that restores the
    /// protection must run even if an operation in between fails.
    pub fn removes_protection(&self) -> bool {
        matches!(self, Op::Define { from, to, .. }
            if to.exists() && to.is_writable() && from.is_none_or(|from| !from.is_writable()))
    }

    /// Returns whether the operation write-protects the given field.
    pub fn locks_field(&self, number: u8) -> bool {
        matches!(self, Op::Define { field, to, .. } if *field == number && to.exists() && !to.is_writable())
    }

    /// Returns the number of the data field, or `None` if the operation does not concern a field.
    pub fn field(&self) -> Option<u8> {
        match self {
            Op::Define { field, .. } | Op::Store { field, .. } => Some(*field),
            _ => None,
        }
    }
}
