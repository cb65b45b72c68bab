//! The commands for HIPERDRIVE: captured words and packets in words of a person, offline. The drive itself is not reached.

mod decode;
mod image;
mod meaning;
mod simulate;

use super::kind::Kind;
use super::{Failure, Result};
use crate::profile::hiperdrive;
use crate::protocol::hiperdrive::KIND;

pub(super) use meaning::parameter_words;

/// What can be done with drives.
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
    present: |_, _, _| lacking("reading from a link"),
    compare: |left, right| Ok(hiperdrive::compare(&left.clone().into_hiperdrive()?, &right.clone().into_hiperdrive()?)),
    other_device: |_, _| None,
};

/// A command that needs the drive, and what there is.
fn lacking<T>(command: &str) -> Result<T> {
    Err(Failure::Usage(format!(
        "{command} is not for {KIND} devices, which are not reached over a link: decode {KIND} explains their words and packets"
    )))
}
