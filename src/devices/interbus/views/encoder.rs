//! Who the encoder is, what it sends, and how it is wired.

use egui::{RichText, Ui};

use crate::app::{Action, DeviceCommand};
use crate::devices::interbus::protocol::{ProgramNumber, ReadOutValue, Reply, StartupMode};
use crate::devices::interbus::state::{Action as Interbus, Encoder, TEXTS, explain, said, words};
use crate::devices::interbus::views::say;
use crate::ui::check::lines_ui;
use crate::ui::controls::{card, card_with, choice, empty, enabled_button, entry, paragraph, row, two_columns};
use crate::ui::{Skin, icons, motor};

pub(super) fn page_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let is_profile = encoder.profile().is_some();
    two_columns(
        ui,
        skin,
        &mut *actions,
        |ui, actions| {
            identity(ui, skin, encoder, actions);
            if !is_profile {
                ui.add_space(skin.space.groups);
                check(ui, skin, encoder, actions);
            }
        },
        |ui, actions| {
            if is_profile {
                wiring(ui, skin);
                return;
            }
            sends(ui, skin, encoder, actions);
            if let Some(motor) = &encoder.motor {
                ui.add_space(skin.space.groups);
                motor::card_ui(ui, skin, motor.rpm(), |rpm| {
                    actions.push(Action::device(encoder.session.id, Interbus::Turn(rpm)))
                });
            }
        },
    );
    if !is_profile {
        ui.add_space(skin.space.groups);
        wiring(ui, skin);
    }
}

fn identity(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_readable() && (encoder.is_stopped() || encoder.profile().is_some());
    let read = |ui: &mut Ui| {
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &skin.say("encoder_card.read")).clicked() {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
    };
    card_with(ui, skin, "encoder_card.title", read, |ui| {
        let serial = skin.say("encoder_card.serial");
        if let Some(survey) = &encoder.survey {
            let identity = &survey.identity;
            ui.label(skin.value(say(skin, "ib_card.class")));
            ui.add_space(skin.space.inside);
            row(ui, skin, &serial, skin.mono(&identity.serial_number));
            row(ui, skin, &say(skin, "ib_card.version"), skin.mono(identity.software_version.to_string()));
            row(ui, skin, &say(skin, "ib_card.flags"), skin.words(&words::flags(identity.flags)));
            row(ui, skin, &say(skin, "ib_card.mode"), skin.words(&explain::startup(identity.mode)));
            let range = words::range(identity.steps, identity.revolutions);
            row(ui, skin, &say(skin, "ib_card.range"), skin.words(&range));
            let time = words::read_out_value(ReadOutValue::Minutes(survey.operating_minutes));
            row(ui, skin, &say(skin, "ib_card.time"), skin.words(&time));
            let celsius = words::celsius(survey.temperature_tenths);
            row(ui, skin, &say(skin, "ib_card.temperature"), skin.words(&celsius));
        } else if let Some(profile) = encoder.profile() {
            ui.label(skin.value(say(skin, "ib_card.class")));
            ui.add_space(skin.space.inside);
            row(ui, skin, &serial, skin.mono(&profile.identity.serial_number));
            let parameters = &profile.image.parameters;
            let range = words::range(parameters.steps, parameters.revolutions);
            row(ui, skin, &say(skin, "ib_card.range"), skin.words(&range));
            let programs = profile.image.known().count();
            row(ui, skin, &say(skin, "ib_card.programs"), programs.to_string());
        } else {
            empty(ui, skin, &say(skin, "ib_card.nothing"), None);
        }
    });
}

fn check(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    let run = |ui: &mut Ui| {
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        if enabled_button(ui, ready, icons::LIST_CHECKS, &skin.say("check_card.run")).clicked() {
            actions.push(Action::device(encoder.session.id, Interbus::Check));
        }
    };
    card_with(ui, skin, "check_card.title", run, |ui| {
        lines_ui(ui, skin, encoder.check.as_deref(), TEXTS.text("ib_check.nothing"));
    });
}

/// The word that comes, and what comes: position, speed, or the outputs of a program.
fn sends(ui: &mut Ui, skin: &Skin, encoder: &Encoder, actions: &mut Vec<Action>) {
    card(ui, skin, TEXTS.text("ib_sends.title"), |ui| {
        match encoder.record.last() {
            None => {
                empty(ui, skin, &say(skin, "ib_sends.nothing"), None);
            }
            Some(reading) => {
                row(ui, skin, &say(skin, "ib_sends.word"), skin.mono(format!("0x{:08X}", reading.word)));
                let says = said::told(reading.word, &encoder.known());
                row(ui, skin, &say(skin, "ib_sends.says"), skin.words(&says));
                if let Some(warning) = said::stray(reading.word) {
                    paragraph(ui, RichText::new(skin.words(&warning)).color(skin.palette.warn));
                    paragraph(ui, skin.caption(say(skin, "ib_sends.swapped")));
                }
            }
        }
        ui.add_space(skin.space.inside);
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        if encoder.record.last().is_some_and(|own| matches!(own.reply(), Reply::Echo { .. } | Reply::Busy { .. })) {
            paragraph(ui, RichText::new(say(skin, "ib_sends.left")).color(skin.palette.warn));
        }
        if enabled_button(ui, ready, icons::ARROW_U_UP_LEFT, &skin.say("lead_back_card.button")).clicked() {
            actions.push(Action::device(encoder.session.id, Interbus::LeadBack));
        }
        let Some(own) = encoder.mode() else {
            paragraph(ui, skin.caption(say(skin, "ib_sends.mode_unknown")));
            return;
        };
        let word = say(skin, "ib_sends.mode");
        let mut wanted = own;
        let programs = ProgramNumber::all().map(StartupMode::Cams);
        let usual = if own == StartupMode::K2 { StartupMode::K2 } else { StartupMode::K3 };
        let modes = [usual, StartupMode::Velocity].into_iter().chain(programs);
        ui.add_enabled_ui(ready, |ui| {
            entry(ui, skin, &word, |ui| {
                choice(ui, &word, &mut wanted, modes.map(|mode| (mode, skin.words(&explain::startup(mode)))));
            });
        });
        if wanted != own {
            actions.push(Action::device(encoder.session.id, Interbus::Select(wanted)));
        }
        paragraph(ui, skin.caption(say(skin, "ib_sends.mode_words")));
    });
}

const WIRING: [&str; 5] =
    ["ib_wiring.bus", "ib_wiring.supply", "ib_wiring.place", "ib_wiring.gateway", "ib_wiring.manual"];

fn wiring(ui: &mut Ui, skin: &Skin) {
    card(ui, skin, "wiring.title", |ui| {
        for note in WIRING {
            paragraph(ui, skin.label(say(skin, note)));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::WIRING;
    use crate::devices::interbus::state::TEXTS;
    use crate::ui::wires::check_notes;

    /// Issue 22.23: INTERBUS manual, 3.1 and 3.2 (9-pin round connectors, in: male, out: female; no addresses; shield to
    /// the housing, Loop: housing to PE), 6.1 (10 to 30 V DC absolute, 3.5 W, 500 kBaud or 2 MBaud).
    #[test]
    fn the_card_says_what_the_manual_says() {
        check_notes(
            &TEXTS,
            &WIRING,
            &["two 9-pin round connectors", "male for the incoming and female for the outgoing line"],
        );
        check_notes(&TEXTS, &WIRING, &["10 … 30 V DC (absolute limits)", "at most 3.5 W", "500 kbit/s or 2 Mbit/s"]);
        check_notes(&TEXTS, &WIRING, &["shield to the encoder's housing", "housing to PE", "no address switch"]);
    }
}
