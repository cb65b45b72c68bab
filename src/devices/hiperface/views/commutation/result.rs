//! Results of the commutation assistant: the offset, its storage in a data field, the position to set, and the report.

use egui::{RichText, Ui};

use super::{MIN_TWO_ENTRIES_WIDTH, assistant_action, fixed_height_message_ui, number_ui};
use crate::analysis::quality::Verdict;
use crate::app::{Action, DeviceCommand, PendingEdits};
use crate::devices::hiperface::state::commutation::{
    CommutationAction as Assistant, Form, Storage, StoredRecord, stored,
};
use crate::devices::hiperface::state::{Encoder, TEXTS};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{
    button_with_reason, card, dropdown, enabled_button, entry, folding_card, paragraph, primary_button, row, verdict_ui,
};
use crate::ui::{Theme, icons};

/// Draws the offset. Its space is reserved even if there is no offset yet.
pub(super) fn offset_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut Form) {
    card(ui, theme, TEXTS.text("commutation.offset"), |ui| {
        let offset = encoder.commutation.offset(encoder.geometry());
        let values = offset.as_ref().ok();
        let degrees =
            |id, degrees, decimals| theme.format_text(&TEXTS.text(id).with_number("degrees", degrees, decimals));
        let angle = values.map(|offset| degrees("commutation.offset_value", offset.angle.to_degrees(), 4));
        let resolution = values.and_then(|offset| offset.resolution_deg);
        let parts = [
            values.map(|offset| format!("{:08X}h", offset.angle.bits())),
            values.map(|offset| degrees("commutation.shaft", offset.shaft_deg, 4)),
            resolution.map(|own| degrees("commutation.resolution", own, 2)),
        ];
        let parts = parts.into_iter().flatten().collect::<Vec<_>>().join("  ·  ");
        let angle = theme.value(angle.unwrap_or_else(|| "–".to_owned()));
        let parts = |ui: &mut Ui| {
            let label = egui::Label::new(theme.monospace(&parts)).truncate().selectable(true);
            ui.add(label).on_hover_text(&parts);
        };
        if ui.available_width() >= MIN_TWO_ENTRIES_WIDTH {
            ui.horizontal(|ui| {
                ui.label(angle);
                parts(ui);
            });
        } else {
            ui.label(angle);
            parts(ui);
        }
        let is_confirmed = encoder.commutation.is_confirmed(encoder.geometry());
        let message = match &offset {
            Err(why) => theme.label(theme.format_text(why)),
            Ok(_) if is_confirmed => RichText::new(translate(theme, "commutation.confirmed")).color(theme.palette.good),
            Ok(_) => RichText::new(translate(theme, "commutation.unconfirmed")).color(theme.palette.warn),
        };
        fixed_height_message_ui(ui, theme, message);
        ui.add_enabled_ui(!is_confirmed, |ui| {
            ui.checkbox(&mut form.without_second, translate(theme, "commutation.without_second"));
        });
    });
}

pub(super) fn field_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut Form, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("commutation.method_one"), |ui| {
        paragraph(ui, theme.label(translate(theme, "commutation.method_one_words")));
        entry(ui, theme, &translate(theme, "commutation.storage"), |ui| {
            let ways = [(Storage::Record, "commutation.record"), (Storage::Number, "commutation.number")];
            dropdown(
                ui,
                &translate(theme, "commutation.storage"),
                &mut form.storage,
                ways.map(|(way, id)| (way, translate(theme, id))),
            );
        });
        if form.storage == Storage::Number {
            verdict_ui(ui, theme, Verdict::Warn, &TEXTS.text("commutation.number_words"));
        }
        let place = encoder.commutation.offset_location(&encoder.staged).ok();
        entry(ui, theme, &translate(theme, "commutation.field"), |ui| {
            let fields = encoder.staged.device().iter().map(|field| (Some(field.number), field.number.to_string()));
            let shown = form.field.or(place.map(|place| place.field));
            let mut chosen = shown;
            dropdown(ui, &translate(theme, "commutation.field"), &mut chosen, fields);
            if chosen != shown {
                form.field = chosen;
            }
        });
        let proposed = place.map(|place| place.address.to_string()).unwrap_or_default();
        number_ui(ui, theme, "commutation.address", &mut form.address, &proposed);
        let bytes = encoder.commutation.bytes(encoder.geometry(), &encoder.staged);
        if let Ok((_, _, bytes)) = &bytes {
            // Eight bytes per line, because sixteen do not fit beside the other column.
            let lines: Vec<String> = bytes.chunks(8).map(crate::bits::hex).collect();
            theme.sunken_frame().show(ui, |ui| ui.label(theme.monospace(lines.join("\n"))));
        }
        for found in stored(&encoder.staged) {
            stored_offset_ui(ui, theme, &found);
        }
        if let Some(words) = encoder.commutation.replacement_warning(encoder.geometry(), &encoder.staged) {
            verdict_ui(ui, theme, Verdict::Warn, &words);
        }
        ui.horizontal_wrapped(|ui| {
            let verified = encoder.commutation.check_offset_is_verified(encoder.geometry());
            let allowed = bytes.as_ref().map_err(Clone::clone).and(verified);
            if button_with_reason(ui, theme, &allowed, icons::MEMORY, &translate(theme, "commutation.store")).clicked()
            {
                actions.push(assistant_action(encoder, Assistant::Store));
            }
            let ready = encoder.session.is_ready() && encoder.staged.is_dirty();
            if primary_button(ui, theme, ready, icons::LIST_CHECKS, &translate(theme, "commutation.review")).clicked() {
                actions.push(Action::Command(encoder.session.id, DeviceCommand::Review));
            }
        });
        if let (Err(why), true) = (&bytes, encoder.commutation.offset(encoder.geometry()).is_ok()) {
            paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.bad));
        }
    });
}

