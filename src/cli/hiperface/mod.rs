//! The commands for HIPERFACE encoders.

mod act;
mod decode;
mod inspect;
mod profiles;
mod table;
mod write;

pub(super) use profiles::{diff, restore, verify};

use super::args::{Common, Do, Find, Position, Save, Simulate, Write};
use super::kind::Kind;
use super::output::Output;
use super::simulate::{Simulated, settings};
use super::{Failure, Result};
use crate::profile::hiperface::Item;
use crate::protocol::hiperface::{KIND, LineSettings};
use crate::sim::hiperface::{Bus, Config};
use crate::units::{CharacterFormat, Moment};

/// HIPERFACE encoders.
pub(super) struct Hiperface;

impl Kind for Hiperface {
    fn name(&self) -> &'static str {
        KIND
    }

    fn find(&self, common: &Common, output: &Output, find: &Find) -> Result {
        inspect::find(common, output, find)
    }

    fn identify(&self, common: &Common, output: &Output) -> Result {
        inspect::identify(common, output)
    }

    fn status(&self, common: &Common, output: &Output) -> Result {
        inspect::status(common, output)
    }

    fn position(&self, common: &Common, output: &Output, position: &Position) -> Result {
        inspect::position(common, output, position)
    }

    fn read(&self, common: &Common, output: &Output, item: &str) -> Result {
        inspect::read(common, output, item)
    }

    fn save(&self, common: &Common, output: &Output, save: &Save) -> Result {
        profiles::save(common, output, save)
    }

    fn write(&self, common: &Common, output: &Output, write: &Write) -> Result {
        write::write(common, output, write)
    }

    fn act(&self, common: &Common, output: &Output, act: &Do) -> Result {
        act::act(common, output, act)
    }

    fn decode(&self, output: &Output, words: &[String]) -> Result {
        decode::decode(output, words)
    }

    fn simulated(&self, arguments: &Simulate) -> Result<Box<dyn Simulated>> {
        if arguments.bridge {
            return Err(Failure::Usage("--bridge is for biss: hiperface has a serial line of its own".to_owned()));
        }
        let config = Config::from_pairs(&settings(arguments)?).map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(Box::new(Bus::new(&config)))
    }
}

impl Simulated for Bus {
    fn format(&self, now: Moment) -> Option<CharacterFormat> {
        self.encoder(0).and_then(|encoder| encoder.settings_at(now)).and_then(LineSettings::format)
    }
}

/// The item that a user names.
fn item(text: &str) -> Result<Item> {
    text.parse().map_err(|error: crate::profile::hiperface::ItemError| Failure::Usage(error.to_string()))
}
