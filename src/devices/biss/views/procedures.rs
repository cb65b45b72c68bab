//! The page for guided procedures, the filter and the preset. It shows the selected procedures and the motor, followed
//! by the current task, the progress and the result of each step.

use egui::{RichText, Ui};

use super::{motor, run};
use crate::app::session::Phase;
use crate::app::{Action, AnyDevice, SessionId, Studio, Text};
use crate::devices::biss::jobs::Change;
use crate::devices::biss::profile::{MotorSource, MountingSteps, PresetParts};
use crate::devices::biss::protocol::{DeviceMode, PositionFilter, ProcedureKind};
use crate::devices::biss::state::explain as explained;
use crate::devices::biss::state::{BissAction as Biss, Encoder, TEXTS, format, forms::PresetForm};
use crate::devices::biss::views::translate;
use crate::ui::controls::{
    button_with_reason, card, empty_placeholder, enabled_button, folding_card, labelled_number_entry, options,
    paragraph, row, show_error_below, two_columns,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct ProceduresUiState {
    motor: Option<MotorSource>,
    calibrate: bool,
    wiegand: bool,
    save_result: bool,
    with_preset: bool,
    data: Option<SessionId>,
    preset: Option<PresetForm>,
}

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    encoder: &Encoder,
    view: &mut ProceduresUiState,
    actions: &mut Vec<Action>,
) {
    if let Some(guide) = &encoder.guide {
        run::guide_ui(ui, theme, encoder, guide, actions);
        return;
    }
    let Some(description) = encoder.description.as_ref().filter(|_| encoder.session.phase != Phase::Offline) else {
        empty_placeholder(ui, theme, &translate(theme, "procedures.nothing"), None);
        return;
    };
    if description.procedures().is_empty() {
        empty_placeholder(ui, theme, &translate(theme, "procedures.none"), None);
        return;
    }
    left_state_ui(ui, theme, encoder, actions);
    let form = view.preset.get_or_insert_with(|| stored_preset_form(encoder));
    let mut mounting = Mounting {
        motor: &mut view.motor,
        calibrate: &mut view.calibrate,
        wiegand: &mut view.wiegand,
        save_result: &mut view.save_result,
        with_preset: &mut view.with_preset,
        data: &mut view.data,
        form,
    };
    two_columns(
        ui,
        theme,
        (actions, &mut mounting),
        |ui, (actions, mounting)| {
            mounting_ui(ui, theme, studio, encoder, mounting, actions);
        },
        |ui, (actions, mounting)| {
            preset_ui(ui, theme, encoder, mounting.form, actions);
            theme.add_gap(ui);
            if let Some(motor) = &encoder.motor {
                motor::card_ui(ui, theme, encoder, motor, actions);
                theme.add_gap(ui);
            }
            filter_ui(ui, theme, encoder, actions);
        },
    );
}

struct Mounting<'v> {
    motor: &'v mut Option<MotorSource>,
    calibrate: &'v mut bool,
    wiegand: &'v mut bool,
    save_result: &'v mut bool,
    with_preset: &'v mut bool,
    data: &'v mut Option<SessionId>,
    form: &'v mut PresetForm,
}

fn stored_preset_form(encoder: &Encoder) -> PresetForm {
    let value = encoder.survey.as_ref().and_then(|survey| survey.preset);
    let layout = encoder.identity().map(|identity| &identity.layout);
    value.zip(layout).map(|(value, layout)| PresetForm::from_value(value, layout)).unwrap_or_default()
}

fn left_state_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let Some(status) = &encoder.status else { return };
    let elsewhere = status.mode.is_some_and(|mode| mode != DeviceMode::OPERATION);
    if !elsewhere && status.protection.is_none_or(|protection| protection == 0) {
        return;
    }
    card(ui, theme, TEXTS.text("lead_back_card.title"), |ui| {
        let mode = explained::mode_text(status.mode.unwrap_or_default());
        let text = TEXTS.text("lead_back_card.words").with_text("mode", mode);
        paragraph(ui, RichText::new(theme.format_text(&text)).color(theme.palette.warn));
        super::return_to_operation_ui(ui, theme, encoder, actions);
    });
    theme.add_gap(ui);
}

