//! The encoder page: identity, error queue, device check, extended label and wiring.

use egui::{RichText, Ui};

use super::wiring;
use crate::app::{Action, DeviceCommand};
use crate::devices::hiperface::procedures::Identity;
use crate::devices::hiperface::state::explain;
use crate::devices::hiperface::state::{Encoder, HiperfaceAction as Hiperface, TEXTS};
use crate::devices::hiperface::views::translate;
use crate::ui::check::lines_ui;
use crate::ui::controls::{
    card, card_with_trailing, empty_placeholder, enabled_button, folding_card, paragraph, row, two_columns,
};
use crate::ui::{Theme, icons};

pub(super) fn page_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, restart: &mut bool, actions: &mut Vec<Action>) {
    two_columns(
        ui,
        theme,
        (actions, restart),
        |ui, (actions, _)| {
            identity(ui, theme, encoder, actions);
            theme.add_gap(ui);
            status_ui(ui, theme, encoder, actions);
            extended_label_ui(ui, theme, encoder);
        },
        |ui, (actions, restart)| {
            check_ui(ui, theme, encoder, restart, actions);
            theme.add_gap(ui);
            wiring::card_ui(ui, theme);
        },
    );
}

fn identity(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_readable();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &theme.translate("encoder_card.read")).clicked() {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
    };
    card_with_trailing(ui, theme, "encoder_card.title", read, |ui| {
        let Some(identity) = &encoder.identity else {
            empty_placeholder(ui, theme, &theme.translate("encoder_card.nothing"), None);
            return;
        };
        paragraph(ui, theme.value(&identity.name));
        ui.add_space(theme.space.inside);
        facts_ui(ui, theme, identity);
        if let Some(memory) = identity.memory {
            let id = if memory.fields == 1 { "encoder_card.memory_one" } else { "encoder_card.memory_words" };
            let text = TEXTS
                .text(id)
                .with("total", identity.label.eeprom_bytes())
                .with("free", memory.bytes())
                .with("fields", memory.fields);
            row(ui, theme, &translate(theme, "encoder_card.memory"), theme.format_text(&text));
        } else {
            let total = format!("{} B", identity.label.eeprom_bytes());
            row(ui, theme, &translate(theme, "encoder_card.memory"), theme.monospace(total));
        }
        line_quality_ui(ui, theme, encoder);
    });
}

fn line_quality_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder) {
    if encoder.session.live_session().is_none() {
        return;
    }
    let quality = &encoder.line_quality;
    let words = RichText::new(theme.format_text(&explain::line_quality(quality)));
    let words = if quality.has_errors() { words.color(theme.palette.warn) } else { words };
    row(ui, theme, &translate(theme, "encoder_card.line"), words);
}

fn facts_ui(ui: &mut Ui, theme: &Theme, identity: &Identity) {
    let none = || theme.translate("encoder_card.not_told");
    let or_none = |text: &str| if text.is_empty() { none() } else { text.to_owned() };
    let serial = &identity.serial;
    row(ui, theme, &theme.translate("encoder_card.serial"), theme.monospace(or_none(&serial.serial_number)));
    row(
        ui,
        theme,
        &translate(theme, "encoder_card.type"),
        theme.monospace(format!("{:02X}h", identity.label.encoder_type)),
    );
    let resolution = match identity.geometry {
        Some(geometry) => theme.format_text(&explain::geometry_text(geometry)),
        None => translate(theme, "encoder_card.no_geometry"),
    };
    row(ui, theme, &translate(theme, "encoder_card.resolution"), resolution);
    let firmware = format!("{}  {}", serial.firmware_version, serial.firmware_date);
    row(ui, theme, &theme.translate("encoder_card.firmware"), theme.monospace(or_none(firmware.trim())));
    row(ui, theme, &translate(theme, "encoder_card.address"), theme.monospace(format!("{:02X}h", identity.address)));
    row(
        ui,
        theme,
        &translate(theme, "encoder_card.settings"),
        theme.format_text(&explain::line_settings(identity.label.settings)),
    );
    row(
        ui,
        theme,
        &translate(theme, "encoder_card.options"),
        theme.monospace(format!("{:02X}h", identity.label.options)),
    );
}

fn status_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let read = |ui: &mut Ui| {
        if enabled_button(ui, encoder.session.is_ready(), icons::ARROW_CLOCKWISE, &theme.translate("status_card.read"))
            .clicked()
        {
            actions.push(Action::device(encoder.session.id, Hiperface::ReadStatus));
        }
    };
    let palette = theme.palette;
    card_with_trailing(ui, theme, "status_card.title", read, |ui| match &encoder.codes {
        None => {
            ui.label(theme.label(translate(theme, "status_card.nothing")));
        }
        Some(codes) if codes.is_empty() => {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).color(palette.good));
                ui.label(translate(theme, "status_card.good"));
            });
        }
        Some(codes) => {
            for code in codes {
                let (icon, colour) =
                    if code.is_warning() { (icons::WARNING, palette.warn) } else { (icons::X_CIRCLE, palette.bad) };
                ui.horizontal_top(|ui| {
                    ui.label(RichText::new(icon).color(colour));
                    ui.label(theme.monospace(format!("{:02X}h", code.byte())));
                    ui.add(
                        egui::Label::new(theme.format_text(&explain::status_code_name(*code))).wrap().selectable(true),
                    );
                });
            }
            ui.label(theme.caption(translate(theme, "status_card.queue")));
        }
    });
}

fn check_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, restart: &mut bool, actions: &mut Vec<Action>) {
    card(ui, theme, "check_card.title", |ui| {
        let lines = encoder.check.as_deref().map(explain::check_lines);
        lines_ui(ui, theme, lines.as_deref(), TEXTS.text("check_card.nothing"));
        ui.add_space(theme.space.between);
        ui.checkbox(restart, translate(theme, "check_card.restart"));
        if enabled_button(ui, encoder.session.is_ready(), icons::LIST_CHECKS, &theme.translate("check_card.run"))
            .clicked()
        {
            actions.push(Action::device(encoder.session.id, Hiperface::Check { restart: *restart }));
        }
    });
}

fn extended_label_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder) {
    let Some(bytes) = encoder.identity.as_ref().and_then(|identity| identity.extended_label.as_deref()) else { return };
    theme.add_gap(ui);
    folding_card(ui, theme, TEXTS.text("label_card.title"), |ui| {
        for part in explain::label_rows(bytes) {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().interact_size.y = 18.0;
                let addresses = ui.label(theme.monospace(&part.addresses).color(theme.palette.muted));
                ui.add_space((ADDRESS_WIDTH - addresses.rect.width()).max(0.0));
                ui.vertical(|ui| {
                    ui.spacing_mut().item_spacing.y = 0.0;
                    paragraph(ui, theme.format_text(&part.meaning));
                    paragraph(ui, theme.monospace(&part.bytes).size(theme.sizes.caption).color(theme.palette.muted));
                });
            });
        }
    });
}

const ADDRESS_WIDTH: f32 = 72.0;
