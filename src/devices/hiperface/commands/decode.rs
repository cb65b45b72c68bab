//! The `decode` command, which explains captured bytes without a connection.

use serde_json::Map;

use crate::bits::{hex, hex_compact};
use crate::cli::Result;
use crate::cli::decode::{FrameExplanation, parse_frames, show};
use crate::cli::output::Output;
use crate::devices::hiperface::protocol::{Frame, Request, describe_frame};
use crate::devices::hiperface::state::explain;

pub(super) fn decode(output: &Output, words: &[String]) -> Result {
    let mut explained = Vec::new();
    let mut request: Option<Request> = None;
    for bytes in &parse_frames(words)? {
        let words = describe_frame(bytes, request.as_ref());
        let meaning =
            words.map(|facts| facts.iter().map(|facts| explain::detail_text(facts).terminal_text()).collect());
        explained.push(FrameExplanation {
            shown: hex(bytes),
            compact: hex_compact(bytes),
            meaning: meaning.map_err(|error| error.to_string()),
            more: Map::new(),
        });
        request = Frame::parse(bytes).ok().and_then(|frame| Request::parse(&frame).ok());
    }
    show(output, &explained)
}
