//! The commands for BiSS encoders.

mod act;
mod decode;
mod inspect;
mod plan;
mod profiles;
mod run;
mod words;
mod write;

use std::time::Duration;

use super::args::{Common, Do, Position, Restore, Save, Simulate, Write};
use super::kind::Kind;
use super::output::Output;
use super::runner::failed;
use super::simulate::{Simulated, settings};
use super::{Failure, Result};
use crate::app::explain;
use crate::profile::biss::{ItemError, ProfileIdentity, RegisterRange, compare};
use crate::profile::{Body, Comparison, ProfileError};
use crate::protocol::biss::KIND;
use crate::protocol::ubicom;
use crate::sim::{ConfigError, biss, bridge};
use crate::units::{CharacterFormat, Moment};

/// How long is waited for a motor, or a shaft at rest, where nobody can be told.
const PATIENCE: Duration = Duration::from_secs(30);

/// BiSS encoders.
pub(super) struct Biss;

impl Kind for Biss {
    fn name(&self) -> &'static str {
        KIND
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

    fn present(&self, common: &Common, _output: &Output) -> Result<Body> {
        profiles::present(common)
    }

    fn compare(&self, left: &Body, right: &Body) -> std::result::Result<Comparison, ProfileError> {
        Ok(compare(&left.clone().into_biss()?, &right.clone().into_biss()?))
    }

    fn other_device(&self, profile: &Body, device: &Body) -> Option<String> {
        let (profile, device) = (&profile.biss()?.identity, &device.biss()?.identity);
        let who = |one: &ProfileIdentity| (one.serial_number.clone(), one.kind());
        (who(profile) != who(device)).then(|| {
            let [profile, device] = [profile, device].map(|one| format!("{} ({})", one.serial_number, one.kind()));
            format!("The profile is of {profile}, the encoder is {device}.")
        })
    }

    fn restore(&self, common: &Common, output: &Output, restore: &Restore, profile: Body) -> Result {
        let profile = profile.into_biss().map_err(|error| failed(&explain::profile(&restore.file, &error)))?;
        profiles::restore(common, output, restore, profile)
    }

    fn simulated(&self, arguments: &Simulate) -> Result<Box<dyn Simulated>> {
        let settings = settings(arguments)?;
        let adapters = |(name, _): &&(String, String)| bridge::Config::KEYS.contains(&name.as_str());
        if let Some((name, _)) = settings.iter().find(adapters).filter(|_| !arguments.bridge) {
            return Err(Failure::Usage(format!("{name} is a setting of the adapter: it needs --bridge")));
        }
        let refused = |error: ConfigError| Failure::Usage(error.to_string());
        Ok(match arguments.bridge {
            true => Box::new(bridge::Adapter::new(&bridge::Config::from_pairs(&settings).map_err(refused)?)),
            false => Box::new(biss::Port::new(&biss::Config::from_pairs(&settings).map_err(refused)?)),
        })
    }
}

impl Simulated for biss::Port {
    fn format(&self, _now: Moment) -> Option<CharacterFormat> {
        Some(ubicom::FORMAT)
    }
}

impl Simulated for bridge::Adapter {
    /// Over USB there is nothing to set.
    fn format(&self, _now: Moment) -> Option<CharacterFormat> {
        None
    }
}

/// The registers that a user names.
fn item(text: &str) -> Result<RegisterRange> {
    text.parse().map_err(|error: ItemError| Failure::Usage(error.to_string()))
}
