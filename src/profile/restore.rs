//! The options and the outcome of restoring a profile, for any kind of device.

/// The options of a restore.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RestoreOptions {
    /// The profile may go onto a device with another serial number.
    pub allow_other_device: bool,
    /// The profile may go onto a device of another type.
    pub allow_other_type: bool,
    /// Values of the mounting may go onto another device.
    pub with_mounting: bool,
}

/// The outcome of planning a restore.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Restore<Plan, Item, Missing = String> {
    /// The operations.
    pub plan: Plan,
    /// Number of values that are already as in the profile, counted as by a comparison.
    pub unchanged: u64,
    /// Items left unchanged because one side does not have them or cannot read them.
    pub missing: Vec<Missing>,
    /// Values of the mounting that differ and are left alone.
    pub mounting_left: Vec<Item>,
    /// Values of another device's mounting that are written: they have to be adjusted again.
    pub mounting_written: Vec<Item>,
}
