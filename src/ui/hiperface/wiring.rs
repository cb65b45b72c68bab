//! The wiring card: the eight wires, what is on them, and how the line is terminated. Pins and wire colours differ from
//! type to type and stand in the data sheet.

use egui::Ui;

use crate::ui::Skin;
use crate::ui::controls::{card, paragraph};
use crate::ui::wires::wires_ui;

/// Width of the column of names.
const WIRE: f32 = 56.0;

/// A wire's name in the manual, and what is on it.
const WIRES: [(&str, &str); 8] = [
    ("US", "wiring.supply"),
    ("GND", "wiring.ground"),
    ("SIN", "wiring.sine"),
    ("REFSIN", "wiring.reference_sine"),
    ("COS", "wiring.cosine"),
    ("REFCOS", "wiring.reference_cosine"),
    ("DATA +", "wiring.data"),
    ("DATA −", "wiring.data"),
];

pub(super) fn card_ui(ui: &mut Ui, skin: &Skin) {
    card(ui, skin, "wiring.title", |ui| {
        wires_ui(ui, skin, WIRE, &WIRES);
        ui.add_space(skin.space.inside);
        for note in ["wiring.termination", "wiring.bus", "wiring.screen", "wiring.pins"] {
            paragraph(ui, skin.caption(skin.say(note)));
        }
    });
}
