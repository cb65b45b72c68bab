//! What the frames of the trace say: a reply is read with the request before it.

use crate::app::{Text, explain};
use crate::link::{Direction, TraceEntry};
use crate::protocol::hiperface::{Frame, Request, Said, describe};

/// Reads frames in the order in which they went over the line.
#[derive(Debug, Default)]
pub(super) struct Meaning {
    request: Option<Request>,
}

impl Meaning {
    /// What a frame says, and nothing for bytes that are no frame. It says nothing of access codes.
    pub(super) fn of(&mut self, entry: &TraceEntry) -> Vec<Text> {
        let bytes = match (entry.bytes.to_bytes(), entry.direction) {
            (Some(bytes), _) => bytes,
            (None, Direction::Sent) => with_checksum(entry.bytes.filled(0)),
            (None, Direction::Received) => {
                self.request = None;
                return Vec::new();
            }
        };
        let request = match entry.direction {
            Direction::Sent => {
                self.request = Frame::parse(&bytes).ok().and_then(|frame| Request::parse(&frame).ok());
                None
            }
            Direction::Received => self.request.take(),
        };
        let Ok(said) = describe(&bytes, request.as_ref()) else { return Vec::new() };
        // The heading repeats the request's; of a reply only what it gives is new.
        let known = |said: &Said| request.is_some() && matches!(said, Said::Heading { .. });
        said.iter().filter(|said| !known(said)).map(explain::hiperface::frame).collect()
    }
}

/// A request whose secrets were masked, its checksum among them, as one with other secrets.
fn with_checksum(mut frame: Vec<u8>) -> Vec<u8> {
    if frame.pop().is_some() {
        frame.push(frame.iter().fold(0, |sum, byte| sum ^ byte));
    }
    frame
}
