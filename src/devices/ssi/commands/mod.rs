//! The commands for SSI encoders: `ssi` without an encoder, and what can be done with one or its profile.

mod args;
mod export;
mod find;
mod frames;
mod layout;
mod live;
mod profiles;
mod run;

use crate::buses::bridge::sim::{Adapter, Attachable};
use crate::cli::args::Simulate;
use crate::cli::kind::Kind;
use crate::cli::output::Output;
use crate::cli::simulate::{Simulated, settings};
use crate::cli::{Failure, Result};
use crate::devices::ssi::protocol::KIND;
use crate::devices::ssi::sim::{AtAdapter, Encoder};
use crate::sim::AT_ADAPTER;

pub(crate) use args::Ssi;
use args::SsiLayout;

/// What can be done with SSI encoders. They send their position and have no memory.
pub(crate) const COMMANDS: Kind = Kind {
    name: KIND,
    find: |_, _, _| lacking("find", "connect it to an adapter of its own"),
    identify: |_, _| lacking("identify", "its type label says who it is"),
    status: live::status,
    position: live::position,
    read: |_, _, _| lacking("read", "there are no registers in it"),
    save: profiles::save,
    write: |_, _, _| lacking("write", SET),
    act: |_, _, _| lacking("do", SET),
    decode: |_, _| lacking("decode", "use ssi decode --layout FILE|SPEC FRAME"),
    restore: |_, _, _, _| lacking("restore", SET),
    simulated,
    present: |_, _, _| refuse("reading a profile from a link", "compare two files with diff FILE FILE"),
    compare: profiles::compare,
    remark: |_| None,
    other_device: |_, _| None,
};

/// Who sets an encoder up.
const SET: &str = "it is set with its maker's own tool";

pub(crate) fn ssi(output: &Output, command: &Ssi) -> Result {
    match command {
        Ssi::Decode(arguments) => frames::decode(output, arguments),
        Ssi::Encode(arguments) => frames::encode(output, arguments),
        Ssi::Find(arguments) => find::find(output, arguments),
        Ssi::Export(arguments) => export::export(output, arguments),
    }
}

/// The adapter before a virtual encoder that sends the frames of `--layout`.
fn simulated(output: &Output, arguments: &Simulate) -> Result<Box<dyn Simulated>> {
    let settings = settings(arguments)?;
    let encoder = match &arguments.layout {
        Some(_) if settings.iter().any(|(name, _)| name == "ssi") => {
            return Err(Failure::Usage("--layout and --set ssi= say the same: give one of them".to_owned()));
        }
        Some(spec) => {
            let chosen = layout::choose(&output.as_text(), &SsiLayout { spec: spec.clone() })?;
            let (direction, preset) = (chosen.profile.direction, chosen.profile.preset);
            AtAdapter::sending(Encoder { layout: chosen.layout, direction, preset })
        }
        None => AtAdapter::DELIVERED,
    };
    // In place of the one that is as delivered, which has the same settings.
    let others = AT_ADAPTER.into_iter().filter(|device| device.keys() != encoder.keys());
    let devices: Vec<&dyn Attachable> = [&encoder as &dyn Attachable].into_iter().chain(others).collect();
    let adapter = Adapter::from_pairs(&settings, &devices).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Box::new(adapter))
}

/// A command that SSI encoders do not have, and what there is instead.
fn lacking(command: &str, instead: &str) -> Result {
    refuse(command, instead)
}

fn refuse<T>(command: &str, instead: &str) -> Result<T> {
    Err(Failure::Usage(format!(
        "{command} is not for {KIND} devices, which send a position and nothing else: {instead}"
    )))
}
