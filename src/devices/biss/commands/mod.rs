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

use crate::buses::bridge::sim as bridge;
use crate::buses::ubicom::protocol as ubicom;
use crate::cli::args::Simulate;
use crate::cli::kind::{Kind, lacking};
use crate::cli::output::Output;
use crate::cli::simulate::{Simulated, settings};
use crate::cli::{Failure, Result};
use crate::devices::biss::profile::{ItemError, RegisterRange};
use crate::devices::biss::protocol::KIND;
use crate::devices::biss::sim;
use crate::sim::{AT_ADAPTER, ConfigError};
use crate::units::{CharacterFormat, Moment};

/// How long is waited for a motor, or a shaft at rest, where nobody can be told.
const PATIENCE: Duration = Duration::from_secs(30);

/// What can be done with BiSS encoders.
pub(crate) const COMMANDS: Kind = Kind {
    name: KIND,
    find: |_, _, _| lacking("find", KIND),
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
    remark: profiles::remark,
    other_device: profiles::other_device,
};

fn simulated(_: &Output, arguments: &Simulate) -> Result<Box<dyn Simulated>> {
    let settings = settings(arguments)?;
    let known = bridge::keys(&AT_ADAPTER);
    let needs_adapter = |name: &str| known.contains(&name) && !sim::Config::KEYS.contains(&name);
    if let Some((name, _)) = settings.iter().find(|(name, _)| needs_adapter(name)).filter(|_| !arguments.bridge) {
        return Err(Failure::Usage(format!("{name} is a setting of the adapter: it needs --bridge")));
    }
    let refused = |error: ConfigError| Failure::Usage(error.to_string());
    Ok(match arguments.bridge {
        true => Box::new(bridge::Adapter::from_pairs(&settings, &AT_ADAPTER).map_err(refused)?),
        false => Box::new(sim::Port::new(&sim::Config::from_pairs(&settings).map_err(refused)?)),
    })
}

impl Simulated for sim::Port {
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
