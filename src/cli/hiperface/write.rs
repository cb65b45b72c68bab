//! `write`, and what every writing command shares: the plan in words, consent, carrying it out.

use std::io::{IsTerminal, stderr, stdin};

use serde_json::{Value as Json, json};

use crate::app::explain;
use crate::bits::{hex_compact, parse_hex};
use crate::cli::args::{Common, Consenting, Write};
use crate::cli::output::{Lines, Output, say};
use crate::cli::runner::{Runner, unexpected};
use crate::cli::{Done, Failure, Result};
use crate::profile::Consent;
use crate::profile::hiperface::{HiperfacePlan, Item, Op};
use crate::protocol::hiperface::{DataFieldStatus, DeviceAddress, LineSettings};
use crate::worker::hiperface::{Change, Commit, Committed, HiperfaceJob, HiperfaceOutput, Prepared};

pub(in crate::cli) fn write(common: &Common, output: &Output, write: &Write) -> Result {
    let item = super::item(&write.item)?;
    let change = change_of(item, &write.value)?;
    change_and_show(common, output, change, &write.consent, &item.to_string())
}

/// Prepares a change, asks, carries it out and prints what came of it.
pub(in crate::cli) fn change_and_show(
    common: &Common,
    output: &Output,
    change: Change,
    consent: &Consenting,
    item: &str,
) -> Result {
    require_consent(consent)?;
    let mut runner = Runner::open(common)?;
    let prepared = match runner.run(HiperfaceJob::Prepare(change))? {
        HiperfaceOutput::Prepared(prepared) => *prepared,
        other => return Err(unexpected(&other)),
    };
    let operations = operations(&prepared.plan);
    let changes_code = prepared.plan.ops.iter().any(|op| matches!(op, Op::ChangeCode { .. }));
    let committed = commit(&mut runner, output, prepared, consent)?;
    let written = &committed.written;
    let json = json!({
        "item": item,
        "operations": operations,
        "written": written.written,
        "verified": written.verified,
        "write_cycles": written.write_cycles,
        "backup": committed.backup,
    });
    let text = match &committed.backup {
        None => "nothing to write: it is so already\n".to_owned(),
        Some(backup) => {
            let mut lines = Lines::default();
            lines.add("written", written.written).add("verified", written.verified);
            lines.add("write cycles", written.write_cycles).add("backup", backup.display());
            lines.text()
        }
    };
    if changes_code {
        output.remark("An access code cannot be read back; the encoder has acknowledged it.");
    }
    output.show_written(&json, &text)?;
    Ok(Done::Well)
}

fn change_of(item: Item, value: &str) -> Result<Change> {
    match item {
        Item::Field(range) => {
            let bytes = parse_hex(value).map_err(|why| Failure::Usage(format!("{value:?} is not hex bytes: {why}")))?;
            if bytes.is_empty() {
                return Err(Failure::Usage("there are no bytes to write".to_owned()));
            }
            if let Some(count) = range.count.filter(|count| *count != bytes.len()) {
                return Err(Failure::Usage(format!("{range} takes {count} bytes, {} are given", bytes.len())));
            }
            Ok(Change::Store(vec![(range, bytes)]))
        }
        Item::Status(number) => {
            let status = DataFieldStatus::from_byte(byte_within(item, value, 0x80..=0xFF)?);
            Ok(Change::Redefine { number, status })
        }
        Item::Address => {
            let byte = byte_within(item, value, 0x40..=0x5F)?;
            let address = DeviceAddress::new(byte).ok_or_else(|| out_of_range(item, value, 0x40, 0x5F))?;
            Ok(Change::SetAddress(address))
        }
        Item::Settings => Ok(Change::Configure(settings(value)?)),
        Item::Counter => match number(item, value)? {
            0 => Ok(Change::ClearCounter),
            _ => Err(Failure::Usage(
                "the counter can be set to 0, or counted up with \"do hiperface increment-counter\"".to_owned(),
            )),
        },
        Item::Analogue(_) => Err(Failure::Usage("an analogue value can only be read".to_owned())),
    }
}

/// A settings byte without reserved values.
pub(in crate::cli) fn settings(value: &str) -> Result<LineSettings> {
    let settings = LineSettings::from_byte(byte_within(Item::Settings, value, 0..=0xFF)?);
    if settings.is_valid() {
        return Ok(settings);
    }
    Err(Failure::Failed(vec![format!(
        "settings {:02X}h have a reserved value: bit 3 is 0, bits 5 and 4 are 00, 10 or 11, bits 2 to 0 are 0 to 6.",
        settings.byte()
    )]))
}

fn byte_within(item: Item, value: &str, range: std::ops::RangeInclusive<u8>) -> Result<u8> {
    let number = number(item, value)?;
    u8::try_from(number)
        .ok()
        .filter(|byte| range.contains(byte))
        .ok_or_else(|| out_of_range(item, value, (*range.start()).into(), (*range.end()).into()))
}

