//! Whose a module is, and how high it stands: the same for `src/<layer>/<device>` as for `src/devices/<device>/<module>`,
//! so that no rule lapses while the one becomes the other.

const DEVICES: [&str; 5] = ["hiperface", "biss", "ssi", "interbus", "hiperdrive"];
const BUSES: [&str; 3] = ["ubicom", "bridge", "ethernet_ip"];

/// Layers and their floors. A device and a bus have the layers of the core, under names of their own.
const LAYERS: [(&str, u8); 16] = [
    ("units", 1),
    ("bits", 1),
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

/// Folders that are layers under another name: what a device calls them, and what the folder is called now.
const NAMES: [(&str, &str); 6] = [
    ("jobs", "worker"),
    ("state", "app"),
    ("views", "ui"),
    ("commands", "cli"),
    ("device", "procedures"),
    ("signal", "analysis"),
];

/// Whose a module is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    Core,
    Device(String),
    Bus(String),
    Signals,
}

/// Whose a module is, and its layer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) owner: Owner,
    pub(crate) layer: &'static str,
}

impl Place {
    /// Of a path of modules from the root of the crate; `None` where the first is no module of it.
    pub(crate) fn of(path: &[String]) -> Option<Self> {
        let names: Vec<&str> = path.iter().map(String::as_str).collect();
        let place = |owner, layer| Some(Place { owner, layer });
        match names.as_slice() {
            [] => place(Owner::Core, "lib"),
            ["devices" | "buses"] => place(Owner::Core, "lib"),
            ["signals"] => place(Owner::Signals, "lib"),
            ["devices", name] => place(Owner::Device((*name).to_owned()), "kinds"),
            ["devices", name, module, ..] => place(Owner::Device((*name).to_owned()), layer(module).unwrap_or("kinds")),
            ["buses", name] => place(Owner::Bus((*name).to_owned()), "lib"),
            ["buses", name, module, ..] => place(Owner::Bus((*name).to_owned()), layer(module)?),
            ["signals", module, ..] => place(Owner::Signals, layer(module)?),
            ["app", "explain", name, ..] if DEVICES.contains(name) => place(Owner::Device((*name).to_owned()), "app"),
            [first, second, ..] => place(owner_of(second), layer(first)?),
            [first] => place(Owner::Core, layer(first)?),
        }
    }

    pub(crate) fn floor(&self) -> u8 {
        LAYERS.iter().find(|(name, _)| *name == self.layer).unwrap().1
    }
}

/// Of a folder within a layer.
fn owner_of(name: &str) -> Owner {
    match name {
        _ if DEVICES.contains(&name) => Owner::Device(name.to_owned()),
        _ if BUSES.contains(&name) => Owner::Bus(name.to_owned()),
        "signals" => Owner::Signals,
        _ => Owner::Core,
    }
}

fn layer(name: &str) -> Option<&'static str> {
    let name = NAMES.iter().find(|(own, _)| *own == name).map_or(name, |(_, layer)| layer);
    LAYERS.iter().map(|(layer, _)| *layer).find(|layer| *layer == name)
}

/// The modules of a file's path under `src`: `app/hiperface/mod.rs` is `app`, `hiperface`.
pub(crate) fn modules_of(path: &str) -> Vec<String> {
    let mut modules: Vec<String> = path.trim_end_matches(".rs").split('/').map(ToOwned::to_owned).collect();
    if matches!(modules.last().map(String::as_str), Some("mod" | "lib")) {
        modules.pop();
    }
    modules
}

#[test]
fn a_module_is_the_same_before_and_after_it_is_moved() {
    let cases = [
        ("protocol/hiperface/crc.rs", "devices/hiperface/protocol/crc.rs", "protocol"),
        ("profile/biss/mod.rs", "devices/biss/profile/mod.rs", "profile"),
        ("sim/ssi/encoder.rs", "devices/ssi/sim/encoder.rs", "sim"),
        ("device/interbus/master.rs", "devices/interbus/procedures/master.rs", "procedures"),
        ("worker/hiperdrive/motion.rs", "devices/hiperdrive/jobs/motion.rs", "worker"),
        ("app/biss/memory.rs", "devices/biss/state/memory.rs", "app"),
        ("app/explain/biss/write.rs", "devices/biss/state/explain/write.rs", "app"),
        ("ui/ssi/frame.rs", "devices/ssi/views/frame.rs", "ui"),
        ("cli/hiperface/act.rs", "devices/hiperface/commands/act.rs", "cli"),
        ("protocol/ubicom/message.rs", "buses/ubicom/protocol/message.rs", "protocol"),
        ("cli/ethernet_ip/cip.rs", "buses/ethernet_ip/commands/cip.rs", "cli"),
        ("app/signals/live.rs", "signals/state/live.rs", "app"),
    ];
    for (before, after, layer) in cases {
        let places = [before, after].map(|path| Place::of(&modules_of(path)).unwrap());
        assert_eq!(places[0], places[1], "{before}");
        assert!(places[0].owner != Owner::Core && places[0].layer == layer, "{before}: {places:?}");
    }
    assert_eq!(Place::of(&modules_of("worker/commit.rs")).unwrap(), Place { owner: Owner::Core, layer: "worker" });
    assert_eq!(Place::of(&modules_of("nowhere/a.rs")), None);
}
