//! The commands for HIPERFACE encoders.

mod act;
mod decode;
mod inspect;
mod profiles;
mod run;
mod table;
mod write;

use crate::cli::args::Simulate;
use crate::cli::kind::Kind;
use crate::cli::output::Output;
use crate::cli::simulate::{Simulated, settings};
use crate::cli::{Failure, Result};
use crate::devices::hiperface::profile::Item;
use crate::devices::hiperface::protocol::{KIND, LineSettings};
use crate::devices::hiperface::sim::{Bus, Config};
use crate::units::{CharacterFormat, Moment};

/// What can be done with HIPERFACE encoders.
pub(crate) const COMMANDS: Kind = Kind {
    name: KIND,
    find: inspect::find,
    identify: inspect::identify,
    status: |common, output, _| inspect::status(common, output),
    position: inspect::position,
    read: |common, output, read| inspect::read(common, output, &read.item),
    save: profiles::save,
    write: write::write,
    act: act::act,
    decode: |output, arguments| decode::decode(output, &arguments.hex),
    restore: profiles::restore,
    simulated,
    present: profiles::present,
    compare: profiles::compare,
    remark: |_| None,
    other_device: profiles::other_device,
};

fn simulated(_: &Output, arguments: &Simulate) -> Result<Box<dyn Simulated>> {
    if arguments.bridge {
        return Err(Failure::Usage("--bridge is for biss: hiperface has a serial line of its own".to_owned()));
    }
    let config = Config::from_pairs(&settings(arguments)?).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Box::new(Bus::new(&config)))
}

impl Simulated for Bus {
    fn format(&self, now: Moment) -> Option<CharacterFormat> {
        self.encoder(0).and_then(|encoder| encoder.settings_at(now)).and_then(LineSettings::format)
    }
}

/// The item that a user names.
fn item(text: &str) -> Result<Item> {
    text.parse().map_err(|error: crate::devices::hiperface::profile::ItemError| Failure::Usage(error.to_string()))
}
