//! Plans for an INTERBUS encoder on the command line: printing, confirming and executing them.

use serde_json::Value as Json;

use super::run::Runner;
use crate::cli::Result;
use crate::cli::args::ConsentArgs;
use crate::cli::consent::{check_wear, confirm_plan};
use crate::cli::output::Output;
use crate::cli::plan::{self, PlanReport, PlanStep, WriteSummary};
use crate::devices::interbus::jobs::{
    Change, Interbus, InterbusJob, InterbusOutput, Prepared, WEAR_LIMIT, WearAfterPlan,
};
use crate::devices::interbus::profile::{InterbusPlan, Op, programs_to_read};
use crate::devices::interbus::protocol::{Parameter, ProgramNumber};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain;
use crate::profile::Operation as _;
use crate::result_of;

/// Plans a change without writing anything.
pub(super) fn prepare_plan(runner: &mut Runner, output: &Output, change: Change) -> Result<Prepared> {
    let reads_all = match &change {
        Change::Restore { profile, .. } => programs_to_read(profile).len() == ProgramNumber::COUNT,
        Change::Write(wanted) => wanted.known_programs().count() == ProgramNumber::COUNT,
        Change::Item(..) => false,
        Change::Preset { .. } | Change::Default => true,
    };
    let prepared =
        result_of!(runner.run(InterbusJob::Prepare(change))?, InterbusOutput::Prepared(prepared) => *prepared);
    if !reads_all && prepared.plan.ops.iter().any(reduces_steps) {
        output.print_message(&TEXTS.text("ib_disturbs.shorter").terminal_text());
    }
    Ok(prepared)
}

fn reduces_steps(op: &Op) -> bool {
    let Op::Parameterise(changes) = op else { return false };
    changes.iter().any(|change| change.parameter == Parameter::Steps && change.to < change.from)
}

/// Executes a plan, after asking for consent if required. An empty plan sends nothing.
pub(super) fn commit_plan(
    runner: &mut Runner,
    output: &Output,
    prepared: Prepared,
    consent: &ConsentArgs,
) -> Result<WriteSummary> {
    if prepared.plan.is_empty() {
        return Ok(WriteSummary::default());
    }
    let wear = prepared.wear_to_report();
    check_wear::<Interbus>(consent, &prepared)?;
    let wear_text = explain::wear_warning(&prepared).map(|text| text.terminal_text());
    if let Some(wear_text) = &wear_text {
        output.print_message(wear_text);
    }
    let stop = TEXTS.text("ib_disturbs.writing").terminal_text();
    let text = format!("{}{stop}", plan_report(&prepared).text);
    let mut texts = vec![text.as_str()];
    if let (Some(WearAfterPlan::Ask(_) | WearAfterPlan::Worn(_) | WearAfterPlan::Unknown), Some(wear_text)) =
        (wear, &wear_text)
    {
        // Exceeding the manufacturer's limit requires a second confirmation.
        texts.push(wear_text);
    }
    let agreed = confirm_plan(runner, output, consent, prepared, &texts)?;
    let committed = result_of!(runner.run(InterbusJob::Commit(Box::new(agreed)))?, InterbusOutput::Committed(committed) => *committed);
    Ok(WriteSummary::from_commit(output, committed))
}

/// Returns the plan as text and JSON, with its cost and the old and new value of each item.
pub(super) fn plan_report(prepared: &Prepared) -> PlanReport {
    let plan = &prepared.plan;
    PlanReport::from_plan(
        plan,
        plan.ops.iter().flat_map(operation_steps).collect(),
        prepared.cycles_seen,
        Some(WEAR_LIMIT),
    )
}

/// Returns the operations as JSON. The EEPROM write cycle that several changes share is counted in their last entry.
pub(super) fn operations_json(plan: &InterbusPlan) -> Vec<Json> {
    plan.ops.iter().flat_map(operation_steps).map(|step| step.json()).collect()
}

/// Returns the operations as text, one line per change with the old and new value.
pub(super) fn change_lines(plan: &InterbusPlan) -> String {
    plan::step_lines(plan.ops.iter().flat_map(operation_steps)).text()
}

fn operation_steps(op: &Op) -> Vec<PlanStep> {
    let cost = op.write_cycles();
    let last =
        |item: &str, new: String| PlanStep { item: item.to_owned(), old: None, new: Some(new), write_cycles: cost };
    let mut steps: Vec<PlanStep> = op
        .value_changes()
        .into_iter()
        .map(|step| PlanStep { item: step.name, old: Some(step.from), new: Some(step.to), write_cycles: 0 })
        .collect();
    steps.push(match op {
        Op::Parameterise(_) => last("parameters", "stored".to_owned()),
        Op::Program(change) => last(&format!("cam program {}", change.program.get()), "stored".to_owned()),
        Op::FirePreset { value } => last("position", format!("becomes {value}")),
        Op::Default => last("all parameters", "as delivered (experimental)".to_owned()),
    });
    steps
}
