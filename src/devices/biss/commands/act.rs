//! The `do` command, which runs the check, the filter selection, the preset and the guided procedures at the motor.
//! Without a terminal, the program cannot ask which drive turns the motor, so `--yes` confirms that the motor does not
//! depend on this encoder.

use std::path::Path;
use std::time::Duration;

use crate::devices::biss::state::TEXTS;

use serde_json::json;

use super::args::{BissAction, DoOptions};
use super::plan::{CALIBRATION, change_lines, commit_plan, operations_json, prepare_plan, results_json, results_text};
use super::run::{Runner, registers};
use crate::app::{KindRegistry, explain};
use crate::cli::args::{ActionArgs, CommonArgs};
use crate::cli::consent::{ask_yes_no, can_prompt, read_answer, require_consent};
use crate::cli::number::{out_of_range, parse_number};
use crate::cli::output::Output;
use crate::cli::profiles::{load_profile_to_write, print_write_result};
use crate::cli::runner::{to_failure, unexpected_output};
use crate::cli::{Failure, Result, Success, check};
use crate::devices::biss::jobs::{BissJob, BissOutput, Change};
use crate::devices::biss::procedures::procedure::Outcome;
use crate::devices::biss::profile::{BissProfile, MotorSource, MountingSteps, PresetParts, RegisterRange};
use crate::devices::biss::protocol::{KIND, PositionFilter, PresetValue};
use crate::devices::biss::state::explain as words;
use crate::result_of;

/// How long to wait for the user to turn the motor as required.
const OPERATOR_TIMEOUT: Duration = Duration::from_secs(300);

const ACTIONS: &str = "check, calibrate, wiegand-test, filter, preset, lead-back and mounting";

pub(super) fn run_action(common: &CommonArgs, output: &Output, act: &ActionArgs) -> Result {
    let words: Vec<&str> = act.arguments.iter().map(String::as_str).collect();
    let takes = |form: &str| Failure::Usage(format!("the action takes {form}"));
    match (act.parse_action(KIND, ACTIONS)?, words.as_slice()) {
        (BissAction::Check, []) => check_device(common, output),
        (BissAction::LeadBack, []) => return_to_operation(common, output, act),
        (BissAction::Calibrate, []) => {
            run_guided(common, output, act, MountingSteps { calibrate: true, ..MountingSteps::default() })
        }
        (BissAction::WiegandTest, [] | ["save"]) => {
            let run = MountingSteps { wiegand: Some(!words.is_empty()), ..MountingSteps::default() };
            run_guided(common, output, act, run)
        }
        (BissAction::Mounting, words) => run_guided(common, output, act, parse_mounting_steps(output, words)?),
        (BissAction::Filter, [name]) => {
            let filter = match *name {
                "balanced" => PositionFilter::Balanced,
                "dynamic" => PositionFilter::Dynamic,
                _ => return Err(takes("balanced or dynamic")),
            };
            run_change(common, output, act, |_| Ok(Change::SelectFilter(filter)))
        }
        (BissAction::Preset, words) => {
            let wish = PresetArguments::read(words)?;
            run_change(common, output, act, |runner| wish.to_change(runner))
        }
        (BissAction::Check | BissAction::LeadBack | BissAction::Calibrate, _) => Err(takes("no argument")),
        (BissAction::WiegandTest, _) => Err(takes("nothing or \"save\"")),
        (BissAction::Filter, _) => Err(takes("balanced or dynamic")),
    }
}

fn check_device(common: &CommonArgs, output: &Output) -> Result {
    result_of!(Runner::open(common)?.run(BissJob::Check)?, BissOutput::Check(lines) => check::show(output, &words::check_lines(&lines)))
}

