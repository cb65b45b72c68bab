//! The scaling page, which calculates parameters 154 and 156 from the spindle pitch and the desired resolution.

use egui::Ui;

use crate::app::{Action, Text};
use crate::devices::hiperdrive::state::{
    Edit, HiperdriveAction as Hiperdrive, HiperdriveDevice, LimitsPolicy, PositionUnit, TEXTS, forms,
};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{
    card, committed_entry, enabled_button, entry, options, paragraph, row, show_error_below, text_entry,
};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct ScaleUiState {
    pitch: Option<(String, Option<Text>)>,
    step: String,
    stay_as_numbers: bool,
    refused: Option<Text>,
}

const ENTRY_WIDTH: f32 = 88.0;

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut ScaleUiState,
    actions: &mut Vec<Action>,
) {
    let (id, drive) = (unit.session.id, unit.drive());
    card(ui, theme, TEXTS.text("hd_scale.title"), |ui| {
        let word = translate(theme, "hd_scale.pitch");
        let pitch = unit.spindle_pitch(drive);
        let shown = pitch.map(|own| theme.format_significant_digits(own.nanometres as f64 / 1e6)).unwrap_or_default();
        entry(ui, theme, &word, |ui| {
            committed_entry(ui, &mut view.pitch, &shown, ENTRY_WIDTH, &word, |text| {
                let pitch = if text.trim().is_empty() { None } else { Some(forms::parse_length(text)?) };
                actions.push(Action::device(id, Hiperdrive::SetPitch(drive, pitch)));
                Ok(())
            });
            ui.label(theme.label(translate(theme, "hd_scale.a_turn")));
        });
        show_error_below(ui, theme, view.pitch.as_ref().and_then(|(_, why)| why.as_ref()));
        let word = translate(theme, "hd_scale.step");
        entry(ui, theme, &word, |ui| {
            text_entry(ui, &mut view.step, ENTRY_WIDTH, &word, "0.01");
            ui.label(theme.label(translate(theme, PositionUnit::Millimetres.unit())));
        });
        let word = translate(theme, "hd_scale.limits");
        entry(ui, theme, &word, |ui| {
            let ways = [(false, "hd_scale.in_place"), (true, "hd_scale.as_numbers")];
            options(ui, &word, &mut view.stay_as_numbers, ways.map(|(own, id)| (own, translate(theme, id))));
        });
        ui.horizontal(|ui| {
            let ready = pitch.is_some() && !view.step.trim().is_empty();
            if enabled_button(ui, ready, icons::RULER, &translate(theme, "hd_scale.set")).clicked()
                && let Some(pitch) = pitch
            {
                let limits = if view.stay_as_numbers { LimitsPolicy::AsNumbers } else { LimitsPolicy::InPlace };
                let scale = forms::parse_length(&view.step).and_then(|step| forms::scale(pitch, step));
                view.refused = scale
                    .map(|scale| {
                        let edit = Edit::Scale { drive, scale, limits };
                        actions.push(Action::device(id, Hiperdrive::Edit(Box::new(edit))));
                    })
                    .err();
            }
        });
        show_error_below(ui, theme, view.refused.as_ref());
        scale_effect_ui(ui, theme, unit);
        paragraph(ui, theme.caption(translate(theme, "hd_scale.words")));
    });
}

/// Draws what the edited scale means for one turn and for the limits.
fn scale_effect_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice) {
    let drive = unit.drive();
    let ruler = unit.edited_ruler(drive);
    let turn = format!(
        "{} {}",
        theme.format_significant_digits(ruler.scale.steps_per_turn()),
        translate(theme, PositionUnit::Steps.unit())
    );
    row(ui, theme, &translate(theme, "hd_scale.turn"), theme.monospace(turn));
    let Some((low, high)) = unit.staged.edited_values().and_then(|image| image.limits(drive)) else { return };
    for measure in [PositionUnit::Turns, PositionUnit::Millimetres] {
        if let Some((low, high)) = ruler.from_steps(low, measure).zip(ruler.from_steps(high, measure)) {
            let words = format!(
                "{} … {} {}",
                theme.format_number(low, 2),
                theme.format_number(high, 2),
                translate(theme, measure.unit())
            );
            row(ui, theme, &translate(theme, "hd_move.range"), theme.monospace(words));
        }
    }
}