fn stored_offset_ui(ui: &mut Ui, theme: &Theme, found: &StoredRecord) {
    let text = match found.record {
        Ok(record) => TEXTS
            .text("commutation.found")
            .with_number("degrees", record.offset.to_degrees(), 4)
            .with("pairs", record.pole_pairs),
        Err(_) => TEXTS.text("commutation.found_damaged"),
    };
    let text = text.with("field", found.field).with("address", found.address);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme.label(translate(theme, "commutation.found_title")));
        let colour = match (found.record.is_err(), found.edited) {
            (true, _) => theme.palette.bad,
            (false, true) => theme.palette.staged,
            (false, false) => theme.palette.text,
        };
        ui.label(RichText::new(theme.format_text(&text)).color(colour));
        if found.edited {
            ui.label(
                RichText::new(translate(theme, "commutation.found_edited")).color(theme.palette.staged).underline(),
            );
        }
    });
}

pub(super) fn position_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut Form, actions: &mut Vec<Action>) {
    folding_card(ui, theme, TEXTS.text("commutation.method_two"), |ui| {
        paragraph(ui, theme.label(translate(theme, "commutation.method_two_words")));
        if let Ok(inputs) = form.inputs(encoder.geometry()) {
            let text = TEXTS
                .text("commutation.step_value")
                .with_number("mechanical", inputs.motor.mechanical_step_deg(), 4)
                .with_number("electrical", inputs.motor.electrical_step_deg(), 2);
            row(ui, theme, &translate(theme, "commutation.step"), theme.monospace(theme.format_text(&text)));
        }
        number_ui(ui, theme, "commutation.period", &mut form.period, "0");
        let setting = encoder.commutation.setting(encoder.geometry());
        match &setting {
            Ok(setting) => {
                let value = format!("{} = {:X}h", setting.value, setting.value);
                row(ui, theme, &translate(theme, "commutation.position"), theme.monospace(value));
                let left = TEXTS.text("commutation.remaining_value").with_number("degrees", setting.remaining_deg, 2);
                row(ui, theme, &translate(theme, "commutation.remaining"), theme.monospace(theme.format_text(&left)));
                if setting.verdict == Verdict::Warn {
                    verdict_ui(ui, theme, Verdict::Warn, &TEXTS.text("commutation.weak"));
                }
            }
            Err(why) if encoder.commutation.offset(encoder.geometry()).is_ok() => {
                verdict_ui(ui, theme, Verdict::Fault, why);
            }
            Err(_) => {}
        }
        let allowed = setting.and(encoder.commutation.check_offset_is_verified(encoder.geometry()));
        let ready = if encoder.session.is_ready() { allowed } else { Err(TEXTS.text("commutation.not_ready")) };
        if button_with_reason(ui, theme, &ready, icons::CROSSHAIR, &translate(theme, "commutation.set")).clicked() {
            actions.push(assistant_action(encoder, Assistant::Set));
        }
    });
}

pub(super) fn report_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder) {
    let lines: Vec<String> = encoder
        .commutation
        .report_texts(&encoder.session.name(), encoder.geometry())
        .iter()
        .map(|line| theme.format_text(line))
        .collect();
    folding_card(ui, theme, TEXTS.text("commutation.report"), |ui| {
        for line in &lines {
            ui.add(egui::Label::new(line).wrap().selectable(true));
        }
        if enabled_button(ui, true, icons::COPY, &translate(theme, "commutation.copy")).clicked() {
            ui.ctx().copy_text(lines.join("\n"));
        }
    });
}
