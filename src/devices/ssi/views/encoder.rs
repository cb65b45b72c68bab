//! The encoder page: the adapter, reported error bits, and the wiring of the encoder.

use egui::{RichText, Ui};

use super::wiring;
use crate::app::{Action, DeviceCommand};
use crate::devices::ssi::protocol::BitMeaning;
use crate::devices::ssi::state::explain;
use crate::devices::ssi::state::{Encoder, SsiAction as Ssi, TEXTS};
use crate::devices::ssi::views::translate;
use crate::ui::check::lines_ui;
use crate::ui::controls::{card_with_trailing, empty_placeholder, enabled_button, paragraph, row, two_columns};
use crate::ui::{Theme, icons, motor};

pub(super) fn page_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    two_columns(
        ui,
        theme,
        &mut *actions,
        |ui, actions| {
            adapter_ui(ui, theme, encoder, actions);
            if let Some(motor) = &encoder.motor {
                theme.add_gap(ui);
                motor::card_ui(ui, theme, motor.rpm(), |rpm| {
                    actions.push(Action::device(encoder.session.id, Ssi::Turn(rpm)))
                });
            }
        },
        |ui, actions| {
            errors_ui(ui, theme, encoder, actions);
            theme.add_gap(ui);
            check_ui(ui, theme, encoder, actions);
        },
    );
    theme.add_gap(ui);
    wiring::card_ui(ui, theme, encoder.designer.family());
}

fn adapter_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    let is_readable = encoder.session.is_readable() && !encoder.is_profile();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, is_readable, icons::ARROW_CLOCKWISE, &theme.translate("encoder_card.read")).clicked() {
            actions.push(Action::Command(id, DeviceCommand::Read));
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("ssi_adapter.title"), read, |ui| {
        let Some(identity) = &encoder.identity else {
            empty_placeholder(ui, theme, &translate(theme, "ssi_adapter.nothing"), None);
            return;
        };
        let hello = &identity.hello;
        paragraph(ui, theme.value(&hello.name));
        ui.add_space(theme.space.inside);
        row(ui, theme, &theme.translate("encoder_card.firmware"), theme.monospace(&hello.firmware));
        row(ui, theme, &theme.translate("encoder_card.serial"), theme.monospace(&hello.serial));
        let clock_settings = &identity.clock_settings;
        let text = TEXTS
            .text("ssi_adapter.asks")
            .with("clocks", clock_settings.clocks)
            .with_number("khz", f64::from(identity.clock_hz) / 1000.0, 0)
            .with("pause", clock_settings.pause_us);
        row(ui, theme, &translate(theme, "ssi_adapter.reads"), theme.format_text(&text));
        if identity.clock_hz != clock_settings.clock_hz {
            let text = TEXTS.text("ssi_adapter.other_clock").with_number(
                "khz",
                f64::from(clock_settings.clock_hz) / 1000.0,
                0,
            );
            paragraph(ui, RichText::new(theme.format_text(&text)).color(theme.palette.warn));
        }
        let supply = identity.supply.map(|supply| match supply.measured {
            Some((millivolt, milliampere)) => TEXTS
                .text("ssi_adapter.supplies")
                .with_number("volts", f64::from(millivolt) / 1000.0, 2)
                .with("milliampere", milliampere),
            None => TEXTS.text("ssi_adapter.supply_off"),
        });
        let supply = supply.unwrap_or_else(|| TEXTS.text("ssi_adapter.no_supply"));
        row(ui, theme, &translate(theme, "ssi_adapter.supply"), theme.format_text(&supply));
    });
}

/// Draws the findings, including those in frames that were not displayed.
fn errors_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let noted = encoder.record.finding_counts().finding_counts();
    let id = encoder.session.id;
    let forget = |ui: &mut Ui| {
        if enabled_button(ui, !noted.is_empty(), icons::ARROW_COUNTER_CLOCKWISE, &translate(theme, "ssi_tally.forget"))
            .clicked()
        {
            actions.push(Action::device(id, Ssi::ForgetErrors));
        }
    };
    card_with_trailing(ui, theme, TEXTS.text("ssi_tally.title"), forget, |ui| {
        if noted.is_empty() {
            let id = if encoder.last().is_some() { "ssi_tally.none" } else { "ssi_tally.nothing_read" };
            paragraph(ui, theme.label(translate(theme, id)));
        }
        for own in noted {
            let (icon, colour) = match own.finding.meaning() {
                BitMeaning::Invalid => (icons::X_CIRCLE, theme.palette.bad),
                BitMeaning::Warning => (icons::WARNING, theme.palette.warn),
            };
            ui.horizontal_top(|ui| {
                ui.label(RichText::new(icon).color(colour));
                ui.vertical(|ui| {
                    paragraph(ui, theme.format_text(&explain::finding_text(&own.finding)));
                    paragraph(ui, theme.caption(theme.format_text(&explain::finding_counts(own))));
                });
            });
        }
    });
}

fn check_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let run = |ui: &mut Ui| {
        let ready = encoder.session.is_ready();
        if enabled_button(ui, ready, icons::LIST_CHECKS, &theme.translate("check_card.run")).clicked() {
            actions.push(Action::device(encoder.session.id, Ssi::Check));
        }
    };
    card_with_trailing(ui, theme, "check_card.title", run, |ui| {
        lines_ui(ui, theme, encoder.check.as_deref(), TEXTS.text("ssi_check.nothing"));
    });
}
