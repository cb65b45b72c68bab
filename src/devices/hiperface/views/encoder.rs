//! Who the encoder is, what its error queue says, the device check, the extended label, the wiring.

use egui::{RichText, Ui};

use super::wiring;
use crate::app::{Action, DeviceCommand};
use crate::devices::hiperface::procedures::Identity;
use crate::devices::hiperface::state::explain as words;
use crate::devices::hiperface::state::{Action as Hiperface, Encoder, TEXTS};
use crate::devices::hiperface::views::say;
use crate::ui::check::lines_ui;
use crate::ui::controls::{card, card_with, empty, enabled_button, paragraph, row, two_columns};
use crate::ui::{Skin, icons};

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, restart: &mut bool, actions: &mut Vec<Action>) {
    two_columns(
        ui,
        skin,
        (actions, restart),
        |ui, (actions, _)| {
            identity(ui, skin, encoder, actions);
            ui.add_space(skin.space.groups);
            status(ui, skin, encoder, actions);
            extended_label(ui, skin, encoder);
        },
        |ui, (actions, restart)| {
            check(ui, skin, encoder, restart, actions);
            ui.add_space(skin.space.groups);
            wiring::card_ui(ui, skin);
        },
    );
}

fn identity(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_readable();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &skin.say("encoder_card.read")).clicked() {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
    };
    card_with(ui, skin, "encoder_card.title", read, |ui| {
        let Some(identity) = &encoder.identity else {
            empty(ui, skin, &skin.say("encoder_card.nothing"), None);
            return;
        };
        ui.label(skin.value(&identity.name));
        ui.add_space(skin.space.inside);
        facts(ui, skin, identity);
        if let Some(memory) = identity.memory {
            let id = if memory.fields == 1 { "encoder_card.memory_one" } else { "encoder_card.memory_words" };
            let text = TEXTS
                .text(id)
                .with("total", identity.label.eeprom_bytes())
                .with("free", memory.bytes())
                .with("fields", memory.fields);
            row(ui, skin, &say(skin, "encoder_card.memory"), skin.words(&text));
        } else {
            let total = format!("{} B", identity.label.eeprom_bytes());
            row(ui, skin, &say(skin, "encoder_card.memory"), skin.mono(total));
        }
        line_quality(ui, skin, encoder);
    });
}

/// What had to be repeated on the line, while it is connected.
fn line_quality(ui: &mut Ui, skin: &Skin, encoder: &Encoder) {
    if encoder.session.line().is_none() {
        return;
    }
    let quality = &encoder.line_quality;
    let words = RichText::new(skin.words(&words::line_quality(quality)));
    let words = if quality.is_troubled() { words.color(skin.palette.warn) } else { words };
    row(ui, skin, &say(skin, "encoder_card.line"), words);
}

fn facts(ui: &mut Ui, skin: &Skin, identity: &Identity) {
    let none = || skin.say("encoder_card.not_told");
    let or_none = |text: &str| if text.is_empty() { none() } else { text.to_owned() };
    let serial = &identity.serial;
    row(ui, skin, &skin.say("encoder_card.serial"), skin.mono(or_none(&serial.serial_number)));
    row(ui, skin, &say(skin, "encoder_card.type"), skin.mono(format!("{:02X}h", identity.label.encoder_type)));
    let resolution = match identity.geometry {
        Some(geometry) => skin.words(&words::geometry(geometry)),
        None => say(skin, "encoder_card.no_geometry"),
    };
    row(ui, skin, &say(skin, "encoder_card.resolution"), resolution);
    let firmware = format!("{}  {}", serial.firmware_version, serial.firmware_date);
    row(ui, skin, &skin.say("encoder_card.firmware"), skin.mono(or_none(firmware.trim())));
    row(ui, skin, &say(skin, "encoder_card.address"), skin.mono(format!("{:02X}h", identity.address)));
    row(ui, skin, &say(skin, "encoder_card.settings"), skin.words(&words::line_settings(identity.label.settings)));
    row(ui, skin, &say(skin, "encoder_card.options"), skin.mono(format!("{:02X}h", identity.label.options)));
}

fn status(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let read = |ui: &mut Ui| {
        if enabled_button(ui, encoder.session.is_ready(), icons::ARROW_CLOCKWISE, &skin.say("status_card.read"))
            .clicked()
        {
            actions.push(Action::device(encoder.session.id, Hiperface::ReadStatus));
        }
    };
    let palette = skin.palette;
    card_with(ui, skin, "status_card.title", read, |ui| match &encoder.codes {
        None => {
            ui.label(skin.label(say(skin, "status_card.nothing")));
        }
        Some(codes) if codes.is_empty() => {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).color(palette.good));
                ui.label(say(skin, "status_card.good"));
            });
        }
        Some(codes) => {
            for code in codes {
                let (icon, colour) =
                    if code.is_warning() { (icons::WARNING, palette.warn) } else { (icons::X_CIRCLE, palette.bad) };
                ui.horizontal_top(|ui| {
                    ui.label(RichText::new(icon).color(colour));
                    ui.label(skin.mono(format!("{:02X}h", code.byte())));
                    ui.add(egui::Label::new(skin.words(&words::status(*code))).wrap().selectable(true));
                });
            }
            ui.label(skin.caption(say(skin, "status_card.queue")));
        }
    });
}

fn check(ui: &mut Ui, skin: &Skin, encoder: &Encoder, restart: &mut bool, actions: &mut Vec<Action>) {
    card(ui, skin, "check_card.title", |ui| {
        let lines = encoder.check.as_deref().map(words::check);
        lines_ui(ui, skin, lines.as_deref(), TEXTS.text("check_card.nothing"));
        ui.add_space(skin.space.between);
        ui.checkbox(restart, say(skin, "check_card.restart"));
        if enabled_button(ui, encoder.session.is_ready(), icons::LIST_CHECKS, &skin.say("check_card.run")).clicked() {
            actions.push(Action::device(encoder.session.id, Hiperface::Check { restart: *restart }));
        }
    });
}

fn extended_label(ui: &mut Ui, skin: &Skin, encoder: &Encoder) {
    let Some(bytes) = encoder.identity.as_ref().and_then(|identity| identity.extended_label.as_deref()) else { return };
    ui.add_space(skin.space.groups);
    card(ui, skin, TEXTS.text("label_card.title"), |ui| {
        for part in words::label(bytes) {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().interact_size.y = 18.0;
                let addresses = ui.label(skin.mono(&part.addresses).color(skin.palette.muted));
                ui.add_space((ADDRESSES - addresses.rect.width()).max(0.0));
                ui.vertical(|ui| {
                    ui.spacing_mut().item_spacing.y = 0.0;
                    paragraph(ui, skin.words(&part.meaning));
                    paragraph(ui, skin.mono(&part.bytes).size(skin.sizes.caption).color(skin.palette.muted));
                });
            });
        }
    });
}

/// Width of the column of addresses.
const ADDRESSES: f32 = 72.0;
