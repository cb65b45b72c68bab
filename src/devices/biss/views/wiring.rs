//! The wiring card, which shows the connector pins, the supply and the clock of the kit encoder.

use egui::Ui;

use crate::devices::biss::state::TEXTS;
use crate::devices::biss::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{folding_card, paragraph, two_columns};
use crate::ui::wiring::wires_ui;

const PIN_WIDTH: f32 = 84.0;

/// Pins of the JST BM08B-GHS connector and their signals (manual 2).
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

const NOTES: [&str; 3] = ["biss_wiring.line", "biss_wiring.speed", "biss_wiring.others"];

/// Card width in points from which the pins are shown in two columns.
const MIN_TWO_COLUMN_WIDTH: f32 = 640.0;

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme) {
    folding_card(ui, theme, "wiring.title", |ui| {
        if ui.available_width() < MIN_TWO_COLUMN_WIDTH {
            wires_ui(ui, theme, &TEXTS, PIN_WIDTH, &PINS);
        } else {
            let (left, right) = PINS.split_at(PINS.len() / 2);
            two_columns(
                ui,
                theme,
                (),
                |ui, ()| wires_ui(ui, theme, &TEXTS, PIN_WIDTH, left),
                |ui, ()| wires_ui(ui, theme, &TEXTS, PIN_WIDTH, right),
            );
        }
        ui.add_space(theme.space.inside);
        for note in NOTES {
            paragraph(ui, theme.caption(translate(theme, note)));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::{NOTES, PINS};
    use crate::devices::biss::state::TEXTS;
    use crate::ui::wiring::{assert_notes, assert_wires};

    /// Compares the card with the kit encoder's manual: tables 1 (pins), 2 (supply) and 14 (preset), and sections 2.1
    /// (connector) and 2.3 (point to point, RS-422). UBICOM uses 115200 baud (issue 22.23).
    #[test]
    fn wiring_card_matches_manual() {
        assert_wires(
            &TEXTS,
            &PINS,
            &[
                ("1 GND", &["ground"]),
                ("2 PRESET", &["3.3 V…VCC", "at least 100 ms", "01B, 03B"]),
                ("3 CONFIG", &["UBICOM", "115200"]),
                ("4 SLO+", &["data from the encoder", "RS-422"]),
                ("5 SLO−", &["data from the encoder", "RS-422"]),
                ("6 MA−", &["clock to the encoder", "RS-422"]),
                ("7 MA+", &["clock to the encoder", "RS-422"]),
                ("8 VCC", &["4.75…12.5 V (00B)", "15 V (01B, 03B)"]),
            ],
        );
        assert_notes(&TEXTS, &NOTES, &["BM08B-GHS", "Point-to-point"]);
    }
}
