//! Explains SSI frames in the trace.

use crate::app::{FrameExplanation, Text};
use crate::buses::bridge::protocol::Request;
use crate::buses::bridge::state::traced;
use crate::link::{Direction, TraceEntry};

pub(super) fn explain(entry: &TraceEntry) -> FrameExplanation {
    let Some(bytes) = entry.bytes.to_bytes() else { return FrameExplanation::from_error(Text::new("trace.hidden")) };
    if entry.direction == Direction::Received
        && let Some(fault) = traced::explain_received(&bytes)
    {
        return fault;
    }
    let packet = traced::parse_packet(&bytes);
    let meaning = packet.and_then(|packet| match Request::parse(&packet) {
        Ok(request) => Some(traced::request_text(&request)),
        Err(_) => traced::message_text(&packet),
    });
    meaning.into_iter().collect::<Vec<_>>().into()
}
