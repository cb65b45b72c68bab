//! The wiring card: the eight wires, what is on them, and how the line is terminated. Pins and wire colours differ from
//! type to type and stand in the data sheet.

use egui::Ui;

use crate::ui::Skin;
use crate::ui::controls::{card, paragraph};

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
        for (wire, words) in WIRES {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().interact_size.y = 18.0;
                let name = ui.label(skin.mono(wire));
                ui.add_space((WIRE - name.rect.width()).max(0.0));
                paragraph(ui, skin.label(skin.say(words)));
            });
        }
        ui.add_space(skin.space.inside);
        for note in ["wiring.termination", "wiring.bus", "wiring.screen", "wiring.pins"] {
            paragraph(ui, skin.caption(skin.say(note)));
        }
    });
}
