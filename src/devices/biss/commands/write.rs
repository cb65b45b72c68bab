//! The `write` command, which writes registers by name.

use super::plan::{change_lines, commit_plan, operations_json, prepare_plan};
use super::run::Runner;
use crate::bits::parse_hex;
use crate::cli::args::{CommonArgs, Write};
use crate::cli::consent::require_consent;
use crate::cli::number::{out_of_range, parse_number};
use crate::cli::output::{Output, count};
use crate::cli::profiles::show_changes;
use crate::cli::{Failure, Result};
use crate::devices::biss::jobs::Change;
use crate::devices::biss::profile::RegisterRange;

pub(super) fn write(common: &CommonArgs, output: &Output, write: &Write) -> Result {
    let range = super::parse_item(&write.item)?;
    let bytes = value(range, write.item.contains('+'), &write.value)?;
    require_consent(&write.consent)?;
    let mut runner = Runner::open(common)?;
    let prepared = prepare_plan(&mut runner, Change::Write(vec![(range, bytes)]))?;
    let (operations, changes) = (operations_json(&prepared.plan), change_lines(&prepared.plan));
    let (spent, _) = commit_plan(&mut runner, output, prepared, &write.consent, super::OPERATOR_TIMEOUT)?;
    show_changes(output, &range.to_string(), &operations, &changes, &spent)
}

/// Parses a number for a single register or hexadecimal bytes for consecutive registers.
fn value(range: RegisterRange, is_run: bool, text: &str) -> Result<Vec<u8>> {
    if !is_run {
        let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{range}: {text:?} is not a number")))?;
        return u8::try_from(number).map(|byte| vec![byte]).map_err(|_| out_of_range(range, text, 0, 0xFF));
    }
    let bytes = parse_hex(text)
        .map_err(|why| Failure::Usage(format!("{text:?} is not a sequence of hexadecimal bytes: {why}")))?;
    if bytes.len() == usize::from(range.count()) {
        return Ok(bytes);
    }
    Err(Failure::Usage(format!("{range} takes {}, given: {}", count(range.count().into(), "byte"), bytes.len())))
}
