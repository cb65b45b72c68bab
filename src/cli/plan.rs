//! A plan on the command line, whatever the kind of device: old → new line by line, what it costs, and what it has done.

use std::path::PathBuf;

use serde_json::{Value as Json, json};

use super::output::{Lines, Output};
use crate::app::explain;
use crate::profile::{Operation, Plan, Written};
use crate::store::LogbookError;
use crate::worker::Committed;

/// A plan, for a person and for a script.
pub(crate) struct Shown {
    pub(crate) operations: Vec<Json>,
    pub(crate) text: String,
    pub(crate) write_cycles: u64,
}

/// A line of a plan.
pub(crate) struct Step {
    pub(crate) item: String,
    pub(crate) old: Option<String>,
    pub(crate) new: Option<String>,
    /// None for what is saved together with others.
    pub(crate) write_cycles: u64,
}

impl Step {
    /// For a script.
    pub(crate) fn json(&self) -> Json {
        json!({"item": self.item, "old": self.old, "new": self.new, "write_cycles": self.write_cycles})
    }
}

/// Steps for a person, a line each.
pub(crate) fn lines(steps: impl Iterator<Item = Step>) -> Lines {
    let mut lines = Lines::default();
    for Step { item, old, new, .. } in steps {
        let new = new.unwrap_or_default();
        match old {
            Some(old) => lines.add(item, format!("{old}  →  {new}")),
            None => lines.add(item, new),
        };
    }
    lines
}

/// A plan for a person: its lines, and what it costs beside what this computer has seen, and the limit where there is one.
pub(crate) fn text<Base, Op: Operation>(
    plan: &Plan<Base, Op>,
    mut lines: Lines,
    seen: Option<u64>,
    limit: Option<u64>,
) -> String {
    if plan.is_empty() {
        return NOTHING.to_owned();
    }
    let seen = seen.map_or_else(|| "not known".to_owned(), |cycles| format!("at least {cycles}"));
    let limit = limit.map(|limit| format!(", of {limit}")).unwrap_or_default();
    lines.add("write cycles", format!("{} (seen here so far: {seen}{limit})", plan.write_cycles()));
    lines.text()
}

/// Said of a plan without operations.
pub(super) const NOTHING: &str = "nothing to write: it is so already\n";

/// What a write has done.
#[derive(Default)]
pub(crate) struct Spent {
    pub(crate) written: u64,
    pub(crate) verified: u64,
    pub(crate) write_cycles: u64,
    /// `None`: there was nothing to write.
    pub(crate) backup: Option<PathBuf>,
}

impl Spent {
    /// What a commit did; what the logbook could not take is told.
    pub(crate) fn of(output: &Output, committed: Committed<Written>) -> Self {
        let Committed { written, backup, logbook_warning } = committed;
        warn(output, logbook_warning.as_ref());
        let Written { written, verified, write_cycles, .. } = written;
        Spent { written, verified, write_cycles, backup }
    }
}

/// Tells what the logbook could not take.
pub(crate) fn warn(output: &Output, warning: Option<&LogbookError>) {
    if let Some(why) = warning {
        output.remark(&explain::logbook(why).terminal());
    }
}
