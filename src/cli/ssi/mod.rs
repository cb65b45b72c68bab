//! The commands for SSI encoders: `ssi` without an encoder, and what can be done with one or its profile.

mod export;
mod frames;
mod layout;
mod profiles;

use super::args::Ssi;
use super::kind::Kind;
use super::output::Output;
use super::{Failure, Result};
use crate::protocol::ssi::KIND;

/// What can be done with SSI encoders. They send their position and have no memory.
pub(super) const COMMANDS: Kind = Kind {
    name: KIND,
    find: |_, _, _| lacking("find", "connect it to an adapter of its own"),
    identify: |_, _| lacking("identify", "its type label says who it is"),
    status: |_, _| lacking("status", "its error bits come with its frames; ssi decode explains them"),
    position: |_, _, _| lacking("position", "ssi decode explains its frames"),
    read: |_, _, _| lacking("read", "there are no registers in it"),
    save: profiles::save,
    write: |_, _, _| lacking("write", SET),
    act: |_, _, _| lacking("do", SET),
    decode: |_, _| lacking("decode", "use ssi decode --layout FILE|SPEC FRAME"),
    restore: |_, _, _, _| lacking("restore", SET),
    simulated: |_| refuse("simulate", "use simulate biss --bridge --set ssi=SPEC: such an encoder is behind it"),
    present: |_, _| refuse("reading a profile from a link", "compare two files with diff FILE FILE"),
    compare: profiles::compare,
    other_device: |_, _| None,
};

/// Who sets an encoder up.
const SET: &str = "it is set with its maker's own tool";

pub(super) fn ssi(output: &Output, command: &Ssi) -> Result {
    match command {
        Ssi::Decode(arguments) => frames::decode(output, arguments),
        Ssi::Encode(arguments) => frames::encode(output, arguments),
        Ssi::Export(arguments) => export::export(output, arguments),
    }
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
