//! Plans for a BiSS encoder on the command line: display, confirmation, execution and result.

use std::time::Duration;

use serde_json::{Value as Json, json};

use super::register_text;
use super::run::Runner;
use crate::bits::hex_compact;
use crate::cli::Result;
use crate::cli::args::ConsentArgs;
use crate::cli::consent::{check_wear, confirm_plan};
use crate::cli::output::Output;
use crate::cli::plan::{self, PlanReport, PlanStep, WriteSummary, warn_not_logged};
use crate::devices::biss::jobs::{Biss, BissJob, BissOutput, Change, Commit, OperatorPresence, Prepared, WEAR_LIMIT};
use crate::devices::biss::procedures::procedure::{Outcome, ShaftMotion, UnattendedOperator};
use crate::devices::biss::procedures::write::WrittenValues;
use crate::devices::biss::profile::{BissPlan, Op, PresetParts, RegisterRange};
use crate::devices::biss::protocol::PresetValue;
use crate::devices::biss::state::explain as explained;
use crate::profile::Operation as _;
use crate::result_of;

/// What the user must know before a calibration (manual 6.4).
pub(super) const CALIBRATION: &str =
    "counterclockwise, then clockwise; if the clockwise run fails, the calibration table is lost";

pub(super) fn prepare_plan(runner: &mut Runner, change: Change) -> Result<Prepared> {
    Ok(result_of!(runner.run(BissJob::Prepare(change))?, BissOutput::Prepared(prepared) => *prepared))
}

/// Asks for consent if required, and executes the plan. An empty plan sends nothing. If a run needs the motor, it
/// starts as soon as the motor meets the conditions. `patience` limits this wait.
pub(super) fn commit_plan(
    runner: &mut Runner,
    output: &Output,
    prepared: Prepared,
    consent: &ConsentArgs,
    patience: Duration,
) -> Result<(WriteSummary, Vec<Outcome>)> {
    if prepared.plan.is_empty() {
        return Ok((WriteSummary::default(), Vec::new()));
    }
    check_wear::<Biss>(consent, &prepared)?;
    if let Some(wear) = explained::wear_warning(&prepared) {
        output.print_message(&wear.terminal_text());
    }
    let text = plan_report(&prepared).text;
    let agreed = confirm_plan(runner, output, consent, prepared, &[&text])?;
    let commit = Commit { agreed, attendance: OperatorPresence::Unattended(UnattendedOperator { patience }) };
    let committed =
        result_of!(runner.run(BissJob::Commit(Box::new(commit)))?, BissOutput::Committed(committed) => *committed);
    warn_not_logged(output, committed.logbook_warning.as_ref());
    let WrittenValues { written, verified, write_cycles, outcomes, .. } = committed.written;
    Ok((WriteSummary { written, verified, write_cycles, backup: committed.backup }, outcomes))
}

/// Describes the plan as text and JSON, with the old and new value of each operation and the cost in write cycles.
pub(super) fn plan_report(prepared: &Prepared) -> PlanReport {
    let plan = &prepared.plan;
    PlanReport::from_plan(
        plan,
        plan.ops.iter().flat_map(operation_steps).collect(),
        prepared.cycles_seen,
        Some(WEAR_LIMIT),
    )
}

/// Returns the operations as JSON. Registers that are saved together share one cost.
pub(super) fn operations_json(plan: &BissPlan) -> Vec<Json> {
    plan.ops.iter().flat_map(operation_steps).map(|step| step.json()).collect()
}

/// Returns the operations with old and new values, one per line.
pub(super) fn change_lines(plan: &BissPlan) -> String {
    plan::step_lines(plan.ops.iter().flat_map(operation_steps)).text()
}

