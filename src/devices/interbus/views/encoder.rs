//! The encoder page: identity, current word and wiring.

use egui::{RichText, Ui};

use crate::app::{Action, DeviceCommand};
use crate::devices::interbus::protocol::{ProgramNumber, ReadOutValue, Reply, StartupMode};
use crate::devices::interbus::state::{Encoder, InterbusAction as Interbus, TEXTS, explain, format, word_meaning};
use crate::devices::interbus::views::translate;
use crate::ui::check::lines_ui;
use crate::ui::controls::{
    card, card_with_trailing, dropdown, empty_placeholder, enabled_button, encoder_page, entry, folding_card,
    paragraph, row,
};
use crate::ui::{Theme, icons, motor};

pub(super) fn page_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let is_profile = encoder.profile().is_some();
    encoder_page(
        ui,
        theme,
        &mut *actions,
        is_profile,
        (|ui, actions| identity(ui, theme, encoder, actions), |ui, actions| check_ui(ui, theme, encoder, actions)),
        (
            |ui| wiring_ui(ui, theme),
            |ui, actions| {
                current_word_ui(ui, theme, encoder, actions);
                if let Some(motor) = &encoder.motor {
                    theme.add_gap(ui);
                    motor::card_ui(ui, theme, motor.rpm(), |rpm| {
                        actions.push(Action::device(encoder.session.id, Interbus::Turn(rpm)))
                    });
                }
            },
        ),
    );
    if !is_profile {
        theme.add_gap(ui);
        wiring_ui(ui, theme);
    }
}

fn identity(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_readable() && (encoder.is_stopped() || encoder.profile().is_some());
    let read = |ui: &mut Ui| {
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &theme.translate("encoder_card.read")).clicked() {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
    };
    card_with_trailing(ui, theme, "encoder_card.title", read, |ui| {
        let serial = theme.translate("encoder_card.serial");
        if let Some(survey) = &encoder.survey {
            let identity = &survey.identity;
            paragraph(ui, theme.value(translate(theme, "ib_card.class")));
            ui.add_space(theme.space.inside);
            row(ui, theme, &serial, theme.monospace(&identity.serial_number));
            row(
                ui,
                theme,
                &translate(theme, "ib_card.version"),
                theme.monospace(identity.software_version.to_string()),
            );
            row(ui, theme, &translate(theme, "ib_card.flags"), theme.format_text(&format::flags_text(identity.flags)));
            row(
                ui,
                theme,
                &translate(theme, "ib_card.mode"),
                theme.format_text(&explain::startup_mode_text(identity.mode)),
            );
            let range = format::range_text(identity.steps, identity.revolutions);
            row(ui, theme, &translate(theme, "ib_card.range"), theme.format_text(&range));
            let time = format::read_out_value(ReadOutValue::Minutes(survey.operating_minutes));
            row(ui, theme, &translate(theme, "ib_card.time"), theme.format_text(&time));
            let celsius = format::temperature_text(survey.temperature_tenths);
            row(ui, theme, &translate(theme, "ib_card.temperature"), theme.format_text(&celsius));
        } else if let Some(profile) = encoder.profile() {
            paragraph(ui, theme.value(translate(theme, "ib_card.class")));
            ui.add_space(theme.space.inside);
            row(ui, theme, &serial, theme.monospace(&profile.identity.serial_number));
            let parameters = &profile.image.parameters;
            let range = format::range_text(parameters.steps, parameters.revolutions);
            row(ui, theme, &translate(theme, "ib_card.range"), theme.format_text(&range));
            let programs = profile.image.known_programs().count();
            row(ui, theme, &translate(theme, "ib_card.programs"), programs.to_string());
        } else {
            empty_placeholder(ui, theme, &translate(theme, "ib_card.nothing"), None);
        }
    });
}

fn check_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let run = |ui: &mut Ui| {
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        if enabled_button(ui, ready, icons::LIST_CHECKS, &theme.translate("check_card.run")).clicked() {
            actions.push(Action::device(encoder.session.id, Interbus::Check));
        }
    };
    card_with_trailing(ui, theme, "check_card.title", run, |ui| {
        lines_ui(ui, theme, encoder.check.as_deref(), TEXTS.text("ib_check.nothing"));
    });
}

