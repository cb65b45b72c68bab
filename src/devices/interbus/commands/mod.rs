//! The commands for INTERBUS encoders behind a gateway; words of the process data are explained offline as well.

mod act;
mod args;
mod decode;
mod inspect;
mod meaning;
mod plan;
mod position;
mod profiles;
mod run;
mod simulate;
mod value;
mod write;

use crate::app::Text;
use crate::cli::args::{Common, Consenting};
use crate::cli::consent::{ask, can_ask};
use crate::cli::kind::{Kind, lacking};
use crate::cli::output::Output;
use crate::cli::{Failure, Result};
use crate::devices::interbus::profile::{Item, ItemError};
use crate::devices::interbus::protocol::KIND;
use crate::link::Scheme;

pub(crate) use args::WordMode;

/// What can be done with INTERBUS encoders.
pub(crate) const COMMANDS: Kind = Kind {
    name: KIND,
    find: |_, _, _| lacking("find", KIND),
    identify: inspect::identify,
    status: |common, output, _| inspect::status(common, output),
    position: position::position,
    read: |common, output, read| inspect::read(common, output, &read.item),
    save: profiles::save,
    write: write::write,
    act: act::act,
    decode: decode::decode,
    restore: profiles::restore,
    simulated: simulate::simulated,
    present: profiles::present,
    compare: profiles::compare,
    remark: |_| None,
    other_device: profiles::other_device,
};

/// The item that a user names. One of a program or a cam that there is not is understood, and out of range.
fn item(text: &str) -> Result<Item> {
    text.parse().map_err(|error: ItemError| match error {
        ItemError::Unknown(_) => Failure::Usage(error.to_string()),
        ItemError::Program { .. } | ItemError::Cam { .. } => Failure::Failed(vec![format!("{text}: {error}.")]),
    })
}

/// What becomes of the process data, for whoever has a machine at them.
#[derive(Clone, Copy)]
enum Disturbs {
    /// Values are read out.
    Reading,
    /// So are cam programs, each of which is selected for that.
    Programs,
    /// What somebody has left is ended, and stored.
    LeadingBack,
}

impl Disturbs {
    /// Says it before it happens. What switches live outputs is asked for on a terminal, where nothing has consented to a
    /// write and the encoder is no virtual one; without a terminal it goes on.
    fn begin(self, common: &Common, output: &Output, consent: Option<&Consenting>) -> Result<()> {
        self.say(output);
        let is_virtual = common.link.as_ref().is_some_and(|link| link.scheme == Scheme::Sim);
        let consented = consent.is_some_and(|consent| consent.yes);
        if !matches!(self, Disturbs::Programs) || is_virtual || consented || !can_ask() {
            return Ok(());
        }
        if ask("Does the machine stand still? [y/N] ") {
            return Ok(());
        }
        Err(Failure::Failed(vec!["Not confirmed; no cam program was selected.".to_owned()]))
    }

    /// Says it before it happens.
    fn say(self, output: &Output) {
        let id = match self {
            Disturbs::Reading => "ib_disturbs.reading",
            Disturbs::Programs => "ib_disturbs.programs",
            Disturbs::LeadingBack => "ib_disturbs.lead_back",
        };
        output.remark(&Text::new(id).terminal());
    }
}
