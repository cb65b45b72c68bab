//! The diagnosis page: error buffer with causes and remedies, control and status words, and the cyclic connection.

use egui::{RichText, Ui};

use super::figures;
use crate::app::Action;
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::profile::Service;
use crate::devices::hiperdrive::protocol::ErrorCode;
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, TEXTS, explain};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{card, card_with_trailing, empty_placeholder, enabled_button, paragraph, row, two_columns};
use crate::ui::{Theme, icons};

pub(super) fn cards_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    two_columns(
        ui,
        theme,
        actions,
        |ui, actions| buffer_ui(ui, theme, unit, actions),
        |ui, _| {
            values_ui(ui, theme, unit);
            theme.add_gap(ui);
            figures::card_ui(ui, theme, unit);
        },
    );
}

fn buffer_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    let id = unit.session.id;
    let drive = unit.drive();
    let read = |ui: &mut Ui| {
        let ready = unit.session.is_ready();
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &translate(theme, "hd_errors.read")).clicked() {
            actions.push(Action::device(id, Hiperdrive::ReadStatus));
        }
        if enabled_button(ui, ready, icons::CHECK, &translate(theme, "hd_errors.acknowledge")).clicked() {
            let change = Change::Do(Service::Acknowledge(drive));
            actions.push(Action::device(id, Hiperdrive::Plan(Box::new(change))));
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("hd_errors.title"), read, |ui| {
        let Some(status) = unit.drive_status(drive) else {
            empty_placeholder(ui, theme, &translate(theme, "hd_errors.unread"), None);
            return;
        };
        let codes = status.buffer.iter().filter(|code| **code != ErrorCode::NONE);
        let mut none = true;
        for code in codes {
            none = false;
            let words = explain::error_code_explanation(*code);
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::WARNING_CIRCLE).color(theme.palette.bad));
                ui.label(theme.monospace(format!("{:04X}", code.code())));
                paragraph(ui, theme.format_text(&words.name));
            });
            paragraph(ui, theme.label(theme.format_text(&words.cause)));
            paragraph(ui, theme.format_text(&words.remedy));
            ui.add_space(theme.space.between);
        }
        if none {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).color(theme.palette.good));
                ui.label(translate(theme, "hd_errors.none"));
            });
        }
        paragraph(ui, theme.caption(translate(theme, "hd_errors.old")));
    });
}

/// Draws the words in parameters 116 to 118, the temperatures, and the supply voltage.
fn values_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice) {
    card(ui, theme, TEXTS.text("hd_health.title"), |ui| {
        let Some(status) = unit.drive_status(unit.drive()) else {
            empty_placeholder(ui, theme, &translate(theme, "hd_errors.unread"), None);
            return;
        };
        let names = ["hd_health.error_word", "hd_health.motion_status", "hd_health.communication"];
        for (name, word) in names.into_iter().zip(status.words) {
            row(
                ui,
                theme,
                &translate(theme, name),
                theme.monospace(format!("0x{word:04X}  {}", translate(theme, drive_word_text_id(word)))),
            );
        }
        row(ui, theme, &translate(theme, "hd_health.faults"), theme.monospace(status.faults.to_string()));
        row(
            ui,
            theme,
            &translate(theme, "hd_health.temperature"),
            theme.monospace(format!("{} °C", status.temperature)),
        );
        if let Some(whole) = &unit.status {
            row(ui, theme, &translate(theme, "hd_health.device"), theme.monospace(format!("{} °C", whole.temperature)));
            let volts = theme.format_number(whole.supply_tenths as f64 / 10.0, 1);
            row(ui, theme, &translate(theme, "hd_health.supply"), theme.monospace(format!("{volts} V")));
        }
        paragraph(ui, theme.caption(translate(theme, "hd_health.words")));
    });
}

/// Returns the message ID for a value of parameters 116 to 118 (reference, section 4).
const fn drive_word_text_id(word: u16) -> &'static str {
    match word {
        0 => "hd_health.well",
        0xFFFF => "hd_health.no_answer",
        _ => "hd_health.with_error",
    }
}
