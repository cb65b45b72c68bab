//! The motor control of the virtual encoder, which appears on every page that needs it.

use egui::{RichText, Ui};

use crate::app::Action;
use crate::devices::biss::state::{BissAction as Biss, Encoder, TEXTS};
use crate::devices::biss::views::translate;
use crate::sim::Motor;
use crate::ui::controls::{enabled_button, folding_card, paragraph};
use crate::ui::{Theme, icons};

/// Speeds offered in rpm: standstill and the speeds required by the procedures.
const SPEEDS: [f64; 5] = [-1000.0, -500.0, 0.0, 500.0, 1000.0];

pub(super) fn card_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, motor: &Motor, actions: &mut Vec<Action>) {
    folding_card(ui, theme, "motor_card.title", |ui| {
        paragraph(ui, theme.caption(theme.translate("motor_card.words")));
        ui.horizontal_wrapped(|ui| {
            for rpm in SPEEDS {
                let word = if rpm == 0.0 { theme.translate("motor_card.rest") } else { format!("{rpm:+.0}") };
                if ui.add(egui::Button::selectable(motor.rpm() == rpm, word)).clicked() {
                    actions.push(Action::device(encoder.session.id, Biss::Turn(rpm)));
                }
            }
        });
    });
}

/// Draws a note with a stop button while the virtual motor is turning. A real motor can only be stopped by its
/// operator.
pub(super) fn motor_running_note_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let Some(motor) = &encoder.motor else { return };
    if motor.rpm() == 0.0 {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        let id = if motor.rpm() > 0.0 { "motor_card.turns_cw" } else { "motor_card.turns_ccw" };
        let text = TEXTS.text(id).with_number("rpm", motor.rpm().abs(), 0);
        ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
        ui.label(theme.format_text(&text));
        if enabled_button(ui, true, icons::STOP, &translate(theme, "motor_card.stop")).clicked() {
            actions.push(Action::device(encoder.session.id, Biss::Turn(0.0)));
        }
    });
}
