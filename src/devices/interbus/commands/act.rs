//! The command `do`: preset, factory settings, device check, and the return to the previous mode.

use serde_json::json;

use super::DisturbanceLevel;
use super::args::InterbusAction;
use super::inspect::mode_name;
use super::plan::{change_lines, commit_plan, operations_json, prepare_plan};
use super::run::Runner;
use super::value::value;
use crate::cli::args::{ActionArgs, CommonArgs};
use crate::cli::consent::require_consent;
use crate::cli::output::Output;
use crate::cli::profiles::show_changes;
use crate::cli::{Failure, Result, Success, check};
use crate::devices::interbus::jobs::{Change, InterbusJob, InterbusOutput};
use crate::devices::interbus::profile::{Item, ItemValue};
use crate::devices::interbus::protocol::{KIND, Reply};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain;
use crate::result_of;

const ACTIONS: &str = "check, preset, default and lead-back";

pub(super) fn run_action(common: &CommonArgs, output: &Output, act: &ActionArgs) -> Result {
    let words: Vec<&str> = act.arguments.iter().map(String::as_str).collect();
    let takes = |form: &str| Failure::Usage(format!("the action takes {form}"));
    match (act.parse_action(KIND, ACTIONS)?, words.as_slice()) {
        (InterbusAction::Check, []) => check_device(common, output),
        (InterbusAction::LeadBack, []) => restore_mode(common, output),
        (InterbusAction::Default, []) => {
            output.print_message(&TEXTS.text("ib_disturbs.default").terminal_text());
            run_change(common, output, act, |_| Ok(Change::Default))
        }
        (InterbusAction::Preset, []) => {
            run_change(common, output, act, |runner| Ok(Change::Preset { value: preset(runner)? }))
        }
        (InterbusAction::Preset, [number]) => match value(Item::Preset, number)? {
            ItemValue::Number(value) => run_change(common, output, act, |_| Ok(Change::Preset { value })),
            _ => Err(takes("a position")),
        },
        (InterbusAction::Preset, _) => Err(takes("nothing or a position")),
        (InterbusAction::Check | InterbusAction::LeadBack | InterbusAction::Default, _) => Err(takes("no argument")),
    }
}

fn preset(runner: &mut Runner) -> Result<u32> {
    Ok(
        result_of!(runner.run(InterbusJob::Read(Item::Preset))?, InterbusOutput::Item(ItemValue::Number(preset)) => preset),
    )
}

fn check_device(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::Reading.print_effect(output);
    result_of!(runner.run(InterbusJob::Check)?, InterbusOutput::Check(lines) => check::show(output, &explain::check_lines(&lines)))
}

fn restore_mode(common: &CommonArgs, output: &Output) -> Result {
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::RestoringMode.print_effect(output);
    let now = result_of!(runner.run(InterbusJob::RestoreMode)?, InterbusOutput::ModeRestored(now) => now);
    let reading = result_of!(runner.run(InterbusJob::Position)?, InterbusOutput::Position(reading) => reading);
    let (is, word) = (explain::startup_mode_text(now).terminal_text(), format!("0x{:08X}", reading.word));
    let json = json!({"done": "lead-back", "mode": mode_name(now), "word": word});
    let Reply::Error(error) = reading.reply() else {
        output.show(&json, &format!("the encoder runs, in mode {is}\n"))?;
        return Ok(Success::Completed);
    };
    output.show(&json, &format!("the encoder is in mode {is}\n"))?;
    let why = explain::error_word_text(error).terminal_text();
    Err(Failure::Failed(vec![format!("The encoder was returned to operation, but sends {word}: {why}")]))
}

fn run_change(
    common: &CommonArgs,
    output: &Output,
    act: &ActionArgs,
    change: impl FnOnce(&mut Runner) -> Result<Change>,
) -> Result {
    require_consent(&act.consent)?;
    let mut runner = Runner::open(common)?;
    DisturbanceLevel::Reading.print_effect(output);
    let change = change(&mut runner)?;
    let prepared = prepare_plan(&mut runner, output, change)?;
    let (operations, changes) = (operations_json(&prepared.plan), change_lines(&prepared.plan));
    let spent = commit_plan(&mut runner, output, prepared, &act.consent)?;
    show_changes(output, &act.action, &operations, &changes, &spent)
}
