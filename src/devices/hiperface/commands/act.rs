//! The `do` command: actions such as restarting the encoder or setting its position.

use serde_json::json;

use super::args::{DoOptions, HiperfaceAction};
use super::codes::parse_code;
use super::inspect::codes_text;
use super::write::{execute_change, settings};
use crate::cli::args::{ActionArgs, CommonArgs};
use crate::cli::number::{out_of_range, parse_number};
use crate::cli::output::Output;
use crate::cli::runner::unexpected_output;
use crate::cli::{Failure, Result, Success, check};
use crate::devices::hiperface::commands::run::Runner;
use crate::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput};
use crate::devices::hiperface::procedures::check::{CheckFinding, CheckStep, HiperfaceStepResult, Verdict};
use crate::devices::hiperface::protocol::{AccessCodeNumber, DataFieldStatus, FieldSize, KIND};
use crate::devices::hiperface::state::explain;
use crate::result_of;

const ACTIONS: &str = "reset, check, set-position, synchronise, create-field, resize-field, lock-field, unlock-field, \
                       delete-field, change-code, increment-counter, clear-counter and configure-for-now";

pub(super) fn run_action(common: &CommonArgs, output: &Output, act: &ActionArgs) -> Result {
    let words: Vec<&str> = act.arguments.iter().map(String::as_str).collect();
    let usage = |form: &str| Failure::Usage(format!("the action takes {form}"));
    let change = match (act.parse_action::<HiperfaceAction>(KIND, ACTIONS)?, words.as_slice()) {
        (HiperfaceAction::Reset, []) => return reset(common, output),
        (HiperfaceAction::Check, []) => return check_device(common, output, false),
        (HiperfaceAction::Check, ["restart"]) => return check_device(common, output, true),
        (HiperfaceAction::ConfigureForNow, [value]) => return set_temporary_settings(common, output, value),
        (HiperfaceAction::SetPosition, [wanted]) => set_position(act, wanted, false)?,
        (HiperfaceAction::Synchronise, [wanted]) => set_position(act, wanted, true)?,
        (HiperfaceAction::CreateField, [number, rest @ ..]) if !rest.is_empty() => {
            Change::CreateField { number: field(number)?, status: parse_field_status(rest)? }
        }
        (HiperfaceAction::ResizeField, [number, bytes]) => {
            Change::ResizeField { number: field(number)?, size: size(bytes)? }
        }
        (HiperfaceAction::LockField, [number]) => Change::LockField { number: field(number)?, lock: true },
        (HiperfaceAction::UnlockField, [number]) => Change::LockField { number: field(number)?, lock: false },
        (HiperfaceAction::DeleteField, [number]) => Change::DeleteField { number: field(number)? },
        (HiperfaceAction::ChangeCode, [number, new]) => change_code(number, new)?,
        (HiperfaceAction::IncrementCounter, []) => Change::IncrementCounter,
        (HiperfaceAction::ClearCounter, []) => Change::ClearCounter,
        (HiperfaceAction::Reset | HiperfaceAction::IncrementCounter | HiperfaceAction::ClearCounter, _) => {
            return Err(usage("no argument"));
        }
        (HiperfaceAction::Check, _) => return Err(usage("nothing or \"restart\"")),
        (HiperfaceAction::ConfigureForNow, _) => return Err(usage("one settings byte, such as 0xE5")),
        (HiperfaceAction::SetPosition | HiperfaceAction::Synchronise, _) => return Err(usage("one position")),
        (HiperfaceAction::CreateField, _) => {
            return Err(usage("NUMBER SIZE or NUMBER STATUS, then code=N, ce=0 or 1, we=0 or 1"));
        }
        (HiperfaceAction::ResizeField, _) => return Err(usage("NUMBER SIZE")),
        (HiperfaceAction::LockField | HiperfaceAction::UnlockField | HiperfaceAction::DeleteField, _) => {
            return Err(usage("one field number"));
        }
        (HiperfaceAction::ChangeCode, _) => {
            return Err(usage("NUMBER HEX; specify the present code with --code NUMBER=HEX"));
        }
    };
    execute_change(common, output, change, &act.consent, &act.action)
}

fn set_position(act: &ActionArgs, text: &str, synchronise: bool) -> Result<Change> {
    let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{text:?} is not a number")))?;
    let wanted = u32::try_from(number).map_err(|_| out_of_range("position", text, 0, u32::MAX.into()))?;
    let DoOptions { exact, kit } = act.own.read()?;
    Ok(Change::SetPosition { wanted, exact, synchronise, kit })
}

