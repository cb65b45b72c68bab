//! Selection of the machine's unit and zero position.

use egui::Ui;

use crate::app::{Action, Text};
use crate::devices::interbus::profile::{Scale, Unit};
use crate::devices::interbus::state::{Encoder, InterbusAction as Interbus, TEXTS, forms};
use crate::devices::interbus::views::translate;
use crate::ui::Theme;
use crate::ui::controls::{committed_entry, dropdown, entry, folding_card, paragraph, show_error_below};

/// Typed text that has not been applied yet.
#[derive(Default)]
pub(super) struct CamScaleUiState {
    steps: Option<(String, Option<Text>)>,
    zero: Option<(String, Option<Text>)>,
}

const ENTRY_WIDTH: f32 = 112.0;

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut CamScaleUiState,
    actions: &mut Vec<Action>,
) {
    folding_card(ui, theme, TEXTS.text("ib_scale.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ib_scale.words")));
        let (scale, range) = (&encoder.scale, encoder.step_count());
        let id = encoder.session.id;
        let mut set = |scale: Scale| actions.push(Action::device(id, Interbus::SetScale(scale)));
        let word = translate(theme, "ib_scale.unit");
        let mut unit = scale.unit();
        entry(ui, theme, &word, |ui| {
            let units = [
                (Unit::Steps, "ib_scale.steps"),
                (Unit::Degrees, "ib_scale.degrees"),
                (Unit::Millimetres, "ib_scale.millimetres"),
            ];
            if dropdown(ui, &word, &mut unit, units.map(|(unit, id)| (unit, translate(theme, id)))) {
                set(forms::default_scale(unit, scale.zero(), range));
            }
        });
        if let Some(steps) = forms::steps_per_unit(scale) {
            let word = translate(
                theme,
                match scale.unit() {
                    Unit::Degrees => "ib_scale.steps_in_turn",
                    _ => "ib_scale.steps_in_millimetre",
                },
            );
            entry(ui, theme, &word, |ui| {
                committed_entry(
                    ui,
                    &mut view.steps,
                    &theme.format_significant_digits(steps),
                    ENTRY_WIDTH,
                    &word,
                    |text| {
                        set(forms::scale(scale.unit(), text, scale.zero())?);
                        Ok(())
                    },
                );
            });
            show_error_below(ui, theme, view.steps.as_ref().and_then(|own| own.1.as_ref()));
        }
        let word = translate(theme, "ib_scale.zero");
        entry(ui, theme, &word, |ui| {
            committed_entry(ui, &mut view.zero, &scale.zero().to_string(), ENTRY_WIDTH, &word, |text| {
                set(forms::scale_with_zero(scale, text, range)?);
                Ok(())
            });
        });
        show_error_below(ui, theme, view.zero.as_ref().and_then(|own| own.1.as_ref()));
    });
}
