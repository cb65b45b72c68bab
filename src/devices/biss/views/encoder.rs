//! The encoder page: identity, status, frame, wiring and data sheet.

use egui::{RichText, Ui};

use super::{frame, motor, sheet, wiring};
use crate::app::{Action, DeviceCommand};
use crate::devices::biss::procedures::{FlagRegister, FrameSource, Identity};
use crate::devices::biss::profile::ProfileIdentity;
use crate::devices::biss::state::explain as explained;
use crate::devices::biss::state::{BissAction as Biss, Encoder, TEXTS, format};
use crate::devices::biss::views::translate;
use crate::ui::check::lines_ui;
use crate::ui::controls::{card_with_trailing, empty_placeholder, enabled_button, encoder_page, paragraph, row};
use crate::ui::{Theme, icons};

pub(super) fn page_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let is_profile = encoder.profile().is_some();
    encoder_page(
        ui,
        theme,
        &mut *actions,
        is_profile,
        (|ui, actions| identity(ui, theme, encoder, actions), |ui, actions| check_ui(ui, theme, encoder, actions)),
        (
            |ui| wiring::card_ui(ui, theme),
            |ui, actions| {
                status_ui(ui, theme, encoder, actions);
                if let Some(motor) = &encoder.motor {
                    theme.add_gap(ui);
                    motor::card_ui(ui, theme, encoder, motor, actions);
                }
            },
        ),
    );
    theme.add_gap(ui);
    if encoder.identity().is_some() {
        frame::card_ui(ui, theme, encoder, actions);
        theme.add_gap(ui);
    }
    if !is_profile {
        wiring::card_ui(ui, theme);
        theme.add_gap(ui);
    }
    sheet::cards_ui(ui, theme, encoder);
}

fn identity(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let ready = encoder.session.is_readable();
    let read = |ui: &mut Ui| {
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &theme.translate("encoder_card.read")).clicked() {
            actions.push(Action::Command(encoder.session.id, DeviceCommand::Read));
        }
    };
    card_with_trailing(ui, theme, "encoder_card.title", read, |ui| {
        if let Some(identity) = encoder.identity() {
            paragraph(ui, theme.value(identity.description.name()));
            ui.add_space(theme.space.inside);
            facts_ui(ui, theme, identity);
        } else if let Some(identity) = encoder.profile_identity() {
            paragraph(ui, theme.value(&identity.description));
            ui.add_space(theme.space.inside);
            profile_identity_ui(ui, theme, encoder, identity);
        } else {
            empty_placeholder(ui, theme, &theme.translate("encoder_card.nothing"), None);
        }
    });
}

fn facts_ui(ui: &mut Ui, theme: &Theme, identity: &Identity) {
    let or_none = |text: String| if text.is_empty() { theme.translate("encoder_card.not_told") } else { text };
    let serial = format!("{}  {}", identity.serial_number, crate::bits::hex(&identity.serial_bytes));
    row(ui, theme, &theme.translate("encoder_card.serial"), theme.monospace(or_none(serial.trim().to_owned())));
    let firmware = identity.firmware.map(|own| own.to_string()).unwrap_or_default();
    row(ui, theme, &theme.translate("encoder_card.firmware"), theme.monospace(or_none(firmware)));
    row(ui, theme, &translate(theme, "biss_card.profile"), theme.monospace(identity.kind.profile.to_string()));
    row(
        ui,
        theme,
        &translate(theme, "biss_card.device_id"),
        theme.monospace(crate::bits::hex(&identity.kind.device_id)),
    );
    manufacturer_ui(ui, theme, identity.kind.manufacturer);
    let layout = &identity.layout;
    let widths = TEXTS
        .text("biss_card.widths")
        .with("multiturn", layout.multiturn_bits())
        .with("singleturn", layout.singleturn_bits())
        .with("bits", layout.bits());
    row(ui, theme, &translate(theme, "biss_card.frame"), theme.format_text(&widths));
    let source = match identity.source {
        FrameSource::DataSheet => "biss_card.from_sheet",
        FrameSource::Description => "biss_card.from_description",
        FrameSource::Given => "biss_card.given",
        FrameSource::Checksum => "biss_card.from_checksum",
        FrameSource::Assumed => "biss_card.assumed",
    };
    row(ui, theme, "", theme.caption(translate(theme, source)));
    if !identity.source.is_known() {
        paragraph(ui, theme.caption(translate(theme, "biss_card.give_frame")));
    }
    if let Some(adapter) = &identity.adapter {
        let words = format!("{} {} · {}", adapter.name, adapter.firmware, adapter.serial);
        row(ui, theme, &translate(theme, "biss_card.adapter"), words);
    }
    if let Some(mismatch) = &identity.mismatch {
        let text = explained::mismatch_text(mismatch);
        paragraph(ui, RichText::new(theme.format_text(&text)).color(theme.palette.warn));
    }
}

