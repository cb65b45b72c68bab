//! The encoder behind its adapter, what its error bits have said, and how it is wired.

use egui::{RichText, Ui};

use super::wiring;
use crate::app::{Action, DeviceCommand};
use crate::devices::ssi::protocol::Meaning;
use crate::devices::ssi::state::explain as words;
use crate::devices::ssi::state::{Action as Ssi, Encoder, TEXTS};
use crate::devices::ssi::views::say;
use crate::ui::check::lines_ui;
use crate::ui::controls::{card_with, empty, enabled_button, paragraph, row, two_columns};
use crate::ui::{Skin, icons, motor};

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    two_columns(
        ui,
        skin,
        &mut *actions,
        |ui, actions| {
            adapter(ui, skin, encoder, actions);
            if let Some(motor) = &encoder.motor {
                ui.add_space(skin.space.groups);
                motor::card_ui(ui, skin, motor.rpm(), |rpm| {
                    actions.push(Action::device(encoder.session.id, Ssi::Turn(rpm)))
                });
            }
        },
        |ui, actions| {
            errors(ui, skin, encoder, actions);
            ui.add_space(skin.space.groups);
            check(ui, skin, encoder, actions);
        },
    );
    ui.add_space(skin.space.groups);
    wiring::card_ui(ui, skin, encoder.designer.family());
}

/// Who reads the encoder, and how.
fn adapter(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    let is_readable = encoder.session.is_readable() && !encoder.is_profile();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, is_readable, icons::ARROW_CLOCKWISE, &skin.say("encoder_card.read")).clicked() {
            actions.push(Action::Command(id, DeviceCommand::Read));
        }
    };
    card_with(ui, skin, TEXTS.text("ssi_adapter.title"), read, |ui| {
        let Some(identity) = &encoder.identity else {
            empty(ui, skin, &say(skin, "ssi_adapter.nothing"), None);
            return;
        };
        let hello = &identity.hello;
        ui.label(skin.value(&hello.name));
        ui.add_space(skin.space.inside);
        row(ui, skin, &skin.say("encoder_card.firmware"), skin.mono(&hello.firmware));
        row(ui, skin, &skin.say("encoder_card.serial"), skin.mono(&hello.serial));
        let asking = &identity.asking;
        let text = TEXTS
            .text("ssi_adapter.asks")
            .with("clocks", asking.clocks)
            .with_number("khz", f64::from(identity.clock_hz) / 1000.0, 0)
            .with("pause", asking.pause_us);
        row(ui, skin, &say(skin, "ssi_adapter.reads"), skin.words(&text));
        if identity.clock_hz != asking.clock_hz {
            let text = TEXTS.text("ssi_adapter.other_clock").with_number("khz", f64::from(asking.clock_hz) / 1000.0, 0);
            paragraph(ui, RichText::new(skin.words(&text)).color(skin.palette.warn));
        }
        let supply = identity.supply.map(|supply| match supply.measured {
            Some((millivolt, milliampere)) => TEXTS
                .text("ssi_adapter.supplies")
                .with_number("volts", f64::from(millivolt) / 1000.0, 2)
                .with("milliampere", milliampere),
            None => TEXTS.text("ssi_adapter.supply_off"),
        });
        let supply = supply.unwrap_or_else(|| TEXTS.text("ssi_adapter.no_supply"));
        row(ui, skin, &say(skin, "ssi_adapter.supply"), skin.words(&supply));
    });
}

/// What error bits, patterns and the like have said, also between two looks.
fn errors(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let noted = encoder.record.tally().noted();
    let id = encoder.session.id;
    let forget = |ui: &mut Ui| {
        if enabled_button(ui, !noted.is_empty(), icons::ARROW_COUNTER_CLOCKWISE, &say(skin, "ssi_tally.forget"))
            .clicked()
        {
            actions.push(Action::device(id, Ssi::ForgetErrors));
        }
    };
    card_with(ui, skin, TEXTS.text("ssi_tally.title"), forget, |ui| {
        if noted.is_empty() {
            let id = if encoder.last().is_some() { "ssi_tally.none" } else { "ssi_tally.nothing_read" };
            paragraph(ui, skin.label(say(skin, id)));
        }
        for own in noted {
            let (icon, colour) = match own.finding.meaning() {
                Meaning::Invalid => (icons::X_CIRCLE, skin.palette.bad),
                Meaning::Warning => (icons::WARNING, skin.palette.warn),
            };
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icon).color(colour));
                ui.vertical(|ui| {
                    paragraph(ui, skin.words(&words::finding(&own.finding)));
                    paragraph(ui, skin.caption(skin.words(&words::noted(own))));
                });
            });
        }
    });
}

fn check(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let run = |ui: &mut Ui| {
        let ready = encoder.session.is_ready();
        if enabled_button(ui, ready, icons::LIST_CHECKS, &skin.say("check_card.run")).clicked() {
            actions.push(Action::device(encoder.session.id, Ssi::Check));
        }
    };
    card_with(ui, skin, "check_card.title", run, |ui| {
        lines_ui(ui, skin, encoder.check.as_deref(), TEXTS.text("ssi_check.nothing"));
    });
}
