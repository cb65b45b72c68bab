//! What the frames of the trace say.

use crate::app::Text;
use crate::app::explain::traced;
use crate::link::TraceEntry;
use crate::protocol::bridge::Request;

/// What a frame says, and nothing for bytes that are no frame.
pub(super) fn meaning(entry: &TraceEntry) -> Vec<Text> {
    let packet = entry.bytes.to_bytes().and_then(|bytes| traced::packet(&bytes));
    let said = packet.and_then(|packet| match Request::parse(&packet) {
        Ok(request) => Some(traced::asked(&request)),
        Err(_) => traced::said(&packet),
    });
    said.into_iter().collect()
}
