//! The card for the motor of a virtual encoder.

use egui::{Button, Ui};

use super::Theme;
use super::controls::{card, name, paragraph};

/// Selectable speeds in revolutions per minute.
const SPEEDS: [f64; 5] = [-60.0, -6.0, 0.0, 6.0, 60.0];

/// Draws the motor card. `turn` receives the requested speed in revolutions per minute.
pub(crate) fn card_ui(ui: &mut Ui, theme: &Theme, now: f64, mut turn: impl FnMut(f64)) {
    card(ui, theme, "motor_card.title", |ui| {
        paragraph(ui, theme.caption(theme.translate("motor_card.words")));
        ui.horizontal_wrapped(|ui| {
            for rpm in SPEEDS {
                let is_own = (now - rpm).abs() < 1e-9;
                let word = if rpm == 0.0 { theme.translate("motor_card.rest") } else { format!("{rpm:+.0}") };
                let response = ui.add(Button::selectable(is_own, &word));
                if name(response, true, &word).clicked() {
                    turn(rpm);
                }
            }
        });
    });
}
