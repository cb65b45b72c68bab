//! The card for setting the position. It shows the new position in a selectable unit and in all other units, and a
//! button to undo the last change.

use egui::Ui;

use super::setup::submit_plan;
use crate::app::{Action, Text};
use crate::devices::hiperface::jobs::Change;
use crate::devices::hiperface::protocol::Geometry;
use crate::devices::hiperface::state::{
    Encoder, HiperfaceAction as Hiperface, PositionEntry, PositionUnit, TEXTS, position_text,
};
use crate::devices::hiperface::views::translate;
use crate::ui::controls::{card, enabled_button, entry, options, paragraph, row, show_error_below, text_entry};
use crate::ui::{Theme, icons};

const VALUE: f32 = 112.0;
const TURNS: f32 = 56.0;
const ANGLE: f32 = 80.0;

#[derive(Default)]
pub(super) struct PositionUiState {
    entry: PositionEntry,
    exact: bool,
    synchronise: bool,
    kit: bool,
    problem: Option<Text>,
}

pub(super) fn card_ui(
    ui: &mut Ui,
    theme: &Theme,
    encoder: &Encoder,
    view: &mut PositionUiState,
    actions: &mut Vec<Action>,
) {
    let geometry = encoder.identity.as_ref().and_then(|identity| identity.geometry);
    let kit = encoder.identity.as_ref().and_then(|identity| identity.kit);
    card(ui, theme, TEXTS.text("position_card.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "position_card.words")));
        let place = |steps: Option<u32>| {
            let words = steps.map(|steps| theme.format_text(&position_text(steps, geometry)));
            // Steps and angle are on separate lines even if there is no value, so that the layout below does not shift.
            theme.monospace(words.unwrap_or_else(|| "– · ".to_owned()).replace(" · ", "\n"))
        };
        row(ui, theme, &translate(theme, "position_card.now"), place(encoder.record.last().map(|own| own.raw)));
        entry_ui(ui, theme, geometry, &mut view.entry);
        row(ui, theme, &translate(theme, "position_card.means"), place(view.entry.steps(geometry).ok()));
        ui.checkbox(&mut view.exact, translate(theme, "position_card.exact"))
            .on_hover_text(translate(theme, "position_card.exact_hint"));
        let hint = translate(theme, "position_card.synchronise_hint");
        ui.add_enabled_ui(kit != Some(false), |ui| {
            ui.checkbox(&mut view.synchronise, translate(theme, "position_card.synchronise"))
                .on_hover_text(&hint)
                .on_disabled_hover_text(&hint);
        });
        if view.synchronise && kit.is_none() {
            ui.checkbox(&mut view.kit, translate(theme, "position_card.kit"));
        }
        paragraph(ui, theme.caption(translate(theme, "position_card.not_restored")));
        if enabled_button(ui, encoder.session.is_ready(), icons::CROSSHAIR, &translate(theme, "position_card.plan"))
            .clicked()
        {
            let (exact, kit) = (view.exact, view.kit);
            let synchronise = view.synchronise && encoder.identity.as_ref().is_some_and(|own| own.kit != Some(false));
            let wanted = view.entry.steps(geometry);
            let change = wanted.map(|wanted| Change::SetPosition { wanted, exact, synchronise, kit });
            submit_plan(encoder, change, &mut view.problem, actions);
        }
        show_error_below(ui, theme, view.problem.as_ref());
        undo_ui(ui, theme, encoder, geometry, actions);
    });
}

/// Draws the input field for the new position and its unit. If the user changes the unit, the typed position is
/// converted.
fn entry_ui(ui: &mut Ui, theme: &Theme, geometry: Option<Geometry>, own: &mut PositionEntry) {
    let units = PositionUnit::available(geometry);
    if !units.contains(&own.unit) {
        own.unit = PositionUnit::default();
    }
    let mut unit = own.unit;
    let word = translate(theme, "position_card.unit");
    entry(ui, theme, &word, |ui| {
        options(ui, &word, &mut unit, units.iter().map(|unit| (*unit, translate(theme, unit.word()))));
    });
    if unit != own.unit {
        *own = own.converted(unit, geometry);
        own.value = theme.digits(&own.value);
    }
    let word = translate(theme, "position_card.wanted");
    entry(ui, theme, &word, |ui| {
        let [turns, degrees] = ["position_card.turns", "position_card.degrees"].map(|id| translate(theme, id));
        if own.unit != PositionUnit::TurnsAndDegrees {
            text_entry(ui, &mut own.value, VALUE, &word, "");
            return;
        }
        text_entry(ui, &mut own.turns, TURNS, &turns, "");
        ui.label(theme.label(&turns));
        text_entry(ui, &mut own.value, ANGLE, &degrees, "");
        ui.label(theme.label(degrees));
    });
}

/// Draws the last change of the position, with a button to undo it. Only this program records the change, because the
/// encoder does not report it.
fn undo_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, geometry: Option<Geometry>, actions: &mut Vec<Action>) {
    let Some((from, to)) = encoder.position_set else { return };
    let steps = i64::from(from) - i64::from(to);
    let [from, to] = [from, to].map(|steps| position_text(steps, geometry));
    let text = TEXTS.text("position_card.last").with_text("from", from).with_text("to", to);
    ui.horizontal_wrapped(|ui| {
        ui.label(theme.label(theme.format_text(&text)));
        let undo = translate(theme, "position_card.undo");
        if enabled_button(ui, encoder.session.is_ready(), icons::ARROW_U_UP_LEFT, &undo).clicked() {
            actions.push(Action::device(encoder.session.id, Hiperface::Plan(Change::ShiftPosition { steps })));
        }
    });
}
