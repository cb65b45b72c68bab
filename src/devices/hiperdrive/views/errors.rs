//! What a drive says is wrong: its error buffer with causes and remedies, its words, and the cyclic connection.

use egui::{RichText, Ui};

use super::figures;
use crate::app::Action;
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::profile::Service;
use crate::devices::hiperdrive::protocol::ErrorCode;
use crate::devices::hiperdrive::state::{Action as Hiperdrive, TEXTS, Unit, explain};
use crate::devices::hiperdrive::views::say;
use crate::ui::controls::{card, card_with, empty, enabled_button, paragraph, row, two_columns};
use crate::ui::{Skin, icons};

pub(super) fn cards_ui(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    two_columns(
        ui,
        skin,
        actions,
        |ui, actions| buffer(ui, skin, unit, actions),
        |ui, _| {
            words(ui, skin, unit);
            ui.add_space(skin.space.groups);
            figures::card_ui(ui, skin, unit);
        },
    );
}

/// Eight errors, the newest first.
fn buffer(ui: &mut Ui, skin: &Skin, unit: &Unit, actions: &mut Vec<Action>) {
    let id = unit.session.id;
    let drive = unit.drive();
    let read = |ui: &mut Ui| {
        let ready = unit.session.is_ready();
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &say(skin, "hd_errors.read")).clicked() {
            actions.push(Action::device(id, Hiperdrive::ReadStatus));
        }
        if enabled_button(ui, ready, icons::CHECK, &say(skin, "hd_errors.acknowledge")).clicked() {
            let change = Change::Do(Service::Acknowledge(drive));
            actions.push(Action::device(id, Hiperdrive::Plan(Box::new(change))));
        }
    };
    card_with(ui, skin, TEXTS.text("hd_errors.title"), read, |ui| {
        let Some(status) = unit.drive_status(drive) else {
            empty(ui, skin, &say(skin, "hd_errors.unread"), None);
            return;
        };
        let codes = status.buffer.iter().filter(|code| **code != ErrorCode::NONE);
        let mut none = true;
        for code in codes {
            none = false;
            let words = explain::error(*code);
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icons::WARNING_CIRCLE).color(skin.palette.bad));
                ui.label(skin.mono(format!("{:04X}", code.code())));
                paragraph(ui, skin.words(&words.name));
            });
            paragraph(ui, skin.label(skin.words(&words.cause)));
            paragraph(ui, skin.words(&words.remedy));
            ui.add_space(skin.space.between);
        }
        if none {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).color(skin.palette.good));
                ui.label(say(skin, "hd_errors.none"));
            });
        }
        paragraph(ui, skin.caption(say(skin, "hd_errors.old")));
    });
}

/// Parameters 116 to 118, temperatures, the supply.
fn words(ui: &mut Ui, skin: &Skin, unit: &Unit) {
    card(ui, skin, TEXTS.text("hd_health.title"), |ui| {
        let Some(status) = unit.drive_status(unit.drive()) else {
            empty(ui, skin, &say(skin, "hd_errors.unread"), None);
            return;
        };
        let names = ["hd_health.error_word", "hd_health.motion_status", "hd_health.communication"];
        for (name, word) in names.into_iter().zip(status.words) {
            row(ui, skin, &say(skin, name), skin.mono(format!("0x{word:04X}  {}", say(skin, com_word(word)))));
        }
        row(ui, skin, &say(skin, "hd_health.faults"), skin.mono(status.faults.to_string()));
        row(ui, skin, &say(skin, "hd_health.temperature"), skin.mono(format!("{} °C", status.temperature)));
        if let Some(whole) = &unit.status {
            row(ui, skin, &say(skin, "hd_health.device"), skin.mono(format!("{} °C", whole.temperature)));
            let volts = skin.number(whole.supply_tenths as f64 / 10.0, 1);
            row(ui, skin, &say(skin, "hd_health.supply"), skin.mono(format!("{volts} V")));
        }
        paragraph(ui, skin.caption(say(skin, "hd_health.words")));
    });
}

/// What one of the words 116 to 118 says (reference 4).
const fn com_word(word: u16) -> &'static str {
    match word {
        0 => "hd_health.well",
        0xFFFF => "hd_health.no_answer",
        _ => "hd_health.with_error",
    }
}
