//! Output of write plans on the command line, for all device kinds. Each line shows an old and a new value, followed by
//! the cost and the result.

use std::path::PathBuf;

use serde_json::{Value as Json, json};

use super::output::{Lines, Output};
use crate::app::explain;
use crate::app::review::undo_texts;
use crate::profile::{Operation, Plan, WrittenChanges};
use crate::store::LogbookError;
use crate::worker::CommitResult;
use crate::worker::commit::{CycleCount, PlannedWrite, Undo};

pub struct PlanReport {
    pub operations: Vec<Json>,
    pub text: String,
    pub write_cycles: u64,
}

impl PlanReport {
    /// Creates the report of a plan whose steps have the same strings in plain text and JSON.
    pub fn from_plan<Base, Op: Operation>(
        plan: &Plan<Base, Op>,
        steps: Vec<PlanStep>,
        seen: Option<CycleCount>,
        limit: Option<u64>,
    ) -> Self {
        let operations = steps.iter().map(PlanStep::json).collect();
        PlanReport {
            operations,
            text: text(plan, step_lines(steps.into_iter()), seen, limit),
            write_cycles: plan.write_cycles(),
        }
    }
}

/// Prints how each operation of a plan can be undone after the write.
pub(super) fn print_undo<P: PlannedWrite>(output: &Output, prepared: &P) {
    let texts = undo_texts(undos(prepared).map(|(item, undo)| (explain::literal_text(item), undo)));
    for text in texts {
        output.print_message(&text.terminal_text());
    }
}

/// Returns how each operation of a plan can be undone after the write, as JSON.
pub(super) fn undo_json<P: PlannedWrite>(prepared: &P) -> Json {
    let one = |(item, undo): (String, Option<Undo>)| {
        let how = match undo? {
            Undo::Exactly => "exactly",
            Undo::AnotherWrite { .. } => "another write",
            Undo::RestoreBackup => "restore backup",
            Undo::Never(_) => "never",
        };
        Some(json!({"item": item, "how": how}))
    };
    undos(prepared).filter_map(one).collect()
}

fn undos<P: PlannedWrite>(prepared: &P) -> impl Iterator<Item = (String, Option<Undo>)> {
    let items =
        |op: &P::Op| prepared.changed_items(op).into_iter().map(|item| item.item).collect::<Vec<_>>().join(", ");
    prepared.plan().ops.iter().map(items).zip(prepared.undos())
}

pub struct PlanStep {
    pub item: String,
    pub old: Option<String>,
    pub new: Option<String>,
    /// Number of write cycles that the operation takes. It is zero if the operation is saved together with others.
    pub write_cycles: u64,
}

impl PlanStep {
    pub fn json(&self) -> Json {
        json!({"item": self.item, "old": self.old, "new": self.new, "write_cycles": self.write_cycles})
    }
}

pub fn step_lines(steps: impl Iterator<Item = PlanStep>) -> Lines {
    let mut lines = Lines::default();
    for PlanStep { item, old, new, .. } in steps {
        let new = new.unwrap_or_default();
        match old {
            Some(old) => lines.add_line(item, format!("{old}  →  {new}")),
            None => lines.add_line(item, new),
        };
    }
    lines
}

/// Formats a plan: its lines, and its cost in write cycles with the number recorded on this computer and the limit, if
/// any.
pub fn text<Base, Op: Operation>(
    plan: &Plan<Base, Op>,
    mut lines: Lines,
    seen: Option<CycleCount>,
    limit: Option<u64>,
) -> String {
    if plan.is_empty() {
        return NOTHING_TO_WRITE.to_owned();
    }
    let seen = seen.map_or_else(|| "not known".to_owned(), |count| format!("at least {}", count.seen));
    let limit = limit.map(|limit| format!(", of {limit}")).unwrap_or_default();
    lines.add_line("write cycles", format!("{} (counted here so far: {seen}{limit})", plan.write_cycles()));
    lines.text()
}

pub(super) const NOTHING_TO_WRITE: &str = "nothing to write: the device already has these values\n";

#[derive(Default)]
pub struct WriteSummary {
    pub written: u64,
    pub verified: u64,
    pub write_cycles: u64,
    /// Path of the backup, or `None` if nothing had to be written.
    pub backup: Option<PathBuf>,
}

impl WriteSummary {
    /// Summarises an executed plan. Prints a warning if the result could not be recorded in the logbook.
    pub fn from_commit(output: &Output, committed: CommitResult<WrittenChanges>) -> Self {
        let CommitResult { written, backup, logbook_warning } = committed;
        warn_not_logged(output, logbook_warning.as_ref());
        let WrittenChanges { written, verified, write_cycles, .. } = written;
        WriteSummary { written, verified, write_cycles, backup }
    }
}

pub(crate) fn warn_not_logged(output: &Output, warning: Option<&LogbookError>) {
    if let Some(why) = warning {
        output.print_message(&explain::logbook_error_text(why).terminal_text());
    }
}
