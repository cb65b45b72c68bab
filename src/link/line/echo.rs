//! The echo of a line whose adapter returns the bytes sent by the host.

use crate::parameter::Words;

/// Whether the adapter echoes sent bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// Not known yet; determined during the first exchange.
    Unknown,
    /// The adapter echoes.
    On,
    /// The adapter does not echo.
    Off,
}

impl Echo {
    /// Accepted values of the `echo=` parameter.
    pub(crate) const WORDS: Words<Echo> = Words(&[("auto", Echo::Unknown), ("on", Echo::On), ("off", Echo::Off)]);

    /// Returns the bytes after the echo of `sent`, or `None` while `line` may still be an incomplete echo.
    pub(crate) fn strip<'l>(self, line: &'l [u8], sent: &[u8]) -> Option<&'l [u8]> {
        match self {
            Echo::Off => Some(line),
            Echo::On => line.get(sent.len()..),
            Echo::Unknown => match line.strip_prefix(sent) {
                Some(reply) => Some(reply),
                None if sent.starts_with(line) => None,
                None => Some(line),
            },
        }
    }

    /// Learns whether the line echoes from the first exchange with a valid reply.
    pub(crate) fn learn(&mut self, echo_heard: bool) {
        if *self == Echo::Unknown {
            *self = if echo_heard { Echo::On } else { Echo::Off };
        }
    }
}
