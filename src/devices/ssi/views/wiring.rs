//! The wiring card: SSI wires, supply, cable, and the other outputs of the family.

use egui::Ui;

use crate::devices::ssi::protocol::{Family, Signal};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain;
use crate::devices::ssi::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{folding_card, paragraph, row};
use crate::ui::wiring::wires_ui;

const WIRE_WIDTH: f32 = 84.0;

/// Names of the wires with the ids of their descriptions. See SICK SSI description 2.1 and 2.2.
const WIRES: [(&str, &str); 6] = [
    ("CLOCK+", "ssi_wiring.clock_plus"),
    ("CLOCK−", "ssi_wiring.clock_minus"),
    ("DATA+", "ssi_wiring.data_plus"),
    ("DATA−", "ssi_wiring.data_minus"),
    ("US", "ssi_wiring.supply"),
    ("GND", "ssi_wiring.ground"),
];

const NOTES: [&str; 3] = ["ssi_wiring.line", "ssi_wiring.cable", "ssi_wiring.adapter"];

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, family: Option<&Family>) {
    folding_card(ui, theme, "wiring.title", |ui| {
        wires_ui(ui, theme, &TEXTS, WIRE_WIDTH, &WIRES);
        ui.add_space(theme.space.inside);
        for note in NOTES {
            paragraph(ui, theme.caption(translate(theme, note)));
        }
        let Some(family) = family else { return };
        if !family.signals.is_empty() {
            ui.add_space(theme.space.between);
            ui.label(theme.heading(translate(theme, "ssi_wiring.signals")));
            for signal in &family.signals {
                row(ui, theme, &signal.name, limits(theme, signal));
            }
        }
        if !family.notes.is_empty() {
            ui.add_space(theme.space.between);
            ui.label(theme.heading(&family.name));
            for note in &family.notes {
                paragraph(ui, theme.caption(theme.format_text(&explain::note_text(family, note))));
            }
            paragraph(ui, theme.caption(theme.format_text(&explain::note_text(family, &family.source))));
        }
    });
}

fn limits(theme: &Theme, signal: &Signal) -> String {
    let volts = |(least, most): (f64, f64)| {
        if (most - least).abs() < 1e-9 {
            theme.format_number(most, 2)
        } else {
            format!("{} … {}", theme.format_number(least, 2), theme.format_number(most, 2))
        }
    };
    let parts = [
        signal
            .amplitude_volts
            .map(|own| theme.format_text(&TEXTS.text("ssi_wiring.volts_pp").with("volts", volts(own)))),
        signal.offset_volts.map(|own| format!("{} {} V", translate(theme, "ssi_wiring.offset"), volts(own))),
        signal.supply_volts.map(|own| format!("{} {} V", translate(theme, "ssi_wiring.at"), volts(own))),
    ];
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() { "–".to_owned() } else { parts.join(" · ") }
}

#[cfg(test)]
mod tests {
    use super::{NOTES, WIRES};
    use crate::devices::ssi::state::TEXTS;
    use crate::ui::wiring::{assert_notes, assert_wires};

    /// The card matches SICK SSI description 2.1 (four lines, RS-422 or RS-485, twisted and shielded pairs), 2.7 (cable
    /// lengths and clock frequencies), figure 2 and reference section 1 (the plus wires of clock and data idle high,
    /// and the minus wires idle low; issue 22.23).
    #[test]
    fn wiring_card_matches_manual() {
        assert_wires(
            &TEXTS,
            &WIRES,
            &[
                ("CLOCK+", &["from the host", "RS-422", "high when idle"]),
                ("CLOCK−", &["from the host", "RS-422", "low when idle"]),
                ("DATA+", &["to the host", "RS-422", "high when idle"]),
                ("DATA−", &["to the host", "RS-422", "low when idle"]),
                ("US", &["type label"]),
                ("GND", &["0 V"]),
            ],
        );
        let lengths = ["400 kHz below 50 m", "300 kHz below 100 m", "200 kHz below 200 m", "100 kHz below 400 m"];
        assert_notes(&TEXTS, &NOTES, &["twist", "screen"]);
        assert_notes(&TEXTS, &NOTES, &lengths);
    }
}