fn return_to_operation(common: &CommonArgs, output: &Output, act: &ActionArgs) -> Result {
    // Returning to operation stores nothing, so no consent is required without a terminal. On a terminal, the user is
    // asked, because entered values would be discarded.
    if !act.consent.yes
        && can_prompt()
        && !ask_yes_no("Values that were entered but not saved will be lost. Return the encoder to operation? [y/N] ")
    {
        return Err(Failure::Failed(vec!["Not confirmed; the encoder was not changed.".to_owned()]));
    }
    match Runner::open(common)?.run(BissJob::ReturnToOperation)? {
        BissOutput::ReturnedToOperation(mode) => {
            let text = format!("in operation, password cleared; it was in mode {mode}\n");
            output.show(&json!({"done": "lead-back", "mode": mode.byte()}), &text)?;
            Ok(Success::Completed)
        }
        other => Err(unexpected_output(&other)),
    }
}

fn run_guided(common: &CommonArgs, output: &Output, act: &ActionArgs, run: MountingSteps) -> Result {
    require_consent(&act.consent)?;
    let motor = if run.needs_motor() { motor(output, act)? } else { MotorSource::Other };
    if act.consent.yes && run.calibrate {
        output.print_message(&format!("Calibration: {CALIBRATION}."));
    }
    run_change(common, output, act, |_| Ok(Change::Guided { run, motor }))
}

fn motor(output: &Output, act: &ActionArgs) -> Result<MotorSource> {
    if act.consent.yes || !can_prompt() {
        output.print_message(
            "With --yes, the motor is assumed to turn without this encoder. A run starts when direction and speed \
             are correct.",
        );
        return Ok(MotorSource::Other);
    }
    let question = "How is the motor driven?\n  1  without this encoder: by another motor, or in open loop\n  2  by \
                    a drive that uses this encoder as feedback\n1 or 2: ";
    match read_answer(question).as_str() {
        "1" => Ok(MotorSource::Other),
        "2" => Ok(MotorSource::ThisEncoder),
        _ => Err(Failure::Failed(vec!["Not answered; nothing was done.".to_owned()])),
    }
}

fn run_change(
    common: &CommonArgs,
    output: &Output,
    act: &ActionArgs,
    change: impl FnOnce(&mut Runner) -> Result<Change>,
) -> Result {
    require_consent(&act.consent)?;
    let mut runner = Runner::open(common)?;
    let change = change(&mut runner)?;
    let prepared = prepare_plan(&mut runner, change)?;
    let (operations, changes) = (operations_json(&prepared.plan), change_lines(&prepared.plan));
    let usual = if can_prompt() { OPERATOR_TIMEOUT } else { super::OPERATOR_TIMEOUT };
    let DoOptions { timeout } = act.own.read()?;
    let patience = timeout.map_or(usual, |seconds| Duration::from_secs(seconds.into()));
    let (spent, outcomes) = commit_plan(&mut runner, output, prepared, &act.consent, patience)?;
    let name = act.action.clone();
    let text = format!("{changes}{}", results_text(&outcomes));
    let done = print_write_result(output, &name, &operations, &spent, &results_json(&outcomes), &text)?;
    if outcomes.iter().all(is_passed) {
        Ok(done)
    } else {
        Err(to_failure(&TEXTS.text("biss_cli.not_passed").with("what", name)))
    }
}

/// Returns whether an operation succeeded.
fn is_passed(outcome: &Outcome) -> bool {
    match outcome {
        Outcome::Tested(report) => report.result.is_passed(),
        Outcome::Skipped { .. } => false,
        Outcome::Stored { .. }
        | Outcome::PresetStored { .. }
        | Outcome::PresetFired { .. }
        | Outcome::FilterSelected(_)
        | Outcome::Calibrated(_) => true,
    }
}

/// Parses the arguments of the `mounting` action, such as `calibrate wiegand-test save preset=ST,MT data=FILE`. If
/// neither `calibrate` nor `wiegand-test` is given, both are run.
fn parse_mounting_steps(output: &Output, words: &[&str]) -> Result<MountingSteps> {
    let mut run = MountingSteps::default();
    let (mut tests, mut saves) = (false, false);
    for word in words {
        match (*word, word.split_once('=')) {
            ("calibrate", _) => run.calibrate = true,
            ("wiegand-test", _) => tests = true,
            ("save", _) => saves = true,
            (_, Some(("preset", value))) => run.preset = Some((parse_preset_value(value)?, PresetParts::Both)),
            (_, Some(("data", file))) => run.data = Some(Box::new(profile(output, Path::new(file))?)),
            _ => {
                let form = "any of calibrate, wiegand-test, save, preset=ST,MT and data=FILE";
                return Err(Failure::Usage(format!("{word:?} is not a part of mounting; use {form}")));
            }
        }
    }
    if !run.calibrate && !tests {
        (run.calibrate, tests) = (true, true);
    }
    run.wiegand = tests.then_some(saves);
    Ok(run)
}

