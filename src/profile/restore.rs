//! Options for restoring a profile, and the result of planning it, for any kind of device.

/// Options for restoring a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RestoreOptions {
    /// Whether the profile may be written to a device with another serial number.
    pub allow_other_device: bool,
    /// Whether the profile may be written to a device of another type.
    pub allow_other_type: bool,
    /// Whether mounting-specific values may be written to another device.
    pub with_mounting: bool,
}

/// The result of planning a restore.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Restore<Plan, Item, Missing = String> {
    /// Planned operations.
    pub plan: Plan,
    /// Number of values that already match the profile, counted as in a comparison.
    pub unchanged: u64,
    /// Items that stay unchanged because they are missing or unreadable on one side.
    pub missing: Vec<Missing>,
    /// Mounting-specific items that differ but are left unchanged.
    pub mounting_left: Vec<Item>,
    /// Mounting-specific items that are copied from another device and must be readjusted.
    pub mounting_written: Vec<Item>,
}
