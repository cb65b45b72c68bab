//! Files that still know a device or a bus which they ought not to know. The lists get shorter, never longer.

/// Outside a device, or in another one.
pub(crate) const KNOWS_A_DEVICE: &[&str] = &[
    "src/app/action.rs",
    "src/app/connect/mod.rs",
    "src/app/devices.rs",
    "src/app/documents.rs",
    "src/app/opening.rs",
    "src/app/question.rs",
    "src/app/services.rs",
    "src/app/studio.rs",
    "src/app/tab.rs",
    "src/sim/at_adapter.rs",
];

/// A bus, or the Signals tab, outside of them and of the devices on them.
pub(crate) const KNOWS_A_BUS: &[&str] =
    &["src/app/action.rs", "src/app/files.rs", "src/app/studio.rs", "src/sim/at_adapter.rs"];
