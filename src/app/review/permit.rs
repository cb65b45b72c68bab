//! Permissions that the user can grant for a write.

use crate::profile::RestoreOptions;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Permit {
    OtherDevice,
    TypeMismatch,
    Mounting,
    /// Permission to delete and re-create data fields.
    Recreate,
    /// Permission to copy the bytes of this data field to another device, although their meaning is unknown.
    Copy(u8),
}

/// A permission that changes the plan, with the user's current choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PermitToggle {
    pub permit: Permit,
    pub is_on: bool,
}

impl Permit {
    /// All permissions in display order, except those for single data fields.
    pub(super) const ALL: [Permit; 4] = [Permit::OtherDevice, Permit::TypeMismatch, Permit::Mounting, Permit::Recreate];

    pub const fn keyword(self) -> &'static str {
        match self {
            Permit::OtherDevice => "review.allow_other",
            Permit::TypeMismatch => "review.allow_other_type",
            Permit::Mounting => "review.with_mounting",
            Permit::Recreate => "review.recreate",
            Permit::Copy(_) => "review.copy_field",
        }
    }

    pub const fn hint_id(self) -> Option<&'static str> {
        match self {
            Permit::OtherDevice | Permit::Copy(_) => None,
            Permit::TypeMismatch => Some("review.allow_other_type_hint"),
            Permit::Mounting => Some("review.with_mounting_hint"),
            Permit::Recreate => Some("review.recreate_hint"),
        }
    }

    /// Returns the restore option that grants this permission, if there is one for all kinds of devices.
    pub fn restore_option(self, options: &mut RestoreOptions) -> Option<&mut bool> {
        match self {
            Permit::OtherDevice => Some(&mut options.allow_other_device),
            Permit::TypeMismatch => Some(&mut options.allow_other_type),
            Permit::Mounting => Some(&mut options.with_mounting),
            Permit::Recreate | Permit::Copy(_) => None,
        }
    }
}
