//! The commands for HIPERFACE encoders.

mod act;
mod decode;
mod inspect;
mod profiles;
mod run;
mod table;
mod write;

use super::args::{Common, Do, Find, Position, Restore, Save, Simulate, Write};
use super::kind::Kind;
use super::output::Output;
use super::runner::failed;
use super::simulate::{Simulated, settings};
use super::{Failure, Result};
use crate::app::explain;
use crate::profile::hiperface::{Item, compare};
use crate::profile::{Body, Comparison, ProfileError};
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

    fn present(&self, common: &Common, output: &Output) -> Result<Body> {
        profiles::present(common, output)
    }

    fn compare(&self, left: &Body, right: &Body) -> std::result::Result<Comparison, ProfileError> {
        let (left, right) = (left.clone().into_hiperface()?, right.clone().into_hiperface()?);
        Ok(compare(&left.fields, &right.fields))
    }

    fn other_device(&self, profile: &Body, device: &Body) -> Option<String> {
        profiles::other_device(profile.hiperface()?, device.hiperface()?)
    }

    fn restore(&self, common: &Common, output: &Output, restore: &Restore, profile: Body) -> Result {
        let profile = profile.into_hiperface().map_err(|error| failed(&explain::profile(&restore.file, &error)))?;
        profiles::restore(common, output, restore, profile)
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