fn profile_identity_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, identity: &ProfileIdentity) {
    let or_none = |text: String| if text.is_empty() { translate(theme, "biss_card.not_in_profile") } else { text };
    row(ui, theme, &theme.translate("encoder_card.serial"), theme.monospace(or_none(identity.serial_number.clone())));
    let firmware = identity.firmware.map(|own| own.to_string()).unwrap_or_default();
    row(ui, theme, &theme.translate("encoder_card.firmware"), theme.monospace(or_none(firmware)));
    row(ui, theme, &translate(theme, "biss_card.profile"), theme.monospace(identity.profile_id.to_string()));
    row(ui, theme, &translate(theme, "biss_card.device_id"), theme.monospace(crate::bits::hex(&identity.device_id)));
    manufacturer_ui(ui, theme, identity.manufacturer);
    if let Some(singleturn) = identity.singleturn_bits {
        let widths = TEXTS
            .text("biss_card.position_widths")
            .with("multiturn", identity.multiturn_bits.unwrap_or_default())
            .with("singleturn", singleturn);
        row(ui, theme, &translate(theme, "biss_card.frame"), theme.format_text(&widths));
    }
    let Some(profile) = encoder.profile() else { return };
    if let Some(filter) = profile.filter {
        row(ui, theme, &translate(theme, "biss_status.filter"), theme.format_text(&format::filter(filter)));
    }
}

fn manufacturer_ui(ui: &mut Ui, theme: &Theme, code: [u8; 2]) {
    let words = format!("{}  {}", crate::bits::hex(&code), code.escape_ascii());
    row(ui, theme, &translate(theme, "biss_card.manufacturer"), theme.monospace(words));
}

fn status_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let read = |ui: &mut Ui| {
        let ready = encoder.session.is_ready();
        if enabled_button(ui, ready, icons::ARROW_CLOCKWISE, &theme.translate("status_card.read")).clicked() {
            actions.push(Action::device(encoder.session.id, Biss::ReadStatus));
        }
    };
    card_with_trailing(ui, theme, "status_card.title", read, |ui| {
        let Some(status) = &encoder.status else {
            ui.label(theme.label(translate(theme, "biss_status.nothing")));
            return;
        };
        let palette = theme.palette;
        let none = [&status.errors, &status.warnings].into_iter().flatten().all(|bits| bits.set.is_empty());
        if none && (status.errors.is_some() || status.warnings.is_some()) {
            ui.horizontal(|ui| {
                ui.label(RichText::new(icons::CHECK_CIRCLE).color(palette.good));
                ui.label(translate(theme, "biss_status.good"));
            });
        }
        bits(ui, theme, status.errors.as_ref(), icons::X_CIRCLE, palette.bad);
        bits(ui, theme, status.warnings.as_ref(), icons::WARNING, palette.warn);
        if let Some(celsius) = status.celsius {
            let words = format!("{} °C", theme.format_number(celsius, 0));
            row(ui, theme, &translate(theme, "biss_status.temperature"), theme.monospace(words));
        }
        if let Some(mode) = status.mode {
            row(ui, theme, &translate(theme, "biss_status.mode"), theme.format_text(&explained::mode_text(mode)));
        }
        if let Some(filter) = status.filter {
            row(ui, theme, &translate(theme, "biss_status.filter"), theme.format_text(&format::filter(filter)));
        }
        let preset = encoder.survey.as_ref().and_then(|survey| Some((survey.preset?, &survey.identity.layout)));
        if let Some((value, layout)) = preset {
            let words = theme.format_text(&explained::preset_value_text(value, layout.singleturn_bits()));
            row(ui, theme, &translate(theme, "biss_status.preset"), theme.monospace(words));
        }
        if status.protection.is_some_and(|protection| protection != 0) {
            paragraph(ui, RichText::new(translate(theme, "biss_status.open")).color(palette.warn));
        }
    });
}

fn check_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let run = |ui: &mut Ui| {
        let ready = encoder.session.is_ready();
        if enabled_button(ui, ready, icons::LIST_CHECKS, &theme.translate("check_card.run")).clicked() {
            actions.push(Action::device(encoder.session.id, Biss::Check));
        }
    };
    card_with_trailing(ui, theme, "check_card.title", run, |ui| {
        lines_ui(ui, theme, encoder.check.as_deref(), TEXTS.text("check_card.biss_nothing"));
    });
}

fn bits(ui: &mut Ui, theme: &Theme, bits: Option<&FlagRegister>, icon: &str, colour: crate::app::Rgb) {
    for (bit, name) in bits.iter().flat_map(|bits| &bits.set) {
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icon).color(colour));
            ui.label(theme.monospace(format!("b{bit}")));
            paragraph(ui, theme.format_text(&explained::flag_text(name.as_ref())));
        });
    }
}
