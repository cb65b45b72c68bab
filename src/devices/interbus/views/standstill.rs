//! The bar for confirming that the machine is at standstill. Confirmation is required before its encoder may be
//! disturbed.

use egui::{RichText, Ui};

use crate::app::{Action, DeviceCommand};
use crate::devices::interbus::state::{Encoder, InterbusAction as Interbus};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{enabled_button, paragraph};
use crate::ui::{Theme, icons};

pub(super) fn bar_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    if !encoder.needs_standstill_confirmation() {
        return;
    }
    let id = encoder.session.id;
    let mut stopped = encoder.is_stopped();
    theme.sunken_frame().show(ui, |ui| {
        ui.set_width(ui.available_width().max(0.0));
        ui.horizontal_wrapped(|ui| {
            let ink = if stopped { theme.palette.good } else { theme.palette.warn };
            ui.label(RichText::new(if stopped { icons::CHECK_CIRCLE } else { icons::WARNING }).color(ink));
            if ui.checkbox(&mut stopped, translate(theme, "ib_stop.stands")).changed() {
                actions.push(Action::device(id, Interbus::ConfirmStandstill(stopped)));
            }
            if encoder.survey.is_none() {
                let ready = encoder.is_stopped() && encoder.session.is_ready();
                let word = translate(theme, "ib_stop.read");
                if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &word).clicked() {
                    actions.push(Action::Command(id, DeviceCommand::Read));
                }
            }
        });
        paragraph(ui, theme.caption(translate(theme, "ib_stop.words")));
    });
    theme.add_gap(ui);
}