fn mounting_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    encoder: &Encoder,
    own: &mut Mounting<'_>,
    actions: &mut Vec<Action>,
) {
    card(ui, theme, TEXTS.text("mounting_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "mounting_card.words")));
        ui.add_space(theme.space.inside);
        ui.label(translate(theme, "mounting_card.motor"));
        let sources = [
            (Some(MotorSource::Other), translate(theme, "mounting_card.other")),
            (Some(MotorSource::ThisEncoder), translate(theme, "mounting_card.this_encoder")),
        ];
        options(ui, &translate(theme, "mounting_card.motor"), own.motor, sources);
        let refused = *own.motor == Some(MotorSource::ThisEncoder);
        if refused {
            paragraph(ui, RichText::new(translate(theme, "mounting_card.refused")).color(theme.palette.bad));
        }
        ui.add_space(theme.space.between);
        ui.label(translate(theme, "mounting_card.what"));
        procedure_checkbox_ui(
            ui,
            theme,
            own.calibrate,
            "mounting_card.calibrate",
            &explained::calibration_requirements_text(),
        );
        procedure_checkbox_ui(ui, theme, own.wiegand, "mounting_card.wiegand", &explained::wiegand_requirements_text());
        ui.add_enabled_ui(*own.wiegand, |ui| {
            ui.horizontal(|ui| {
                indent_like_checkbox(ui);
                ui.checkbox(own.save_result, translate(theme, "mounting_card.save"));
            });
        });
        ui.checkbox(own.with_preset, translate(theme, "mounting_card.preset"));
        data_profile_choice_ui(ui, theme, studio, own.data);
        ui.add_space(theme.space.between);
        let wish = requested_procedures(encoder, own);
        let ready = if encoder.session.is_ready() { Ok(()) } else { Err(Text::new("session.not_ready")) };
        let allowed = ready.and(wish.as_ref().map(|_| ()).map_err(Clone::clone));
        if button_with_reason(ui, theme, &allowed, icons::LIST_CHECKS, &translate(theme, "mounting_card.review"))
            .clicked()
            && let Ok(run) = wish
        {
            let motor = own.motor.unwrap_or(MotorSource::Other);
            let plan = Biss::PlanMounting { run: Box::new(run), motor, data: *own.data };
            actions.push(Action::device(encoder.session.id, plan));
        }
    });
}

fn procedure_checkbox_ui(ui: &mut Ui, theme: &Theme, on: &mut bool, id: &'static str, words: &Text) {
    ui.checkbox(on, translate(theme, id));
    ui.horizontal_top(|ui| {
        indent_like_checkbox(ui);
        paragraph(ui, theme.caption(theme.format_text(words)));
    });
}

/// Indents the next widget in a row to align it with the text of the checkbox above.
fn indent_like_checkbox(ui: &mut Ui) {
    ui.add_space(ui.spacing().icon_width + ui.spacing().icon_spacing);
}

/// Returns the selected procedures, or the reason why they cannot be planned yet.
fn requested_procedures(encoder: &Encoder, own: &Mounting<'_>) -> Result<MountingSteps, Text> {
    let turns = *own.calibrate || *own.wiegand;
    match own.motor {
        None if turns => return Err(TEXTS.text("mounting_card.no_motor")),
        Some(MotorSource::ThisEncoder) if turns => return Err(TEXTS.text("mounting_card.refused")),
        _ => {}
    }
    let preset = if *own.with_preset {
        let layout = encoder.identity().map(|identity| &identity.layout);
        let layout = layout.ok_or_else(|| Text::new("session.not_ready"))?;
        Some((own.form.value(layout)?, PresetParts::Both))
    } else {
        None
    };
    if !turns && preset.is_none() && own.data.is_none() {
        return Err(TEXTS.text("mounting_card.nothing"));
    }
    let wiegand = own.wiegand.then_some(*own.save_result);
    Ok(MountingSteps { calibrate: *own.calibrate, wiegand, preset, data: None })
}

