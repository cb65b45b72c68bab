//! Consent to a write, given by `--yes` or at the terminal after the plan has been shown.

use std::io::{IsTerminal, stderr, stdin};
use std::path::Path;

use super::args::ConsentArgs;
use super::output::{Output, write_stderr};
use super::plan::print_undo;
use super::runner::{CliDevice, JobFailure, Runner};
use super::user_store::{exchange_entries, report_other_holders};
use super::{Failure, Result};
use crate::profile::Consent;
use crate::worker::commit::{ApprovedPlan, PlannedWrite};
use crate::worker::{self, NotStarted};

/// Returns an error if consent cannot be obtained. Without a terminal, there is no way to ask the user, so the command
/// is rejected before anything is opened.
pub fn require_consent(consent: &ConsentArgs) -> Result<()> {
    if consent.yes || can_prompt() {
        return Ok(());
    }
    Err(Failure::Usage("this writes to the device: add --yes, or run it on a terminal; nothing was changed".to_owned()))
}

/// Returns whether a user can answer at a terminal.
pub(crate) fn can_prompt() -> bool {
    stdin().is_terminal() && stderr().is_terminal()
}

/// Shows the plan and all other points that require consent, and asks about each of them unless the command line has
/// given consent. Returns the approved plan.
pub fn confirm_plan<D: CliDevice, P: PlannedWrite>(
    runner: &Runner<D>,
    output: &Output,
    consent: &ConsentArgs,
    prepared: P,
    shown: &[&str],
) -> Result<ApprovedPlan<P>> {
    if !consent.yes {
        report_other_holders(runner.store.logbook_server(), output);
        for (at, text) in shown.iter().enumerate() {
            output.print_message(text.trim_end());
            if at == 0 {
                print_undo(output, &prepared);
            }
            if !ask_yes_no("Write? [y/N] ") {
                return Err(Failure::Failed(vec!["Not confirmed; nothing was written.".to_owned()]));
            }
        }
        // Other benches may have forgotten the device while the user was thinking.
        exchange_entries(&runner.store);
    }
    let granted = Consent::to(prepared.plan().id());
    Ok(ApprovedPlan { prepared, consent: granted, force_wear: consent.force_wear, undoes: consent.undoes.clone() })
}

/// Rejects a write if the device has reached its limit of write cycles, or if their number is unknown. This check
/// precedes the request for consent.
pub fn check_wear<D>(consent: &ConsentArgs, prepared: &impl PlannedWrite) -> Result<()>
where
    D: CliDevice,
    D::Error: From<NotStarted>,
{
    let cost = prepared.plan().write_cycles();
    worker::check_wear(prepared.cycles_seen(), cost, prepared.wear_limit(), consent.force_wear)
        .map_err(|refused| JobFailure::<D>::Job(Box::new(refused.into())).into_failure())
}

/// Asks on a terminal whether an existing file may be replaced, before a device is opened. Without a terminal, the file
/// is replaced, as in other tools, and [`ReplacementNotice::report_replacement`] reports the replacement.
pub(super) fn confirm_replacement(path: &Path, force: bool) -> Result<ReplacementNotice> {
    // A pipe or a device file has no content to replace.
    let is_there = path.metadata().is_ok_and(|found| found.is_file());
    if !is_there || force {
        return Ok(ReplacementNotice { message: None });
    }
    let name = path.display();
    if !can_prompt() {
        return Ok(ReplacementNotice { message: Some(format!("{name} already existed and was replaced.")) });
    }
    if ask_yes_no(&format!("{name} already exists. Replace it? [y/N] ")) {
        return Ok(ReplacementNotice { message: None });
    }
    Err(Failure::Failed(vec![format!("Not confirmed; {name} was not changed.")]))
}

pub(super) struct ReplacementNotice {
    message: Option<String>,
}

impl ReplacementNotice {
    /// Reports that a file was replaced, unless the user was asked before.
    pub(super) fn report_replacement(&self, output: &Output) {
        if let Some(message) = &self.message {
            output.print_message(message);
        }
    }
}

pub(crate) fn ask_yes_no(question: &str) -> bool {
    matches!(read_answer(question).as_str(), "y" | "Y" | "yes")
}

/// Asks the user at the terminal. The answer is empty if the terminal cannot be read.
pub(crate) fn read_answer(question: &str) -> String {
    write_stderr(question);
    let mut answer = String::new();
    match stdin().read_line(&mut answer) {
        Ok(_) => answer.trim().to_owned(),
        Err(_) => String::new(),
    }
}
