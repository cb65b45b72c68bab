//! `replay:FILE`: playback of a recorded trace in place of a device.

use std::sync::Arc;

use super::{ByteLink, Clock, Direction, LinkError, LinkErrorKind, TraceEntry};
use crate::bits::{MaskedBytes, hex};
use crate::units::{CharacterFormat, Moment};

struct RecordedExchange {
    request: MaskedBytes,
    /// Recorded reply, or `None` if none arrived or it was masked.
    reply: Option<Vec<u8>>,
}

/// Playback of a recording in place of a device. The search for a request starts after the previous request and wraps
/// around once. Masked bytes match any byte.
pub struct ReplayLink {
    target: String,
    exchanges: Vec<RecordedExchange>,
    next: usize,
    waiting: Vec<u8>,
    clock: Arc<dyn Clock>,
}

impl ReplayLink {
    /// Creates a playback of recorded frames. Errors refer to it as `target`.
    pub fn new(target: &str, entries: Vec<TraceEntry>, clock: Arc<dyn Clock>) -> Self {
        let mut exchanges: Vec<RecordedExchange> = Vec::new();
        for entry in entries {
            match (entry.direction, exchanges.last_mut()) {
                (Direction::Sent, _) => exchanges.push(RecordedExchange { request: entry.bytes, reply: None }),
                (Direction::Received, Some(exchange)) => {
                    if let Some(bytes) = entry.bytes.to_bytes() {
                        exchange.reply.get_or_insert_default().extend(bytes);
                    }
                }
                (Direction::Received, None) => {}
            }
        }
        ReplayLink { target: target.to_owned(), exchanges, next: 0, waiting: Vec::new(), clock }
    }
}

impl ByteLink for ReplayLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let count = self.exchanges.len();
        let found = (0..count)
            .map(|step| (self.next + step) % count)
            .find(|at| self.exchanges.get(*at).is_some_and(|exchange| exchange.request.matches_visible(bytes)));
        let Some(at) = found else {
            return Err(LinkError::new(&self.target, LinkErrorKind::NotRecorded(hex(bytes))));
        };
        self.next = at + 1;
        self.waiting = self.exchanges.get(at).and_then(|exchange| exchange.reply.clone()).unwrap_or_default();
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        if self.waiting.is_empty() {
            self.clock.sleep_until(until);
        } else {
            into.append(&mut self.waiting);
        }
        Ok(())
    }

    fn set_format(&mut self, _format: CharacterFormat) -> Result<(), LinkError> {
        Ok(())
    }

    fn can_set_format(&self) -> bool {
        false
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{VirtualClock, read_trace};
    use super::*;

    #[test]
    fn replays_in_order_and_wraps() {
        let text =
            "# encoder-studio trace 1\n0 > 40 42 02\n0.1 < AA\n0.2 > 40 42 02\n0.3 < BB\n0.4 > 40 49 ** **\n0.5 < CC";
        let clock = Arc::new(VirtualClock::default());
        let mut link = ReplayLink::new("x.trace", read_trace(text).unwrap(), clock.clone());
        let mut ask = |bytes: &[u8]| {
            let mut reply = Vec::new();
            link.send(bytes)?;
            link.receive(clock.now(), &mut reply)?;
            Ok::<_, LinkError>(reply)
        };
        assert_eq!(ask(&[0x40, 0x42, 0x02]).unwrap(), [0xAA]);
        assert_eq!(ask(&[0x40, 0x42, 0x02]).unwrap(), [0xBB]);
        assert_eq!(ask(&[0x40, 0x42, 0x02]).unwrap(), [0xAA]);
        assert_eq!(ask(&[0x40, 0x49, 0x55, 0x5C]).unwrap(), [0xCC]);
        assert_eq!(ask(&[0x40, 0x46, 0x06]).unwrap_err().kind, LinkErrorKind::NotRecorded("40 46 06".into()));
    }
}