fn data_profile_choice_ui(ui: &mut Ui, theme: &Theme, studio: &Studio, data: &mut Option<SessionId>) {
    let profiles: Vec<&AnyDevice> = studio
        .devices()
        .iter()
        .map(Box::as_ref)
        .filter(|own| own.get::<Encoder>().is_some_and(|own| own.profile().is_some()))
        .collect();
    if data.is_some_and(|own| profiles.iter().all(|other| other.id() != own)) {
        *data = None;
    }
    if profiles.is_empty() {
        ui.add_enabled(false, egui::Checkbox::new(&mut false, translate(theme, "mounting_card.data")))
            .on_disabled_hover_text(translate(theme, "mounting_card.no_profile"));
        return;
    }
    for profile in profiles {
        let mut on = *data == Some(profile.id());
        let text = TEXTS.text("mounting_card.data_of").with("name", profile.name());
        if ui.checkbox(&mut on, theme.format_text(&text)).changed() {
            *data = on.then(|| profile.id());
        }
    }
}

fn preset_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, form: &mut PresetForm, actions: &mut Vec<Action>) {
    card(ui, theme, TEXTS.text("preset_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "preset_card.words")));
        let Some(identity) = encoder.identity() else { return };
        let layout = &identity.layout;
        labelled_number_entry(ui, theme, TEXTS.text("preset_card.degrees"), &mut form.degrees, 96.0, "270");
        labelled_number_entry(ui, theme, TEXTS.text("preset_card.turns"), &mut form.turns, 96.0, "0");
        // Only the first error is shown, together with the name of its entry.
        show_error_below(
            ui,
            theme,
            form.parse_singleturn(layout).err().or(form.parse_multiturn(layout).err()).as_ref(),
        );
        let value = form.value(layout);
        // The encoder uses the saved value, not the entered value.
        let saved = encoder.survey.as_ref().and_then(|survey| survey.preset);
        let is_saved = saved.is_none() || value.as_ref().ok().copied() == saved;
        let ready = encoder.session.is_ready();
        let plan = |value, parts| Biss::Plan(Box::new(Change::Preset { value, parts }));
        ui.horizontal_wrapped(|ui| {
            let word = translate(theme, "preset_card.store");
            if enabled_button(ui, ready && value.is_ok(), icons::FLOPPY_DISK, &word).clicked() {
                actions.push(Action::device(encoder.session.id, plan(value.ok(), None)));
            }
        });
        ui.add_space(theme.space.inside);
        if let Some(stored) = encoder.survey.as_ref().and_then(|survey| survey.preset) {
            let words = theme.format_text(&explained::preset_value_text(stored, layout.singleturn_bits()));
            row(ui, theme, &translate(theme, "preset_card.stored"), theme.monospace(words));
        }
        let fire_words = if is_saved { "preset_card.fire_words" } else { "preset_card.save_first" };
        paragraph(ui, theme.label(translate(theme, fire_words)));
        ui.horizontal_wrapped(|ui| {
            for (parts, id) in [
                (PresetParts::Both, "preset_card.both"),
                (PresetParts::Singleturn, "preset_card.singleturn"),
                (PresetParts::Multiturn, "preset_card.multiturn"),
            ] {
                if enabled_button(ui, ready && is_saved, icons::TARGET, &translate(theme, id)).clicked() {
                    actions.push(Action::device(encoder.session.id, plan(None, Some(parts))));
                }
            }
        });
    });
}

fn filter_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let has = encoder.description.as_ref().is_some_and(|own| own.procedure(ProcedureKind::FilterSelection).is_some());
    if !has {
        return;
    }
    folding_card(ui, theme, TEXTS.text("filter_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "filter_card.words")));
        let own = encoder.status.as_ref().and_then(|status| status.filter);
        for (filter, hint) in
            [(PositionFilter::Balanced, "filter_card.balanced"), (PositionFilter::Dynamic, "filter_card.dynamic")]
        {
            ui.horizontal_wrapped(|ui| {
                let word = theme.format_text(&format::filter(filter));
                let is_own = own == Some(filter);
                let ready = encoder.session.is_ready() && !is_own;
                if is_own {
                    ui.label(RichText::new(icons::CHECK_CIRCLE).color(theme.palette.good));
                    ui.label(&word);
                } else if enabled_button(ui, ready, icons::SLIDERS, &word).clicked() {
                    let change = Box::new(Change::SelectFilter(filter));
                    actions.push(Action::device(encoder.session.id, Biss::Plan(change)));
                }
                ui.label(theme.caption(translate(theme, hint)));
            });
        }
    });
}