fn current_word_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    card(ui, theme, TEXTS.text("ib_sends.title"), |ui| {
        match encoder.record.last() {
            None => {
                empty_placeholder(ui, theme, &translate(theme, "ib_sends.nothing"), None);
            }
            Some(reading) => {
                row(ui, theme, &translate(theme, "ib_sends.word"), theme.monospace(format!("0x{:08X}", reading.word)));
                let meaning = word_meaning::word_text(reading.word, &encoder.word_context());
                row(ui, theme, &translate(theme, "ib_sends.says"), theme.format_text(&meaning));
                if let Some(warning) = word_meaning::unexpected_bits(reading.word) {
                    paragraph(ui, RichText::new(theme.format_text(&warning)).color(theme.palette.warn));
                    paragraph(ui, theme.caption(translate(theme, "ib_sends.swapped")));
                }
            }
        }
        ui.add_space(theme.space.inside);
        let ready = encoder.session.is_ready() && encoder.is_stopped();
        if encoder.record.last().is_some_and(|own| matches!(own.reply(), Reply::Echo { .. } | Reply::Busy { .. })) {
            paragraph(ui, RichText::new(translate(theme, "ib_sends.left")).color(theme.palette.warn));
        }
        if enabled_button(ui, ready, icons::ARROW_U_UP_LEFT, &theme.translate("lead_back_card.button")).clicked() {
            actions.push(Action::device(encoder.session.id, Interbus::RestoreMode));
        }
        let Some(own) = encoder.mode() else {
            paragraph(ui, theme.caption(translate(theme, "ib_sends.mode_unknown")));
            return;
        };
        let word = translate(theme, "ib_sends.mode");
        let mut wanted = own;
        let programs = ProgramNumber::all().map(StartupMode::Cams);
        let usual = if own == StartupMode::K2 { StartupMode::K2 } else { StartupMode::K3 };
        let modes = [usual, StartupMode::Velocity].into_iter().chain(programs);
        ui.add_enabled_ui(ready, |ui| {
            entry(ui, theme, &word, |ui| {
                dropdown(
                    ui,
                    &word,
                    &mut wanted,
                    modes.map(|mode| (mode, theme.format_text(&explain::startup_mode_text(mode)))),
                );
            });
        });
        if wanted != own {
            actions.push(Action::device(encoder.session.id, Interbus::Select(wanted)));
        }
        paragraph(ui, theme.caption(translate(theme, "ib_sends.mode_words")));
    });
}

const WIRING: [&str; 5] =
    ["ib_wiring.bus", "ib_wiring.supply", "ib_wiring.place", "ib_wiring.gateway", "ib_wiring.manual"];

fn wiring_ui(ui: &mut Ui, theme: &Theme) {
    folding_card(ui, theme, "wiring.title", |ui| {
        for note in WIRING {
            paragraph(ui, theme.label(translate(theme, note)));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::WIRING;
    use crate::devices::interbus::state::TEXTS;
    use crate::ui::wiring::assert_notes;

    /// Sources: manual 3.1 and 3.2 (9-pin round connectors, male for the input and female for the output; no addresses;
    /// shield to the housing, and in Loop the housing to PE), and 6.1 (10 to 30 V DC absolute, 3.5 W, 500 kBaud or 2
    /// MBaud). See issue 22.23.
    #[test]
    fn wiring_card_matches_manual() {
        assert_notes(
            &TEXTS,
            &WIRING,
            &["two 9-pin round connectors", "male for the incoming and female for the outgoing cable"],
        );
        assert_notes(&TEXTS, &WIRING, &["10 … 30 V DC (absolute limits)", "at most 3.5 W", "500 kbit/s or 2 Mbit/s"]);
        assert_notes(&TEXTS, &WIRING, &["cable screen to the encoder housing", "housing to PE", "no address switch"]);
    }
}
