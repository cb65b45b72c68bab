//! The page for the axis set-up. The steps are listed on the left. The displayed step is on the right, with its task,
//! the axis position and the findings.
//!
//! While a step is shown, no clickable widget moves, whatever data arrives from the drive. Messages that can change are
//! therefore below all widgets. Only the user can change the step.

mod content;

use std::time::Duration;

use egui::{RichText, Ui};

use crate::app::{Action, Severity, Text};
use crate::devices::hiperdrive::protocol::ErrorCode;
use crate::devices::hiperdrive::state::axis::{
    Axis, AxisAction as Run, AxisButton, AxisStep, DriveFacts, LengthEntries, SetupEnd, StepStatus, labels,
    write_outcome_lines,
};
use crate::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, TEXTS, explain};
use crate::devices::hiperdrive::views::translate;
use crate::ui::controls::{
    button_with_reason, card, card_with_trailing, enabled_button, labelled_button, paragraph, primary_button, row,
    severity, split,
};
use crate::ui::widgets::{StepRow as Line, StepState, Steps, steps};
use crate::ui::{Theme, icons};

#[derive(Default)]
pub(super) struct AxisUiState {
    /// The displayed step, and the time at which it was first displayed, on the window's clock.
    since: Option<(AxisStep, f64)>,
}

impl AxisUiState {
    /// Returns how long the step has been displayed, or zero if it is new.
    fn display_duration(&mut self, step: AxisStep, now: f64) -> Duration {
        let since = self.since.filter(|(own, _)| *own == step).map_or(now, |(_, since)| since);
        self.since = Some((step, since));
        Duration::from_secs_f64((now - since).max(0.0))
    }
}

pub(crate) struct AxisPanel<'a> {
    unit: &'a HiperdriveDevice,
    axis: &'a Axis,
    seen: &'a DriveFacts,
    /// Time for which the current step has been displayed.
    looked_at: Duration,
}

impl AxisPanel<'_> {
    fn push(&self, actions: &mut Vec<Action>, action: Run) {
        actions.push(Action::device(self.unit.session.id, Hiperdrive::Axis(action)));
    }

    fn button_ui(
        &self,
        ui: &mut Ui,
        theme: &Theme,
        own: AxisButton,
        (icon, word): (&str, &str),
        actions: &mut Vec<Action>,
    ) {
        let allowed = self.axis.request(own, self.seen).map(|_| ());
        if button_with_reason(ui, theme, &allowed, icon, word).clicked() {
            self.push(actions, Run::Press(own));
        }
    }
}

const NUMBER_WIDTH: f32 = 15.0;
const PRIMARY_BUTTON_WIDTH: f32 = 112.0;
/// Window width below which the list of steps is placed above the step instead of beside it.
const MIN_TWO_COLUMN_WIDTH: f32 = 640.0;

pub(super) fn page_ui(
    ui: &mut Ui,
    theme: &Theme,
    unit: &HiperdriveDevice,
    view: &mut AxisUiState,
    actions: &mut Vec<Action>,
) {
    let Some(axis) = unit.axis() else {
        intro_ui(ui, theme, unit, actions);
        theme.add_gap(ui);
        notes_ui(ui, theme);
        return;
    };
    let seen = unit.drive_facts(unit.drive());
    let looked_at = view.display_duration(axis.step(), ui.input(|input| input.time));
    let shown = AxisPanel { unit, axis, seen: &seen, looked_at };
    if let Some(end) = axis.setup_end() {
        end_ui(ui, theme, &shown, end, actions);
        theme.add_gap(ui);
    }
    let goes_on = axis.setup_end().is_none();
    if ui.available_width() < MIN_TWO_COLUMN_WIDTH {
        // In a narrow window, the list is above the step. At the end, the list is the result.
        if goes_on {
            step_ui(ui, theme, &shown, actions);
        } else {
            card(ui, theme, TEXTS.text("hd_axis.title"), |ui| step_list_ui(ui, theme, &shown));
        }
        theme.add_gap(ui);
        notes_ui(ui, theme);
        return;
    }
    split(
        ui,
        theme,
        (0.36, MIN_TWO_COLUMN_WIDTH),
        actions,
        |ui, _| card(ui, theme, TEXTS.text("hd_axis.title"), |ui| step_list_ui(ui, theme, &shown)),
        |ui, actions| {
            if goes_on {
                step_ui(ui, theme, &shown, actions);
                theme.add_gap(ui);
            }
            notes_ui(ui, theme);
        },
    );
}

