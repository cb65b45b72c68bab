//! Echo handling for adapters that return the bytes sent by the host.

use crate::parameter::Keywords;

/// Whether the adapter echoes sent bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echo {
    /// Not known yet. The first exchange shows whether there is an echo.
    Unknown,
    /// The adapter echoes sent bytes.
    On,
    /// The adapter does not echo sent bytes.
    Off,
}

impl Echo {
    /// Accepted values of the `echo=` parameter.
    pub(crate) const KEYWORDS: Keywords<Echo> =
        Keywords(&[("auto", Echo::Unknown), ("on", Echo::On), ("off", Echo::Off)]);

    /// Returns the received bytes without the echo of `sent`, or `None` if the echo may still be incomplete.
    pub(crate) fn strip_echo<'l>(self, line: &'l [u8], sent: &[u8]) -> Option<&'l [u8]> {
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

    /// Stores whether there was an echo, unless this is already known.
    pub(crate) fn record_echo(&mut self, echo_heard: bool) {
        if *self == Echo::Unknown {
            *self = if echo_heard { Echo::On } else { Echo::Off };
        }
    }
}
