//! The wiring card: the pins of the kit encoder's connector, its supply and the clock.

use egui::Ui;

use crate::ui::Skin;
use crate::ui::controls::{card, paragraph, two_columns};
use crate::ui::wires::wires_ui;

/// Width of the column of pins.
const PIN: f32 = 84.0;

/// A pin of the JST BM08B-GHS, and what is on it (manual 2).
const PINS: [(&str, &str); 8] = [
    ("1 GND", "biss_wiring.ground"),
    ("2 PRESET", "biss_wiring.preset"),
    ("3 CONFIG", "biss_wiring.config"),
    ("4 SLO+", "biss_wiring.data"),
    ("5 SLO−", "biss_wiring.data"),
    ("6 MA−", "biss_wiring.clock"),
    ("7 MA+", "biss_wiring.clock"),
    ("8 VCC", "biss_wiring.supply"),
];

/// Width of the card from which the pins stand in two columns.
const BESIDE: f32 = 640.0;

pub(super) fn card_ui(ui: &mut Ui, skin: &Skin) {
    card(ui, skin, "wiring.title", |ui| {
        if ui.available_width() < BESIDE {
            wires_ui(ui, skin, PIN, &PINS);
        } else {
            let (left, right) = PINS.split_at(PINS.len() / 2);
            two_columns(ui, skin, (), |ui, ()| wires_ui(ui, skin, PIN, left), |ui, ()| wires_ui(ui, skin, PIN, right));
        }
        ui.add_space(skin.space.inside);
        for note in ["biss_wiring.line", "biss_wiring.speed", "biss_wiring.others"] {
            paragraph(ui, skin.caption(skin.say(note)));
        }
    });
}