fn intro_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, actions: &mut Vec<Action>) {
    card(ui, theme, TEXTS.text("hd_axis.title"), |ui| {
        paragraph(ui, translate(theme, "hd_axis.words"));
        ui.add_space(theme.space.between);
        // The button is above the list, so that it is visible without scrolling in a low window.
        let allowed = unit.check_can_set_up();
        ui.horizontal(|ui| {
            if primary_button(ui, theme, allowed.is_ok(), icons::PLAY, &translate(theme, "hd_axis.begin")).clicked() {
                actions.push(Action::device(unit.session.id, Hiperdrive::Axis(Run::Begin)));
            }
            if let Err(why) = &allowed {
                warning_ui(ui, theme, why);
            }
        });
        ui.add_space(theme.space.between);
        // The rows have the height of text, not of buttons.
        ui.spacing_mut().interact_size.y = ui.text_style_height(&egui::TextStyle::Body);
        for (number, step) in (1..).zip(AxisStep::ALL) {
            ui.horizontal(|ui| {
                let size = egui::vec2(NUMBER_WIDTH, ui.spacing().interact_size.y);
                let layout = egui::Layout::right_to_left(egui::Align::Center);
                ui.allocate_ui_with_layout(size, layout, |ui| ui.label(theme.label(number.to_string())));
                ui.label(theme.label(theme.format_text(&labels::title(step))));
            });
        }
    });
}

fn step_list_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>) {
    let line = |step: AxisStep| {
        let reached = shown.axis.step_status(step);
        let state = match reached {
            StepStatus::Done => StepState::Done,
            StepStatus::Now => StepState::Waiting,
            StepStatus::Skipped => StepState::Skipped,
            StepStatus::Failed => StepState::Failed,
            StepStatus::Ahead => StepState::ToCome,
        };
        let has_result = matches!(reached, StepStatus::Done | StepStatus::Failed);
        let found = match (step, reached) {
            (AxisStep::Reference, StepStatus::Skipped) => Some(TEXTS.text("hd_axis.no_reference")),
            _ => labels::finding_text(shown.axis, step, shown.axis.displayed_facts(shown.seen)).filter(|_| has_result),
        };
        Line {
            title: theme.format_text(&labels::title(step)),
            state,
            word: theme.format_text(&labels::step_status(reached)),
            note: found.map(|text| with_nonbreaking_spaces(theme.format_text(&text))).unwrap_or_default(),
            ..Line::default()
        }
    };
    let lines: Vec<Line> = AxisStep::ALL.into_iter().map(line).collect();
    steps(ui, theme, &Steps { steps: &lines, ..Steps::default() });
}

fn step_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let (axis, seen) = (shown.axis, shown.seen);
    let step = axis.step();
    if shown.looked_at.is_zero() {
        ui.scroll_to_cursor(Some(egui::Align::TOP));
    }
    if let Err(left) = Axis::check_step_settled(shown.looked_at) {
        ui.ctx().request_repaint_after(left);
    }
    let place = AxisStep::ALL.iter().position(|own| *own == step).map_or(0, |at| at + 1);
    let aside = |ui: &mut Ui| {
        ui.label(theme.caption(format!("{place}/{}", AxisStep::ALL.len())));
        if shown.unit.drives().len() > 1 {
            let drive = TEXTS.text("hd_axis.of_drive").with("drive", axis.drive().get());
            ui.label(theme.caption(theme.format_text(&drive)));
        }
    };
    card_with_trailing(ui, theme, labels::title(step), aside, |ui| {
        paragraph(ui, with_nonbreaking_spaces(theme.format_text(&labels::step_instructions(step, seen))));
        ui.add_space(theme.space.between);
        live_ui(ui, theme, shown);
        ui.add_space(theme.space.between);
        let mut entries = axis.entries().localized(theme.language);
        content::content_ui(ui, theme, shown, &mut entries, actions);
        if entries != axis.entries().localized(theme.language) {
            shown.push(actions, Run::Edit(Box::new(entries.clone())));
        }
        theme.add_gap(ui);
        buttons_ui(ui, theme, shown, actions);
        ui.add_space(theme.space.between);
        messages_ui(ui, theme, shown, &entries);
    });
}

