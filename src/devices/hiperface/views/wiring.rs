//! The wiring card: the eight wires with their signals, and the line termination. Pins and wire colours differ between
//! encoder types and are given in the data sheet.

use egui::Ui;

use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{folding_card, paragraph};
use crate::ui::wiring::wires_ui;

const WIRE_WIDTH: f32 = 56.0;

/// Wire names in the manual, each with its signal.
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

const NOTES: [&str; 4] = ["wiring.termination", "wiring.bus", "wiring.screen", "wiring.pins"];

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme) {
    folding_card(ui, theme, "wiring.title", |ui| {
        wires_ui(ui, theme, &TEXTS, WIRE_WIDTH, &WIRES);
        ui.add_space(theme.space.inside);
        for note in NOTES {
            paragraph(ui, theme.caption(translate(theme, note)));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::{NOTES, WIRES};
    use crate::devices::hiperface::state::TEXTS;
    use crate::ui::wiring::{assert_notes, assert_wires};

    /// The expected values are from the HIPERFACE manual: "Hardware im Regler" (eight lines, 7 to 12 V, typically 8 V,
    /// overall screen, twisted pairs), figure 11 (at most 250 mA, 1 Vpp, RS-485) and figure 15 (built-in resistors of
    /// 130 Ω and 1 kΩ; in the bus version, at most eight encoders without 130 Ω, and a terminator at the encoder
    /// farthest from the master; issue 22.23).
    #[test]
    fn wiring_card_matches_manual() {
        assert_wires(
            &TEXTS,
            &WIRES,
            &[
                ("US", &["7…12 V", "typically 8 V", "at most 250 mA"]),
                ("GND", &["ground"]),
                ("SIN", &["sine, 1 Vpp"]),
                ("REFSIN", &["sine reference"]),
                ("COS", &["cosine, 1 Vpp"]),
                ("REFCOS", &["cosine reference"]),
                ("DATA +", &["RS-485"]),
                ("DATA −", &["RS-485"]),
            ],
        );
        assert_notes(&TEXTS, &NOTES, &["130 Ω terminating resistor and 1 kΩ pull-up and pull-down resistors"]);
        assert_notes(
            &TEXTS,
            &NOTES,
            &["BUS version (up to 8 encoders): the encoders contain no 130 Ω resistor", "farthest from the controller"],
        );
        assert_notes(&TEXTS, &NOTES, &["overall screen and four twisted pairs"]);
    }
}
