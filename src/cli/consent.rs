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
    if ask("Write? [y/N] ") {
        return Ok(());
    }
    Err(Failure::Failed(vec!["Not confirmed; nothing was written.".to_owned()]))
}

/// Asks for a yes.
pub(super) fn ask(question: &str) -> bool {
    matches!(answer(question).as_str(), "y" | "Y" | "yes")
}

/// Asks somebody who sits there. A terminal that cannot be read from gives no answer.
pub(super) fn answer(question: &str) -> String {
    say(question);
    let mut answer = String::new();
    match stdin().read_line(&mut answer) {
        Ok(_) => answer.trim().to_owned(),
        Err(_) => String::new(),
    }
}