/// Draws the messages that can change: a fault, void results, missing conditions, and findings.
fn messages_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, entries: &LengthEntries) {
    let (axis, seen) = (shown.axis, shown.seen);
    let fallen = axis.invalidated_step().map(labels::invalidated_step);
    if let Some(why) = labels::fault_text(seen) {
        line_ui(ui, theme, Severity::Error, &why);
    }
    if let Some(why) = &fallen {
        line_ui(ui, theme, Severity::Error, why);
    }
    if let Some(why) = labels::unexplained_change_text(axis, seen) {
        warning_ui(ui, theme, &why);
    }
    if let (Err(why), None) = (axis.check_can_continue(seen), &fallen) {
        warning_ui(ui, theme, &why);
    }
    content::messages_ui(ui, theme, shown, entries);
    // The limits to be checked are shown large above.
    if let Some(found) = labels::finding_text(axis, axis.step(), seen).filter(|_| axis.step() != AxisStep::Confirm) {
        ui.add_space(theme.space.inside);
        row(ui, theme, &translate(theme, "hd_axis.now"), with_nonbreaking_spaces(theme.format_text(&found)));
    }
    if let (AxisStep::Request, Some(differences)) = (axis.step(), labels::differences(seen)) {
        warning_ui(ui, theme, &differences);
    }
}

fn live_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>) {
    theme.sunken_frame().show(ui, |ui| {
        crate::ui::controls::fill_width(ui);
        let position = shown.seen.position.map_or_else(
            || translate(theme, "hd_axis.none"),
            |position| theme.format_text(&labels::millimetres_text(shown.seen.ruler(), position.into())),
        );
        row(ui, theme, &translate(theme, "hd_axis.position"), theme.value(position));
        let state = shown.seen.actual.map_or_else(
            || translate(theme, "hd_axis.none"),
            |actual| theme.format_text(&explain::state_text(actual.status.state())),
        );
        let code = shown.seen.error.filter(|code| *code != ErrorCode::NONE);
        let state = match (shown.seen.has_failed(), code) {
            (false, _) => RichText::new(state),
            (true, None) => RichText::new(state).color(theme.palette.bad),
            (true, Some(code)) => RichText::new(format!("{state} {:04X}", code.code())).color(theme.palette.bad),
        };
        row(ui, theme, &translate(theme, "hd_axis.state"), state);
    });
}

/// Draws the buttons Back, Cancel and Next. Cancel also stops the motion. Next is enabled when the step is complete.
fn buttons_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let (axis, seen) = (shown.axis, shown.seen);
    let settled = Axis::check_step_settled(shown.looked_at).is_ok();
    let step = axis.step();
    let allowed = axis.check_can_continue(seen);
    ui.horizontal_wrapped(|ui| {
        if enabled_button(
            ui,
            settled && axis.can_go_back(seen),
            icons::ARROW_U_UP_LEFT,
            &translate(theme, "hd_axis.back"),
        )
        .clicked()
        {
            shown.push(actions, Run::Back);
        }
        if labelled_button(ui, icons::X, &translate(theme, "hd_axis.cancel")).clicked() {
            shown.push(actions, Run::Cancel);
        }
        let word = translate(theme, if step == AxisStep::PowerCycle { "hd_axis.finish" } else { "hd_axis.next" });
        right_aligned_ui(ui, |ui| {
            if primary_button(ui, theme, settled && allowed.is_ok(), icons::CARET_RIGHT, &word).clicked() {
                shown.push(actions, Run::Next);
            }
        });
    });
}

