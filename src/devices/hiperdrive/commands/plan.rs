//! Shows, confirms and executes plans for an adapter or a hub.

use serde_json::{Value as Json, json};

use super::run::Runner;
use crate::cli::Result;
use crate::cli::args::ConsentArgs;
use crate::cli::consent::{check_wear, confirm_plan};
use crate::cli::output::{Lines, Output};
use crate::cli::plan::{self, PlanReport, WriteSummary};
use crate::devices::hiperdrive::jobs::{Change, Hiperdrive, HiperdriveJob, HiperdriveOutput, Prepared, WEAR_WARNING};
use crate::devices::hiperdrive::profile::{HiperdrivePlan, Op, Service, plan_warnings};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;
use crate::profile::Operation as _;
use crate::result_of;

/// Prepares a plan for a change and prints its warnings. No data is written.
pub(super) fn prepare_plan(runner: &mut Runner, output: &Output, change: Change) -> Result<Prepared> {
    let asked = match &change {
        Change::SetPosition { position, .. } => Some(i64::from(*position)),
        _ => None,
    };
    let prepared =
        result_of!(runner.run(HiperdriveJob::Prepare(change))?, HiperdriveOutput::Prepared(prepared) => *prepared);
    if let (Some(asked), Some(Op::Write { new, .. })) = (asked, prepared.plan.ops.first())
        && asked != *new
    {
        output.print_message(&TEXTS.text("hd_cli.rounded").with("asked", asked).with("becomes", new).terminal_text());
    }
    for warning in plan_warnings(&prepared.plan) {
        output.print_message(&explain::warning_text(&warning).terminal_text());
    }
    if prepared.plan.ops.contains(&Op::Service(Service::FactoryAll)) {
        output.print_message(&TEXTS.text("hd_cli.address_lost").terminal_text());
    }
    Ok(prepared)
}

/// Asks for consent if required, then executes the plan. An empty plan sends nothing.
pub(super) fn commit_plan(
    runner: &mut Runner,
    output: &Output,
    prepared: Prepared,
    consent: &ConsentArgs,
) -> Result<WriteSummary> {
    if prepared.plan.is_empty() {
        return Ok(WriteSummary::default());
    }
    check_wear::<Hiperdrive>(consent, &prepared)?;
    if let Some(saves) = prepared.wear_to_report() {
        output.print_message(&format!(
            "This is save {saves} counted in the logbook. The manual gives no limit; from {WEAR_WARNING} on, an \
             EEPROM may wear out."
        ));
    }
    let text = plan_report(&prepared).text;
    let agreed = confirm_plan(runner, output, consent, prepared, &[&text])?;
    let committed = result_of!(runner.run(HiperdriveJob::Commit(Box::new(agreed)))?, HiperdriveOutput::Committed(committed) => *committed);
    Ok(WriteSummary::from_commit(output, committed))
}

/// Formats a plan as text and JSON: the old and new value of each parameter, and the number of saves.
pub(super) fn plan_report(prepared: &Prepared) -> PlanReport {
    let plan = &prepared.plan;
    let mut lines = Lines::default();
    for op in &plan.ops {
        let words = explain::operation_texts(op);
        for change in &words.changes {
            lines.add_line(
                words.item.terminal_text(),
                format!("{}  →  {}", change.old.terminal_text(), change.new.terminal_text()),
            );
        }
    }
    let text = plan::text(plan, lines, prepared.cycles_seen, None);
    PlanReport { operations: operations_json(plan), text, write_cycles: plan.write_cycles() }
}

pub(super) fn change_lines(plan: &HiperdrivePlan) -> String {
    let mut text = String::new();
    for words in plan.ops.iter().map(explain::operation_texts) {
        for change in &words.changes {
            let (item, old, new) = (words.item.terminal_text(), change.old.terminal_text(), change.new.terminal_text());
            text.push_str(&format!("{item}: {old} → {new}\n"));
        }
    }
    text
}

pub(super) fn operations_json(plan: &HiperdrivePlan) -> Vec<Json> {
    plan.ops
        .iter()
        .map(|op| {
            let (old, new) = match op {
                Op::Write { old, new, .. } => (json!(old), json!(new)),
                Op::Service(service) => match service.code() {
                    Some(code) => (Json::Null, json!(code)),
                    None => (Json::Null, json!(0)),
                },
                Op::Network { .. } => {
                    let changes = op.changed_items();
                    (Json::Null, json!(changes.first().map(ToString::to_string)))
                }
            };
            json!({"item": op.item_name(), "old": old, "new": new, "write_cycles": op.write_cycles()})
        })
        .collect()
}