fn change_code(number: &str, new: &str) -> Result<Change> {
    let number =
        parse_number(number).ok_or_else(|| Failure::Usage(format!("{number:?} is not a number"))).and_then(|n| {
            u8::try_from(n)
                .ok()
                .and_then(AccessCodeNumber::new)
                .ok_or_else(|| out_of_range("access code", number, 0, 3))
        })?;
    // The message does not repeat the entry, because it may be an access code.
    let new =
        parse_code(new).ok_or_else(|| Failure::Usage("the new code must be two hexadecimal digits".to_owned()))?;
    Ok(Change::ChangeCode { number, new })
}

fn field(text: &str) -> Result<u8> {
    let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{text:?} is not a field number")))?;
    u8::try_from(number).ok().filter(|n| *n < 0xFF).ok_or_else(|| out_of_range("data field", text, 0, 254))
}

fn size(text: &str) -> Result<FieldSize> {
    let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{text:?} is not a size")))?;
    usize::try_from(number).ok().and_then(FieldSize::from_bytes).ok_or_else(|| {
        Failure::Failed(vec![format!("size {text} is not valid: a data field has 16 to 128 bytes, in steps of 16.")])
    })
}

/// Parses a field status, such as `32 code=2 ce=1 we=1`, or a status byte, such as `0xE9`. By default, a field is
/// writable, and its access code is required.
fn parse_field_status(words: &[&str]) -> Result<DataFieldStatus> {
    let [first, options @ ..] = words else { return Err(Failure::Usage("the size is missing".to_owned())) };
    let is_hex = first.starts_with("0x") || first.starts_with("0X");
    let number =
        parse_number(first).ok_or_else(|| Failure::Usage(format!("{first:?} is not a size or a status byte")))?;
    let mut status = match u8::try_from(number) {
        Ok(byte) if is_hex && DataFieldStatus::from_byte(byte).exists() => DataFieldStatus::from_byte(byte),
        _ => DataFieldStatus::new(size(first)?, AccessCodeNumber::ZERO, true),
    };
    let (mut code, mut required, mut writable) = (status.code(), status.code_required(), status.is_writable());
    for option in options {
        match option.split_once('=') {
            Some(("code", value)) => {
                code = value
                    .parse()
                    .ok()
                    .and_then(AccessCodeNumber::new)
                    .ok_or_else(|| out_of_range("code", value, 0, 3))?;
            }
            Some(("ce", value)) => required = parse_switch("ce", value)?,
            Some(("we", value)) => writable = parse_switch("we", value)?,
            _ => return Err(Failure::Usage(format!("{option:?} is not code=N, ce=0, ce=1, we=0 or we=1"))),
        }
    }
    status = DataFieldStatus::new(status.size(), code, required).with_write_enable(writable);
    Ok(status)
}

fn parse_switch(name: &str, value: &str) -> Result<bool> {
    match value {
        "0" => Ok(false),
        "1" => Ok(true),
        _ => Err(Failure::Usage(format!("{name}={value} is not valid: use 0 or 1"))),
    }
}

fn reset(common: &CommonArgs, output: &Output) -> Result {
    match Runner::open(common)?.run(HiperfaceJob::Reset)? {
        HiperfaceOutput::Reset(codes) => {
            let list: Vec<u8> = codes.iter().map(|code| code.byte()).collect();
            output.show(&json!({"done": "reset", "codes": list}), &format!("restarted: {}", codes_text(&codes)))?;
            Ok(Success::Completed)
        }
        other => Err(unexpected_output(&other)),
    }
}

fn set_temporary_settings(common: &CommonArgs, output: &Output, value: &str) -> Result {
    let settings = settings(value)?;
    match Runner::open(common)?.run(HiperfaceJob::ConfigureForNow(settings))? {
        HiperfaceOutput::Configured => {
            let text = format!("until the next restart: {settings}\n");
            output.show(&json!({"done": "configure-for-now", "settings": settings.byte()}), &text)?;
            Ok(Success::Completed)
        }
        other => Err(unexpected_output(&other)),
    }
}

fn check_device(common: &CommonArgs, output: &Output, restart: bool) -> Result {
    let lines =
        result_of!(Runner::open(common)?.run(HiperfaceJob::Check { restart })?, HiperfaceOutput::Check(lines) => lines);
    let quality = lines.iter().flat_map(|line| &line.findings).find_map(|finding| match finding {
        CheckFinding::Line(quality) => Some(quality),
        _ => None,
    });
    // A good line is not listed as a step. Scripts find its values in `line_quality`.
    let shown: Vec<HiperfaceStepResult> =
        lines.iter().filter(|own| own.step != CheckStep::Line || own.verdict != Verdict::Good).cloned().collect();
    check::show_check(output, &explain::check_lines(&shown), quality)
}