fn profile(output: &Output, file: &Path) -> Result<BissProfile> {
    load_profile_to_write(output, file)?
        .into_profile()
        .map_err(|error| to_failure(&explain::profile_file_error_text(file, &error, KindRegistry::NONE)))
}

fn parse_preset_value(text: &str) -> Result<PresetValue> {
    let numbers: Vec<&str> = text.split(',').collect();
    match numbers.as_slice() {
        [singleturn] => value(singleturn, "0"),
        [singleturn, multiturn] => value(singleturn, multiturn),
        _ => Err(Failure::Usage(format!("{text:?} is not a position, such as 98304 or 98304,0"))),
    }
}

/// Parses a preset value that fits into the registers. The position of the encoder may have fewer bits.
fn value(singleturn: &str, multiturn: &str) -> Result<PresetValue> {
    let part = |name: &str, text: &str| {
        let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{name}: {text:?} is not a number")))?;
        u32::try_from(number).ok().filter(|part| *part < 1 << 24).ok_or_else(|| out_of_range(name, text, 0, 0xFF_FFFF))
    };
    let (steps, turns) = (part("singleturn", singleturn)?, part("multiturn", multiturn)?);
    PresetValue::new(steps, turns).ok_or_else(|| out_of_range("singleturn", singleturn, 0, 0xFF_FFFF))
}

/// The arguments of a preset in the form `[ST [MT]] [singleturn|multiturn]`.
struct PresetArguments<'a> {
    singleturn: Option<&'a str>,
    multiturn: Option<&'a str>,
    parts: PresetParts,
}

impl<'a> PresetArguments<'a> {
    fn read(words: &[&'a str]) -> Result<Self> {
        let (numbers, parts) = match words {
            [numbers @ .., "singleturn"] => (numbers, PresetParts::Singleturn),
            [numbers @ .., "multiturn"] => (numbers, PresetParts::Multiturn),
            numbers => (numbers, PresetParts::Both),
        };
        let (singleturn, multiturn) = match (numbers, parts) {
            ([], _) => (None, None),
            ([singleturn], PresetParts::Both | PresetParts::Singleturn) => (Some(*singleturn), None),
            ([singleturn, multiturn], _) => (Some(*singleturn), Some(*multiturn)),
            _ => {
                let form = "the action takes [ST [MT]], then nothing, singleturn or (behind both numbers) multiturn";
                return Err(Failure::Usage(form.to_owned()));
            }
        };
        // Invalid numbers are reported before the link is opened.
        value(singleturn.unwrap_or("0"), multiturn.unwrap_or("0"))?;
        Ok(PresetArguments { singleturn, multiturn, parts })
    }

    /// Returns the change that the arguments request. A missing multiturn value is 0. If only the singleturn part is
    /// preset, the stored multiturn value is kept.
    fn to_change(&self, runner: &mut Runner) -> Result<Change> {
        let stored = |runner: &mut Runner| -> Result<String> {
            let Ok(range) = BissProfile::PRESET.parse::<RegisterRange>() else { return Ok("0".to_owned()) };
            let bytes = registers(runner, range)?;
            Ok(<[u8; 6]>::try_from(bytes).map_or(0, |bytes| PresetValue::parse(bytes).multiturn()).to_string())
        };
        let value = match (self.singleturn, self.multiturn) {
            (None, _) => None,
            (Some(singleturn), Some(multiturn)) => Some(value(singleturn, multiturn)?),
            (Some(singleturn), None) if self.parts == PresetParts::Singleturn => {
                Some(value(singleturn, &stored(runner)?)?)
            }
            (Some(singleturn), None) => Some(value(singleturn, "0")?),
        };
        Ok(Change::Preset { value, parts: Some(self.parts) })
    }
}
