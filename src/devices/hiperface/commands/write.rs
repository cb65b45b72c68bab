//! The `write` command, and the steps that all writing commands share: print the plan, ask for consent, execute the
//! plan.

use serde_json::{Value as Json, json};

use crate::bits::{hex_compact, parse_hex};
use crate::cli::args::{CommonArgs, ConsentArgs, Write};
use crate::cli::consent::{check_wear, confirm_plan, require_consent};
use crate::cli::number::{out_of_range, parse_number};
use crate::cli::output::{Lines, Output, count as plural};
use crate::cli::plan::{self, WriteSummary};
use crate::cli::profiles::show_changes;
use crate::cli::{Failure, Result};
use crate::devices::hiperface::commands::run::Runner;
use crate::devices::hiperface::jobs::{Change, Hiperface, HiperfaceJob, HiperfaceOutput, Prepared};
use crate::devices::hiperface::profile::{HiperfacePlan, Item, Op};
use crate::devices::hiperface::protocol::{DataFieldStatus, DeviceAddress, LineSettings};
use crate::devices::hiperface::state::explain;
use crate::result_of;

pub(super) fn write(common: &CommonArgs, output: &Output, write: &Write) -> Result {
    let item = super::parse_item(&write.item)?;
    let change = parse_change(item, &write.value)?;
    execute_change(common, output, change, &write.consent, &item.to_string())
}

/// Prepares a change, asks for consent, executes it and prints the result.
pub(super) fn execute_change(
    common: &CommonArgs,
    output: &Output,
    change: Change,
    consent: &ConsentArgs,
    item: &str,
) -> Result {
    require_consent(consent)?;
    let mut runner = Runner::open(common)?;
    let prepared =
        result_of!(runner.run(HiperfaceJob::Prepare(change))?, HiperfaceOutput::Prepared(prepared) => *prepared);
    let (operations, changes) = (operations_json(&prepared.plan), change_lines(&prepared.plan).text());
    let changes_code = prepared.plan.ops.iter().any(|op| matches!(op, Op::ChangeCode { .. }));
    let spent = commit_plan(&mut runner, output, prepared, consent)?;
    if changes_code {
        output.print_message("An access code cannot be read back; the encoder acknowledged it.");
    }
    show_changes(output, item, &operations, &changes, &spent)
}

fn parse_change(item: Item, value: &str) -> Result<Change> {
    match item {
        Item::Field(range) => {
            let bytes = parse_hex(value)
                .map_err(|why| Failure::Usage(format!("{value:?} is not a sequence of hexadecimal bytes: {why}")))?;
            if bytes.is_empty() {
                return Err(Failure::Usage("no bytes to write were given".to_owned()));
            }
            if let Some(count) = range.count.filter(|count| *count != bytes.len()) {
                return Err(Failure::Usage(format!("{range} takes {}, given: {}", plural(count, "byte"), bytes.len())));
            }
            Ok(Change::Store(vec![(range, bytes)]))
        }
        Item::Status(number) => {
            let status = DataFieldStatus::from_byte(parse_byte_in_range(item, value, 0x80..=0xFF)?);
            Ok(Change::Redefine { number, status })
        }
        Item::Address => {
            let byte = parse_byte_in_range(item, value, 0x40..=0x5F)?;
            let address = DeviceAddress::new(byte).ok_or_else(|| out_of_range(item, value, 0x40, 0x5F))?;
            Ok(Change::SetAddress(address))
        }
        Item::Settings => Ok(Change::Configure(settings(value)?)),
        Item::Counter => match parse_item_value(item, value)? {
            0 => Ok(Change::ClearCounter),
            _ => Err(Failure::Usage(
                "the counter can only be set to 0, or incremented with \"do hiperface increment-counter\"".to_owned(),
            )),
        },
        Item::Analogue(_) => Err(Failure::Usage("an analogue value is read-only".to_owned())),
    }
}

