//! The `write` command, which changes a single parameter.

use super::act::check_acknowledged;
use super::parse_item;
use super::plan::{change_lines, commit_plan, operations_json, prepare_plan};
use super::run::Runner;
use crate::cli::args::{CommonArgs, Write};
use crate::cli::consent::require_consent;
use crate::cli::number::parse_number;
use crate::cli::output::Output;
use crate::cli::profiles::print_write_result;
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result};
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::profile::{Image, Item, PlanError, Service};
use crate::devices::hiperdrive::protocol::drive_parameter::{ACKNOWLEDGE, CONTROL, REFERENCE, RESET, SERVICE, TARGET};
use crate::devices::hiperdrive::protocol::{ParameterAccess, Travel};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;

pub(super) fn write(common: &CommonArgs, output: &Output, write: &Write) -> Result {
    let item = parse_item(&write.item, &write.own.read()?)?;
    let change = parse_change(item, &write.value)?;
    require_consent(&write.consent)?;
    // The number alone does not tell the user what the write does.
    if let Change::Do(_) = change {
        output.print_message(&explain::change_text(&change).terminal_text());
    }
    let mut runner = Runner::open(common)?;
    let drive = match change {
        Change::Do(Service::Acknowledge(drive)) => Some(drive),
        _ => None,
    };
    let prepared = prepare_plan(&mut runner, output, change)?;
    let (operations, changes) = (operations_json(&prepared.plan), change_lines(&prepared.plan));
    let spent = commit_plan(&mut runner, output, prepared, &write.consent)?;
    if let Some(drive) = drive.filter(|_| operations.is_empty()) {
        output.print_message(&TEXTS.text("hd_cli.no_fault").with("drive", drive.get()).terminal_text());
    }
    let done = print_write_result(output, &item.to_string(), &operations, &spent, &[], &changes)?;
    if let Some(drive) = drive.filter(|_| !operations.is_empty()) {
        check_acknowledged(&mut runner, output, drive)?;
    }
    Ok(done)
}

/// Parses a new parameter value. Values that no device accepts are rejected before a connection is opened.
fn parse_change(item: Item, text: &str) -> Result<Change> {
    let number = item.0;
    let refused = |error: PlanError| to_failure(&explain::plan_error_text(&error));
    let row = number.row().ok_or_else(|| refused(PlanError::NotRead { item }))?;
    match (row.number, row.access) {
        (CONTROL..=TARGET, ..) => return Err(refused(PlanError::Moves { item })),
        (RESET, ..) => return Err(to_failure(&TEXTS.text("hd_cli.resets").with("number", number))),
        (_, ParameterAccess::Read) => return Err(refused(PlanError::ReadOnly { item })),
        _ => {}
    }
    let value = parse_number(text).ok_or_else(|| Failure::Usage(format!("{item}: {text:?} is not a number")))?;
    if (row.number, value) == (SERVICE, 0) {
        return Err(to_failure(&TEXTS.text("hd_cli.no_service")));
    }
    // The plan checks the travel, because it knows the scale and can name both limits.
    if row.reach.is_none() || row.number == REFERENCE {
        row.check_value(number, value, Travel::UNKNOWN).map_err(|error| refused(error.into()))?;
    }
    match (row.number, number.drive()) {
        // Writing 0 clears the errors, which amounts to an acknowledgement (manual 6.2).
        (ACKNOWLEDGE, Some(drive)) => Ok(Change::Do(Service::Acknowledge(drive))),
        (SERVICE, _) => Service::from_code(value).map(Change::Do).ok_or_else(|| refused(PlanError::Acts { item })),
        (REFERENCE, Some(drive)) => {
            // The checked value fits into 32 bits.
            let position = i32::try_from(value).map_err(|_| refused(PlanError::Acts { item }))?;
            Ok(Change::SetPosition { drive, position, save: true })
        }
        _ => Ok(Change::Write(Box::new(Image { values: [(number, value)].into() }))),
    }
}