fn number(item: Item, value: &str) -> Result<i64> {
    parse_number(value).ok_or_else(|| Failure::Usage(format!("{item}: {value:?} is not a number")))
}

/// A value that is a number and lies beyond its limits.
pub(in crate::cli) fn out_of_range(what: impl std::fmt::Display, value: &str, low: i64, high: i64) -> Failure {
    Failure::Failed(vec![format!("{what}: {value} is not within {low} to {high} ({low:#X} to {high:#X}).")])
}

/// Decimal, or hexadecimal with `0x`; a sign in front.
pub(in crate::cli) fn parse_number(text: &str) -> Option<i64> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, text),
    };
    let number = match digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        Some(hex) if hex.starts_with(|c: char| c.is_ascii_hexdigit()) => i64::from_str_radix(hex, 16),
        None if digits.starts_with(|c: char| c.is_ascii_digit()) => digits.parse(),
        _ => return None,
    };
    number.ok().map(|number| sign * number)
}

/// Without a terminal nobody can be asked: refused before anything is opened.
pub(in crate::cli) fn require_consent(consent: &Consenting) -> Result<()> {
    if consent.yes || can_ask() {
        return Ok(());
    }
    Err(Failure::Usage(
        "this writes to the device: give --yes, or run it on a terminal; nothing was touched".to_owned(),
    ))
}

fn can_ask() -> bool {
    stdin().is_terminal() && stderr().is_terminal()
}

/// Asks where it has to, and carries the plan out. A plan with nothing in it sends nothing.
pub(in crate::cli) fn commit(
    runner: &mut Runner,
    output: &Output,
    prepared: Prepared,
    consent: &Consenting,
) -> Result<Committed> {
    if prepared.plan.is_empty() {
        return Ok(Committed::default());
    }
    if !consent.yes {
        output.remark(plan_text(&prepared).trim_end());
        ask()?;
    }
    let granted = Consent::to(prepared.plan.id());
    let commit = Commit { prepared, consent: granted, force_wear: consent.force_wear };
    match runner.run(HiperfaceJob::Commit(Box::new(commit)))? {
        HiperfaceOutput::Committed(committed) => {
            if let Some(why) = &committed.logbook_warning {
                output.remark(&explain::logbook(why).terminal());
            }
            Ok(committed)
        }
        other => Err(unexpected(&other)),
    }
}

fn ask() -> Result<()> {
    say("Write? [y/N] ");
    let mut answer = String::new();
    // A terminal that cannot be read from gives no consent.
    if stdin().read_line(&mut answer).is_ok() && matches!(answer.trim(), "y" | "Y" | "yes") {
        return Ok(());
    }
    Err(Failure::Failed(vec!["Not confirmed; nothing was written.".to_owned()]))
}

/// The plan for a person: each operation old → new, and what it costs.
pub(in crate::cli) fn plan_text(prepared: &Prepared) -> String {
    let plan = &prepared.plan;
    if plan.is_empty() {
        return "nothing to write: it is so already\n".to_owned();
    }
    let mut lines = Lines::default();
    for op in &plan.ops {
        let (old, new) = change_words(op);
        lines.add(op.item(), format!("{old}  →  {new}"));
    }
    if let Some(wanted) = prepared.wanted_position {
        lines.add("wanted", format!("{wanted}; the value above keeps the phase to the sine signal (--exact does not)"));
    }
    let seen = prepared.cycles_seen.map_or_else(|| "not known".to_owned(), |cycles| format!("at least {cycles}"));
    lines.add("write cycles", format!("{} (seen here so far: {seen})", plan.write_cycles()));
    lines.text()
}

/// The operations as JSON.
pub(in crate::cli) fn operations(plan: &HiperfacePlan) -> Vec<Json> {
    plan.ops
        .iter()
        .map(|op| {
            let (old, new) = match op {
                Op::Store { old, new, .. } => (old.as_deref().map(hex_compact), Some(hex_compact(new))),
                Op::Define { from, to, .. } => {
                    let byte = |status: DataFieldStatus| format!("{:02X}", status.byte());
                    (from.map(byte), Some(byte(*to)))
                }
                // An access code is shown nowhere.
                Op::ChangeCode { .. } => (None, None),
                op => {
                    let (old, new) = change_words(op);
                    (Some(old), Some(new))
                }
            };
            json!({"item": op.item(), "old": old, "new": new})
        })
        .collect()
}

/// Status and settings with their bytes, which `status:N` and `settings` take; the rest as everybody is told it.
fn change_words(op: &Op) -> (String, String) {
    match op {
        Op::Define { from, to, .. } => {
            (from.map_or_else(|| "not there".to_owned(), |from| format!("{from:?}")), format!("{to:?}"))
        }
        Op::Configure { from, to } => (format!("{from:?}"), format!("{to:?}")),
        op => {
            let words = explain::hiperface::op(op);
            (words.old.terminal(), words.new.terminal())
        }
    }
}
