//! The display of a running guided procedure: steps, current task, measured and allowed values, and the result.

use egui::{RichText, Ui};

use super::motor;
use crate::app::{Action, Severity};
use crate::devices::biss::procedures::procedure::{
    MotorRun, OperatorAdvice, OperatorAnswer, OperatorPrompt, OperatorTask, StepDetail,
};
use crate::devices::biss::profile::Op;
use crate::devices::biss::state::explain as says;
use crate::devices::biss::state::{BissAction as Biss, Encoder, ProcedureEnd, ProcedureRun, StepStatus, TEXTS};
use crate::devices::biss::views::translate;
use crate::ui::controls::{card, labelled_button, paragraph, severity};
use crate::ui::widgets::{Gauge, StepRow, StepState, Steps, StepsEvent, steps};
use crate::ui::{Theme, icons};

pub(super) fn guide_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, guide: &ProcedureRun, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    // The view scrolls to the result as soon as it is available.
    let is_over = guide.end.is_some();
    let seen = ui.scope_id().with("end");
    if is_over && !ui.data(|data| data.get_temp(seen)).unwrap_or(false) {
        ui.scroll_to_cursor(Some(egui::Align::Min));
    }
    ui.data_mut(|data| data.insert_temp(seen, is_over));
    if let Some(end) = &guide.end {
        end_ui(ui, theme, encoder, guide.operations(), end, actions);
        theme.add_gap(ui);
    }
    if let Some(motor) = encoder.motor.as_ref().filter(|_| guide.is_running()) {
        motor::card_ui(ui, theme, encoder, motor, actions);
        theme.add_gap(ui);
    }
    card(ui, theme, TEXTS.text("guide.title"), |ui| {
        let list: Vec<StepRow> = guide
            .steps()
            .iter()
            .map(|own| step_row(theme, guide, own.op, own.is_first, own.step, own.reached))
            .collect();
        let demand = guide.operator_prompt();
        let why = demand.and_then(|own| own.blockers.first()).map(|own| theme.format_text(&says::blocker_text(*own)));
        let word = translate(
            theme,
            match demand.map(|own| own.task) {
                Some(OperatorTask::HoldStill | OperatorTask::HoldAtPresetAngle) => "guide.go_on",
                _ => "guide.start",
            },
        );
        let start = demand.map(|_| (word.as_str(), why.as_deref().map_or(Ok(()), Err)));
        let skip = translate(theme, "guide.skip");
        let model = Steps { steps: &list, start, skip: demand.map(|_| skip.as_str()) };
        let event = steps(ui, theme, &model);
        match (event, demand) {
            (Some(StepsEvent::Start), Some(own)) => {
                actions.push(Action::device(id, Biss::Answer(own.task, OperatorAnswer::Go)));
            }
            (Some(StepsEvent::Skip), Some(own)) => {
                actions.push(Action::device(id, Biss::Answer(own.task, OperatorAnswer::Skip)));
            }
            _ => {}
        }
    });
}

#[allow(clippy::too_many_arguments, reason = "a step is told what it is of")]
fn step_row(
    theme: &Theme,
    guide: &ProcedureRun,
    op: &Op,
    is_first: bool,
    own: crate::devices::biss::procedures::procedure::ProcedureStep,
    reached: StepStatus,
) -> StepRow {
    let what = theme.format_text(&says::procedure_step_text(own));
    let title = if is_first { format!("{} · {what}", theme.format_text(&says::procedure_text(op))) } else { what };
    let (state, word) = match reached {
        StepStatus::Done => (StepState::Done, "guide.done"),
        StepStatus::Waits => (StepState::Waiting, "guide.waits"),
        StepStatus::Runs => (StepState::Running, "guide.runs"),
        StepStatus::Skipped => (StepState::Skipped, "guide.left_out"),
        StepStatus::Failed => (StepState::Failed, "guide.failed"),
        StepStatus::Cancelled => (StepState::Skipped, "guide.cancelled"),
        StepStatus::Ahead => (StepState::ToCome, "guide.ahead"),
    };
    let mut step = StepRow { title, state, word: translate(theme, word), ..StepRow::default() };
    match (reached, guide.step_detail()) {
        (StepStatus::Waits, Some(StepDetail::Demand(demand))) => {
            // The recommended speed is not listed, because it is already marked on the gauges.
            let lasting = demand.advice.iter().filter(|own| !matches!(own, OperatorAdvice::Speed { .. }));
            let notes: Vec<String> = lasting.map(|own| theme.format_text(&says::advice_text(*own))).collect();
            step.note = notes.join("\n");
            step.gauges = speed_gauges(theme, demand);
        }
        (StepStatus::Runs, Some(StepDetail::Count { done, total })) => {
            step.progress = Some(*done as f32 / (*total).max(1) as f32);
            step.note = format!("{done}/{total}");
        }
        (StepStatus::Runs, Some(StepDetail::Lasts { elapsed, expected })) => {
            step.progress = expected.map(|expected| (elapsed.as_secs_f32() / expected.as_secs_f32().max(0.1)).min(1.0));
            step.note = format!("{} s", theme.format_number(elapsed.as_secs_f64(), 0));
        }
        _ => {}
    }
    step
}