fn skip_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let step = shown.axis.step();
    if step.is_optional() {
        let id = if step == AxisStep::Reference { "hd_axis.skip_reference" } else { "hd_axis.skip_power" };
        let allowed = Axis::check_step_settled(shown.looked_at).is_ok() && shown.axis.can_skip(shown.seen);
        if enabled_button(ui, allowed, "", &translate(theme, id)).clicked() {
            shown.push(actions, Run::Skip);
        }
    }
}

/// Returns the string with non-breaking spaces between numbers and their units.
fn with_nonbreaking_spaces(words: String) -> String {
    words.replace(" mm", "\u{a0}mm").replace(" %", "\u{a0}%")
}

/// Draws content with the height of a button at the right end of a line. If there is not enough space beside other
/// buttons, it is placed below them.
fn right_aligned_ui(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let rest = ui.available_size_before_wrap().x;
    let width = if rest >= PRIMARY_BUTTON_WIDTH { rest } else { ui.available_width() };
    let size = egui::vec2(width.max(0.0), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, egui::Layout::right_to_left(egui::Align::Center), content);
}

fn end_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, end: SetupEnd, actions: &mut Vec<Action>) {
    let axis = shown.axis;
    let title = if end == SetupEnd::Done { "hd_axis.ended" } else { "hd_axis.cancelled" };
    card(ui, theme, TEXTS.text(title), |ui| {
        ui.horizontal_wrapped(|ui| {
            if enabled_button(
                ui,
                shown.unit.check_can_set_up().is_ok(),
                icons::PLAY,
                &translate(theme, "hd_axis.again"),
            )
            .clicked()
            {
                shown.push(actions, Run::Begin);
            }
            if labelled_button(ui, icons::FLOPPY_DISK, &translate(theme, "hd_axis.save_report")).clicked() {
                shown.push(actions, Run::AskReport);
            }
            if labelled_button(ui, icons::COPY, &translate(theme, "hd_axis.copy_report")).clicked()
                && let Some(report) = shown.unit.axis_report(theme.language)
            {
                ui.ctx().copy_text(report);
            }
            write_back_button_ui(ui, theme, shown, actions);
        });
        ui.add_space(theme.space.inside);
        if end == SetupEnd::Cancelled {
            line_ui(ui, theme, Severity::Note, &TEXTS.text("hd_axis.stands"));
        }
        let weight = if axis.is_saved() || axis.changes().is_empty() { Severity::Note } else { Severity::Warning };
        for text in write_outcome_lines(axis, shown.seen) {
            line_ui(ui, theme, weight, &text);
        }
    });
}

fn write_back_button_ui(ui: &mut Ui, theme: &Theme, shown: &AxisPanel<'_>, actions: &mut Vec<Action>) {
    let word = translate(theme, "hd_axis.recall");
    shown.button_ui(ui, theme, AxisButton::Recall, (icons::ARROW_COUNTER_CLOCKWISE, &word), actions);
}

fn notes_ui(ui: &mut Ui, theme: &Theme) {
    card(ui, theme, TEXTS.text("hd_axis.notes"), |ui| {
        for id in [
            "hd_axis.note_stop",
            "hd_axis.note_controller",
            "hd_axis.note_reference",
            "hd_axis.note_jog",
            "hd_axis.note_factory",
            "hd_axis.note_words",
        ] {
            line_ui(ui, theme, Severity::Note, &TEXTS.text(id));
        }
    });
}

fn line_ui(ui: &mut Ui, theme: &Theme, own: Severity, text: &Text) {
    let (icon, ink) = severity(theme, own);
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(ink));
        paragraph(ui, theme.format_text(text));
    });
}

fn warning_ui(ui: &mut Ui, theme: &Theme, why: &Text) {
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icons::WARNING).color(theme.palette.warn));
        paragraph(ui, RichText::new(theme.format_text(why)).color(theme.palette.warn));
    });
}
