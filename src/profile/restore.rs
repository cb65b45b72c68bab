//! What restoring a profile may do, and what it would do, whatever the kind of device.

/// What a restore may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RestoreOptions {
    /// The profile may go onto a device with another serial number.
    pub allow_other_device: bool,
    /// The profile may go onto a device of another type.
    pub allow_other_type: bool,
    /// Values of the mounting may go onto another device.
    pub with_mounting: bool,
}

/// What a restore would do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Restore<Plan, Item, Missing = String> {
    /// The operations.
    pub plan: Plan,
    /// Things that are already as the profile says, counted as a comparison counts them.
    pub unchanged: u64,
    /// What is left alone because one side does not have it, or cannot read it.
    pub missing: Vec<Missing>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<Item>,
    /// Values of the mounting of another device that are written: they have to be set up anew.
    pub mounting_written: Vec<Item>,
}