/// Returns the gauges shown while the operator turns the motor. They are marked with the limits for the start of the
/// run.
fn speed_gauges(theme: &Theme, demand: &OperatorPrompt) -> Vec<Gauge> {
    let OperatorTask::Turn(run) = demand.task else { return Vec::new() };
    let mut gauges = vec![speed(theme, run, demand)];
    if let Some(fluctuation) = run.max_fluctuation() {
        let unit = theme.translate("unit.revolutions_per_minute");
        let spread = demand.motion.map(|own| own.spread);
        let accepted =
            run.accepted_fluctuation(demand.motion.map_or(run.recommended_range().midpoint(), |own| own.rpm));
        gauges.push(Gauge {
            name: translate(theme, "guide.fluctuation"),
            value: spread,
            shown: spread.map(|spread| format!("±{} {unit}", theme.format_number(spread, 1))).unwrap_or_default(),
            allowed: 0.0..=accepted,
            best: Some(0.0..=fluctuation),
            limits: format!("±{} {unit}", theme.format_number(fluctuation, 0)),
            scale: 0.0..=accepted * 2.0,
        });
    }
    if run.is_calibration() {
        let celsius = demand.celsius.map(f64::from);
        let (coldest, warmest) = (*OperatorPrompt::CELSIUS.start(), *OperatorPrompt::CELSIUS.end());
        gauges.push(Gauge {
            name: translate(theme, "biss_status.temperature"),
            value: celsius,
            shown: celsius.map(|celsius| format!("{} °C", theme.format_number(celsius, 0))).unwrap_or_default(),
            allowed: f64::from(coldest)..=f64::from(warmest),
            best: None,
            limits: format!("{coldest}…{warmest} °C"),
            scale: f64::from(coldest) - 15.0..=f64::from(warmest) + 15.0,
        });
    }
    gauges
}

fn speed(theme: &Theme, run: MotorRun, demand: &OperatorPrompt) -> Gauge {
    let sign = if run.is_clockwise() { 1.0 } else { -1.0 };
    let (allowed, accepted, best) =
        (run.allowed_speeds(), run.allowed_speeds().with_tolerance(), run.recommended_range());
    // Standstill is shown as 0 without a sign.
    let rpm = demand.motion.map(|own| if own.rpm.abs() < 0.05 { 0.0 } else { own.rpm * sign });
    let is_best = best != allowed;
    let limits = TEXTS
        .text(if is_best { "guide.rpm_range_best" } else { "guide.rpm_range" })
        .with_number("least", allowed.least, 0)
        .with_number("greatest", allowed.greatest, 0)
        .with_number("best", best.midpoint(), 0);
    let unit = theme.translate("unit.revolutions_per_minute");
    Gauge {
        name: translate(theme, if run.is_clockwise() { "guide.speed_cw" } else { "guide.speed_ccw" }),
        value: rpm,
        shown: rpm.map(|rpm| format!("{} {unit}", theme.format_number(rpm, 1))).unwrap_or_default(),
        allowed: accepted.least..=accepted.greatest,
        best: is_best.then_some(best.least..=best.greatest),
        limits: theme.format_text(&limits),
        scale: -allowed.greatest * 0.25..=allowed.greatest * 1.25,
    }
}

fn end_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ops: &[Op], end: &ProcedureEnd, actions: &mut Vec<Action>) {
    let id = encoder.session.id;
    let title = match end {
        ProcedureEnd::Done(_) => "guide.report",
        ProcedureEnd::Failed { .. } => "guide.ended_early",
    };
    card(ui, theme, TEXTS.text(title), |ui| {
        let outcomes = match end {
            ProcedureEnd::Done(outcomes) => outcomes,
            ProcedureEnd::Failed { before, .. } => before,
        };
        if let ProcedureEnd::Failed { texts, .. } = end {
            texts.iter().for_each(|text| line_ui(ui, theme, says::severity_of(text), &theme.format_text(text)));
        }
        let lines: Vec<(Severity, String)> = ops
            .iter()
            .zip(outcomes)
            .flat_map(|(op, own)| says::report_lines(op, own))
            .map(|(severity, text)| (severity, theme.format_text(&text)))
            .collect();
        lines.iter().for_each(|(severity, words)| line_ui(ui, theme, *severity, words));
        if encoder.motor.is_some() {
            motor::motor_running_note_ui(ui, theme, encoder, actions);
        } else if ops.iter().any(Op::needs_motor) {
            line_ui(ui, theme, Severity::Note, &translate(theme, "guide.stop_motor"));
        }
        ui.add_space(theme.space.inside);
        ui.horizontal_wrapped(|ui| {
            if let ProcedureEnd::Failed { may_return_to_operation: true, .. } = end {
                super::return_to_operation_ui(ui, theme, encoder, actions);
            }
            if !lines.is_empty() && labelled_button(ui, icons::COPY, &translate(theme, "guide.copy_report")).clicked() {
                let head = format!("{}\n{}\n", encoder.session.name(), translate(theme, "guide.report"));
                let lines: Vec<&str> = lines.iter().map(|(_, words)| words.as_str()).collect();
                ui.ctx().copy_text(format!("{head}{}\n", lines.join("\n")));
            }
            if labelled_button(ui, icons::CHECK, &translate(theme, "guide.close")).clicked() {
                actions.push(Action::device(id, Biss::CloseGuide));
            }
        });
    });
}

fn line_ui(ui: &mut Ui, theme: &Theme, own: Severity, words: &str) {
    let (icon, ink) = severity(theme, own);
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icon).color(ink));
        paragraph(ui, words);
    });
}
