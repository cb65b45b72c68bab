//! The command `write`, which writes a single item.

use super::plan::{change_lines, commit, operations, prepare};
use super::run::Runner;
use super::value::value;
use super::{DisturbanceLevel, item};
use crate::cli::Result;
use crate::cli::args::{CommonArgs, Write};
use crate::cli::consent::require_consent;
use crate::cli::output::Output;
use crate::cli::profiles::show_changes;
use crate::devices::interbus::jobs::Change;

pub(super) fn write(common: &CommonArgs, output: &Output, write: &Write) -> Result {
    let item = item(&write.item)?;
    let value = value(item, &write.value)?;
    require_consent(&write.consent)?;
    let mut runner = Runner::open(common)?;
    let disturbs = if item.parameter().is_some() { DisturbanceLevel::Reading } else { DisturbanceLevel::Programs };
    disturbs.begin(common, output, Some(&write.consent))?;
    let prepared = prepare(&mut runner, output, Change::Item(item, value))?;
    let (operations, changes) = (operations(&prepared.plan), change_lines(&prepared.plan));
    let spent = commit(&mut runner, output, prepared, &write.consent)?;
    show_changes(output, &item.to_string(), &operations, &changes, &spent)
}
