//! The commands for INTERBUS encoders: words of the process data in words of a person, and profiles, both offline. The
//! encoder itself is not reached.

mod decode;
mod meaning;
mod profiles;
mod simulate;

use super::kind::Kind;
use super::{Failure, Result};
use crate::protocol::interbus::KIND;

/// What can be done with INTERBUS encoders.
pub(super) const COMMANDS: Kind = Kind {
    name: KIND,
    find: |_, _, _| lacking("find"),
    identify: |_, _| lacking("identify"),
    status: |_, _, _| lacking("status"),
    position: |_, _, _| lacking("position"),
    read: |_, _, _| lacking("read"),
    save: |_, _, _| lacking("save"),
    write: |_, _, _| lacking("write"),
    act: |_, _, _| lacking("do"),
    decode: decode::decode,
    restore: |_, _, _, _| lacking("restore"),
    simulated: simulate::simulated,
    present: |_, _| lacking("reading from a link"),
    compare: profiles::compare,
    other_device: profiles::other_device,
};

/// A command that needs the encoder, and what there is.
fn lacking<T>(command: &str) -> Result<T> {
    Err(Failure::Usage(format!(
        "{command} is not for {KIND} devices, which are not reached over a link: decode {KIND} explains their words"
    )))
}
