//! Consent to a write: given with --yes, or on a terminal after the plan was shown.

use std::io::{IsTerminal, stderr, stdin};

use super::args::Consenting;
use super::output::{Output, say};
use super::{Failure, Result};

/// Without a terminal nobody can be asked: refused before anything is opened.
pub(super) fn require_consent(consent: &Consenting) -> Result<()> {
    if consent.yes || can_ask() {
        return Ok(());
    }
    Err(Failure::Usage(
        "this writes to the device: give --yes, or run it on a terminal; nothing was touched".to_owned(),
    ))
}

/// Somebody sits there.
pub(super) fn can_ask() -> bool {
    stdin().is_terminal() && stderr().is_terminal()
}

/// Shows the plan and asks, unless the command line has consented already.
pub(super) fn agree(output: &Output, consent: &Consenting, plan: &str) -> Result<()> {
    if consent.yes {
        return Ok(());
    }
    output.remark(plan.trim_end());
    if ask("Write? [y/N] ") { Ok(()) } else { Err(not_confirmed()) }
}

/// Nobody said yes.
pub(super) fn not_confirmed() -> Failure {
    Failure::Failed(vec!["Not confirmed; nothing was written.".to_owned()])
}

/// Asks for a yes. A terminal that cannot be read from gives none.
pub(super) fn ask(question: &str) -> bool {
    say(question);
    let mut answer = String::new();
    stdin().read_line(&mut answer).is_ok() && matches!(answer.trim(), "y" | "Y" | "yes")
}
