//! The `do` command: saves and recalls parameters, restores factory settings, runs the presence test and the device
//! check, acknowledges a fault, and sets the position.

use super::args::{DoOptions, DriveOption, HiperdriveAction};
use super::plan::{change_lines, commit_plan, operations_json, prepare_plan};
use super::run::{Runner, drive};
use crate::cli::args::{ActionArgs, CommonArgs};
use crate::cli::consent::require_consent;
use crate::cli::number::parse_number;
use crate::cli::output::Output;
use crate::cli::profiles::print_write_result;
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result, check};
use crate::devices::hiperdrive::jobs::{Change, HiperdriveJob, HiperdriveOutput};
use crate::devices::hiperdrive::procedures::DriveIdentity;
use crate::devices::hiperdrive::profile::Service;
use crate::devices::hiperdrive::protocol::{DriveNumber, KIND};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain;
use crate::result_of;

const ACTIONS: &str = "check, acknowledge, save, recall, factory, presence-test and set-position";

pub(super) fn run_action(common: &CommonArgs, output: &Output, act: &ActionArgs) -> Result {
    let words: Vec<&str> = act.arguments.iter().map(String::as_str).collect();
    let action = act.parse_action(KIND, ACTIONS);
    let of_drive = matches!(action, Ok(HiperdriveAction::Acknowledge | HiperdriveAction::SetPosition));
    let DoOptions { of, all } = act.own.read()?;
    let mine = [
        (of.drive.is_some() && !of_drive, "--drive"),
        (all && !matches!(action, Ok(HiperdriveAction::Factory)), "--all"),
    ];
    if let Some((_, option)) = mine.into_iter().find(|(given, _)| *given) {
        return Err(Failure::Usage(format!("{option} is not for {}", act.action)));
    }
    let takes = |form: &str| Failure::Usage(format!("the action takes {form}"));
    let action = action?;
    let change = match (action, words.as_slice()) {
        (HiperdriveAction::Check, []) => return check_device(common, output),
        (HiperdriveAction::Acknowledge, []) => Change::Do(Service::Acknowledge(drive(&of))),
        (HiperdriveAction::Save, []) => Change::Do(Service::Save),
        (HiperdriveAction::Recall, []) => Change::Do(Service::Recall),
        (HiperdriveAction::Factory, []) => Change::Do(if all { Service::FactoryAll } else { Service::Factory }),
        (HiperdriveAction::PresenceTest, []) => Change::Do(Service::Reset),
        (HiperdriveAction::SetPosition, [position]) => set_position(&of, position)?,
        (HiperdriveAction::SetPosition, _) => return Err(takes("one position")),
        (
            HiperdriveAction::Check
            | HiperdriveAction::Acknowledge
            | HiperdriveAction::Save
            | HiperdriveAction::Recall
            | HiperdriveAction::Factory
            | HiperdriveAction::PresenceTest,
            _,
        ) => return Err(takes("no argument")),
    };
    require_consent(&act.consent)?;
    let mut runner = Runner::open(common)?;
    let prepared = prepare_plan(&mut runner, output, change)?;
    let operations = operations_json(&prepared.plan);
    let changes = change_lines(&prepared.plan);
    let before: Vec<DriveNumber> = prepared.identity.drives.iter().map(|own| own.number).collect();
    let spent = commit_plan(&mut runner, output, prepared, &act.consent)?;
    let found = if action == HiperdriveAction::PresenceTest { drives(&mut runner)? } else { Vec::new() };
    match action {
        HiperdriveAction::Factory if !all => output.print_message(&TEXTS.text("hd_cli.not_saved").terminal_text()),
        HiperdriveAction::Acknowledge if operations.is_empty() => {
            output.print_message(&TEXTS.text("hd_cli.no_fault").with("drive", drive(&of).get()).terminal_text());
        }
        _ => {}
    }
    let drive_list: String = found.iter().map(|own| format!("drive {}: {}\n", own.number.get(), own.name)).collect();
    let done = print_write_result(output, &act.action, &operations, &spent, &[], &format!("{changes}{drive_list}"))?;
    // The action may have been executed without having the desired effect.
    match action {
        HiperdriveAction::PresenceTest => check_present(&before, &found)?,
        HiperdriveAction::Acknowledge if !operations.is_empty() => {
            check_acknowledged(&mut runner, output, drive(&of))?;
        }
        _ => {}
    }
    Ok(done)
}

/// Checks that acknowledging the fault of a drive has cleared it.
pub(super) fn check_acknowledged(runner: &mut Runner, output: &Output, drive: DriveNumber) -> Result<()> {
    let again = prepare_plan(runner, output, Change::Do(Service::Acknowledge(drive)))?;
    if again.plan.is_empty() {
        Ok(())
    } else {
        Err(to_failure(&TEXTS.text("hd_cli.still_faulty").with("drive", drive.get())))
    }
}

fn drives(runner: &mut Runner) -> Result<Vec<DriveIdentity>> {
    Ok(result_of!(runner.run(HiperdriveJob::Identify)?, HiperdriveOutput::Identity(identity) => identity.drives))
}

/// Checks that the presence test has found at least one drive, including every drive known before.
fn check_present(before: &[DriveNumber], found: &[DriveIdentity]) -> Result<()> {
    if found.is_empty() {
        return Err(to_failure(&TEXTS.text("hd_cli.no_drives")));
    }
    match before.iter().find(|number| found.iter().all(|own| own.number != **number)) {
        Some(gone) => Err(to_failure(&TEXTS.text("hd_cli.drive_gone").with("drive", gone.get()))),
        None => Ok(()),
    }
}

fn set_position(of: &DriveOption, text: &str) -> Result<Change> {
    let number = parse_number(text).ok_or_else(|| Failure::Usage(format!("{text:?} is not a number")))?;
    let position = i32::try_from(number).map_err(|_| {
        let text_of_range = TEXTS.text("hd_cli.position_range").with("value", text);
        to_failure(&text_of_range.with("low", i32::MIN).with("high", i32::MAX))
    })?;
    Ok(Change::SetPosition { drive: drive(of), position, save: true })
}

fn check_device(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    result_of!(runner.run(HiperdriveJob::Check)?, HiperdriveOutput::Check(lines) => check::show(output, &explain::check_lines(&lines)))
}
