//! The owner and layer of a module. `src/<layer>` belongs to the core, and `src/devices/<device>/<module>` to a device.

/// All layers with their levels.
const LAYERS: [(&str, u8); 21] = [
    ("units", 1),
    ("bits", 1),
    ("parameter", 1),
    ("drawing", 1),
    ("report", 1),
    ("fonts", 1),
    ("expected", 1),
    ("analysis", 1),
    ("protocol", 2),
    ("profile", 2),
    ("link", 3),
    ("sim", 3),
    ("store", 3),
    ("procedures", 4),
    ("worker", 4),
    ("app", 5),
    ("cli", 5),
    ("ui", 6),
    ("lib", 6),
    ("main", 6),
    ("kinds", 6),
];

/// Layers that the core must not have, because it does not know the bytes or procedures of any device.
const NON_CORE_LAYERS: [&str; 2] = ["protocol", "procedures"];

/// The modules of a device, a bus and Signals, with their layers.
const MODULES: [(&str, &str); 8] = [
    ("protocol", "protocol"),
    ("profile", "profile"),
    ("sim", "sim"),
    ("procedures", "procedures"),
    ("jobs", "worker"),
    ("state", "app"),
    ("views", "ui"),
    ("commands", "cli"),
];

/// The part of the program to which a module belongs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    Core,
    Device(String),
    Bus(String),
    Signals,
}

/// A module's owner and layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) owner: Owner,
    pub(crate) layer: &'static str,
}

impl Place {
    /// Returns the owner and layer for a module path from the crate root, or `None` if its first segment is not a
    /// module.
    pub(crate) fn of(path: &[String]) -> Option<Self> {
        let names: Vec<&str> = path.iter().map(String::as_str).collect();
        let place = |owner, layer| Some(Place { owner, layer });
        match names.as_slice() {
            [] => place(Owner::Core, "lib"),
            ["devices" | "buses"] => place(Owner::Core, "lib"),
            ["signals"] => place(Owner::Signals, "lib"),
            ["devices", name] => place(Owner::Device((*name).to_owned()), "kinds"),
            // Anything that is not a module of a device is a type that `mod.rs` re-exports.
            ["devices", name, module, ..] => {
                place(Owner::Device((*name).to_owned()), module_layer(module).unwrap_or("kinds"))
            }
            ["buses", name] => place(Owner::Bus((*name).to_owned()), "lib"),
            ["buses", name, module, ..] => place(Owner::Bus((*name).to_owned()), module_layer(module)?),
            ["signals", module, ..] => place(Owner::Signals, module_layer(module)?),
            [first, ..] => place(Owner::Core, core_layer(first)?),
        }
    }

    pub(crate) fn floor(&self) -> u8 {
        LAYERS.iter().find(|(name, _)| *name == self.layer).unwrap().1
    }
}

fn core_layer(name: &str) -> Option<&'static str> {
    let layer = LAYERS.iter().map(|(layer, _)| *layer).find(|layer| *layer == name)?;
    (!NON_CORE_LAYERS.contains(&layer)).then_some(layer)
}

fn module_layer(name: &str) -> Option<&'static str> {
    MODULES.iter().find(|(module, _)| *module == name).map(|(_, layer)| *layer)
}

/// Returns the module path for a file path in `src`: `app`, `hiperface` for `app/hiperface/mod.rs`.
pub(crate) fn module_path_segments(path: &str) -> Vec<String> {
    let mut modules: Vec<String> = path.trim_end_matches(".rs").split('/').map(ToOwned::to_owned).collect();
    if matches!(modules.last().map(String::as_str), Some("mod" | "lib")) {
        modules.pop();
    }
    modules
}

#[test]
fn module_has_one_owner_and_layer() {
    let place = |path| Place::of(&module_path_segments(path));
    let device = |name: &str, layer| Some(Place { owner: Owner::Device(name.to_owned()), layer });
    let bus = |name: &str, layer| Some(Place { owner: Owner::Bus(name.to_owned()), layer });
    let core = |layer| Some(Place { owner: Owner::Core, layer });
    let cases = [
        ("devices/hiperface/protocol/crc.rs", device("hiperface", "protocol")),
        ("devices/biss/profile/mod.rs", device("biss", "profile")),
        ("devices/ssi/sim/encoder.rs", device("ssi", "sim")),
        ("devices/interbus/procedures/master.rs", device("interbus", "procedures")),
        ("devices/hiperdrive/jobs/motion.rs", device("hiperdrive", "worker")),
        ("devices/biss/state/explain/write.rs", device("biss", "app")),
        ("devices/ssi/views/frame.rs", device("ssi", "ui")),
        ("devices/hiperface/commands/act.rs", device("hiperface", "cli")),
        ("devices/hiperface/mod.rs", device("hiperface", "kinds")),
        ("buses/ubicom/protocol/message.rs", bus("ubicom", "protocol")),
        ("buses/ethernet_ip/commands/cip.rs", bus("ethernet_ip", "cli")),
        ("signals/state/live.rs", Some(Place { owner: Owner::Signals, layer: "app" })),
        ("worker/commit.rs", core("worker")),
        ("link/line/echo.rs", core("link")),
        ("analysis/check.rs", core("analysis")),
        // Protocols and procedures belong to a device or a bus. A folder without a layer has no place.
        ("protocol/hiperface/crc.rs", None),
        ("procedures/echo.rs", None),
        ("device/line.rs", None),
        ("nowhere/a.rs", None),
        ("buses/bridge/worker/a.rs", None),
        ("signals/app/a.rs", None),
    ];
    for (path, expected) in cases {
        assert_eq!(place(path), expected, "{path}");
    }
}