/// Parses a settings byte. Reserved values are rejected.
pub(super) fn settings(value: &str) -> Result<LineSettings> {
    let settings = LineSettings::from_byte(parse_byte_in_range(Item::Settings, value, 0..=0xFF)?);
    if settings.is_valid() {
        return Ok(settings);
    }
    Err(Failure::Failed(vec![format!(
        "settings {:02X}h contain a reserved value: bit 3 must be 0, bits 5 and 4 must be 00, 10 or 11, bits 2 to 0 \
         must be 0 to 6.",
        settings.byte()
    )]))
}

fn parse_byte_in_range(item: Item, value: &str, range: std::ops::RangeInclusive<u8>) -> Result<u8> {
    let number = parse_item_value(item, value)?;
    u8::try_from(number)
        .ok()
        .filter(|byte| range.contains(byte))
        .ok_or_else(|| out_of_range(item, value, (*range.start()).into(), (*range.end()).into()))
}

fn parse_item_value(item: Item, value: &str) -> Result<i64> {
    parse_number(value).ok_or_else(|| Failure::Usage(format!("{item}: {value:?} is not a number")))
}

/// Executes a plan, and asks for consent first if required. If the plan is empty, nothing is sent.
pub(super) fn commit_plan(
    runner: &mut Runner,
    output: &Output,
    prepared: Prepared,
    consent: &ConsentArgs,
) -> Result<WriteSummary> {
    if prepared.plan.is_empty() {
        return Ok(WriteSummary::default());
    }
    check_wear::<Hiperface>(consent, &prepared)?;
    let text = plan_text(&prepared);
    let agreed = confirm_plan(runner, output, consent, prepared, &[&text])?;
    let committed = result_of!(runner.run(HiperfaceJob::Commit(Box::new(agreed)))?, HiperfaceOutput::Committed(committed) => committed);
    Ok(WriteSummary::from_commit(output, committed))
}

/// Describes a plan: its number of EEPROM writes, and the old and new value of each operation.
pub(super) fn plan_text(prepared: &Prepared) -> String {
    let plan = &prepared.plan;
    let mut lines = change_lines(plan);
    if let Some(wanted) = prepared.wanted_position {
        lines.add_line(
            "wanted",
            format!("{wanted}; the value above is in phase with the sine signal (use --exact for the exact value)"),
        );
    }
    plan::text(plan, lines, prepared.cycles_seen, None)
}

fn change_lines(plan: &HiperfacePlan) -> Lines {
    let mut lines = Lines::default();
    for op in &plan.ops {
        let (old, new) = old_and_new_text(op);
        lines.add_line(op.plan_item().to_string(), format!("{old}  →  {new}"));
    }
    lines
}

pub(super) fn operations_json(plan: &HiperfacePlan) -> Vec<Json> {
    plan.ops
        .iter()
        .map(|op| {
            let (old, new) = match op {
                Op::Store { old, new, .. } => (old.as_deref().map(hex_compact), Some(hex_compact(new))),
                Op::Define { from, to, .. } => {
                    let byte = |status: DataFieldStatus| format!("{:02X}", status.byte());
                    (from.map(byte), Some(byte(*to)))
                }
                // An access code is never displayed.
                Op::ChangeCode { .. } => (None, None),
                op => {
                    let (old, new) = old_and_new_text(op);
                    (Some(old), Some(new))
                }
            };
            json!({"item": op.plan_item().to_string(), "old": old, "new": new})
        })
        .collect()
}

/// Returns the old and new value of an operation as text. A field status and line settings are shown as bytes, in the
/// form that `status:N` and `settings` accept.
fn old_and_new_text(op: &Op) -> (String, String) {
    match op {
        Op::Define { from, to, .. } => {
            (from.map_or_else(|| "not there".to_owned(), |from| format!("{from:?}")), format!("{to:?}"))
        }
        Op::Configure { from, to } => (format!("{from:?}"), format!("{to:?}")),
        op => {
            let changes = explain::operation_texts(op, None).changes.into_iter();
            changes.map(|own| (own.old.terminal_text(), own.new.terminal_text())).next().unwrap_or_default()
        }
    }
}
