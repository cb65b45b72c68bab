//! The command `write`, which writes a single item.

use super::plan::{change_lines, commit_plan, operations_json, prepare_plan};
use super::run::Runner;
use super::value::value;
use super::{DisturbanceLevel, parse_item};
use crate::cli::Result;
use crate::cli::args::{CommonArgs, Write};
use crate::cli::consent::require_consent;
use crate::cli::output::Output;
use crate::cli::profiles::show_changes;
use crate::devices::interbus::jobs::Change;

pub(super) fn write(common: &CommonArgs, output: &Output, write: &Write) -> Result {
    let item = parse_item(&write.item)?;
    let value = value(item, &write.value)?;
    require_consent(&write.consent)?;
    let mut runner = Runner::open(common)?;
    let disturbs = if item.parameter().is_some() { DisturbanceLevel::Reading } else { DisturbanceLevel::Programs };
    disturbs.confirm_start(common, output, Some(&write.consent))?;
    let prepared = prepare_plan(&mut runner, output, Change::Item(item, value))?;
    let (operations, changes) = (operations_json(&prepared.plan), change_lines(&prepared.plan));
    let spent = commit_plan(&mut runner, output, prepared, &write.consent)?;
    show_changes(output, &item.to_string(), &operations, &changes, &spent)
}