fn operation_steps(op: &Op) -> Vec<PlanStep> {
    let cost = op.write_cycles();
    let step = |old: Option<String>, new: Option<String>| {
        vec![PlanStep { item: op.item_name(), old, new, write_cycles: cost }]
    };
    let byte = |byte: u8| format!("{byte:02X}");
    match op {
        Op::StoreData { area, registers } => {
            let mut steps: Vec<PlanStep> = op
                .register_ranges()
                .into_iter()
                .map(|range: RegisterRange| {
                    let own = registers.iter().filter(|change| range.contains(change.address));
                    let (old, new): (Vec<u8>, Vec<u8>) = own.map(|change| (change.old, change.new)).unzip();
                    let (old, new) = (Some(hex_compact(&old)), Some(hex_compact(&new)));
                    PlanStep { item: range.to_string(), old, new, write_cycles: 0 }
                })
                .collect();
            steps.push(PlanStep {
                item: area.name.to_string(),
                old: None,
                new: Some("saved".to_owned()),
                write_cycles: cost,
            });
            steps
        }
        Op::StorePreset { from, to } => step(Some(hex_compact(&from.emit())), Some(hex_compact(&to.emit()))),
        Op::FirePreset { parts, value } => step(None, Some(preset_trigger_text(*parts, *value))),
        Op::SelectFilter { from, to } => step(Some(byte(from.byte())), Some(byte(to.byte()))),
        Op::Calibrate => step(None, Some(CALIBRATION.to_owned())),
        Op::WiegandTest { save } => {
            let end = if *save { ", saved" } else { "" };
            step(None, Some(format!("clockwise, then counterclockwise{end}")))
        }
        Op::WriteRegister { old, new, .. } => step(old.map(byte), Some(byte(*new))),
    }
}

fn preset_trigger_text(parts: PresetParts, value: PresetValue) -> String {
    let (turns, steps) = (value.multiturn(), value.singleturn());
    match parts {
        PresetParts::Both => format!("turn {turns}, step {steps}"),
        PresetParts::Singleturn => format!("step {steps}"),
        PresetParts::Multiturn => format!("turn {turns}"),
    }
}

pub(super) fn results_json(outcomes: &[Outcome]) -> Vec<Json> {
    let rpm = |motion: &Option<ShaftMotion>| motion.map(|motion| motion.rpm);
    let one = |outcome: &Outcome| match outcome {
        Outcome::Skipped { after } => {
            json!({"result": "skipped", "after": after.map(|run| if run.is_clockwise() { "clockwise" } else { "counterclockwise" })})
        }
        Outcome::Stored { registers } => json!({"result": "stored", "registers": registers}),
        Outcome::PresetStored { value, .. } => {
            json!({"result": "preset stored", "singleturn": value.singleturn(), "multiturn": value.multiturn()})
        }
        Outcome::PresetFired { from, to, .. } => {
            let place = |reading: &crate::devices::biss::procedures::PositionReading| json!({"turns": reading.turns, "steps": reading.steps});
            json!({"result": "preset", "from": place(from), "to": place(to)})
        }
        Outcome::FilterSelected(filter) => json!({"result": "filter", "filter": register_text::filter(*filter)}),
        Outcome::Calibrated(report) => json!({
            "result": "calibrated",
            "temperature_c": report.celsius,
            "counterclockwise_rpm": rpm(&report.counterclockwise),
            "clockwise_rpm": rpm(&report.clockwise),
        }),
        Outcome::Tested(report) => json!({
            "result": "tested",
            "ok": report.result.is_passed(),
            "saved": report.saved,
            "average_cw_v": report.result.average_cw.volts(),
            "lowest_cw_v": report.result.lowest_cw.volts(),
            "average_ccw_v": report.result.average_ccw.volts(),
            "lowest_ccw_v": report.result.lowest_ccw.volts(),
            "clockwise_rpm": rpm(&report.clockwise),
            "counterclockwise_rpm": rpm(&report.counterclockwise),
        }),
    };
    outcomes.iter().map(one).collect()
}

/// Returns the results of the operations, one per line.
pub(super) fn results_text(outcomes: &[Outcome]) -> String {
    let texts = outcomes.iter().flat_map(explained::outcome_texts);
    texts.map(|text| text.terminal_text() + "\n").collect()
}
