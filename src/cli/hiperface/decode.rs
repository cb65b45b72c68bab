//! `decode`: captured bytes in words, offline.

use serde_json::json;

use crate::app::explain;
use crate::bits::{hex, hex_compact, parse_hex};
use crate::cli::output::Output;
use crate::cli::{Done, Failure, Result};
use crate::protocol::hiperface::{Frame, Request, describe};

pub(in crate::cli) fn decode(output: &Output, words: &[String]) -> Result {
    let frames = frames(words)?;
    let mut list = Vec::new();
    let mut text = String::new();
    let mut broken = Vec::new();
    let mut request: Option<Request> = None;
    for bytes in &frames {
        match describe(bytes, request.as_ref()) {
            Ok(said) => {
                let lines: Vec<String> = said.iter().map(|said| explain::hiperface::frame(said).terminal()).collect();
                text.push_str(&format!("{}\n", hex(bytes)));
                text.extend(lines.iter().map(|line| format!("  {line}\n")));
                list.push(json!({"bytes": hex_compact(bytes), "valid": true, "meaning": lines}));
            }
            Err(error) => {
                broken.push(format!("{}: {error}.", hex(bytes)));
                list.push(json!({"bytes": hex_compact(bytes), "valid": false, "meaning": [error.to_string()]}));
            }
        }
        request = Frame::parse(bytes).ok().and_then(|frame| Request::parse(&frame).ok());
    }
    output.show(&json!({ "frames": list }), &text)?;
    if broken.is_empty() { Ok(Done::Well) } else { Err(Failure::Failed(broken)) }
}

/// Arguments of three bytes or more are frames of their own; single bytes together are one frame.
fn frames(words: &[String]) -> Result<Vec<Vec<u8>>> {
    let parts: Vec<Vec<u8>> = words
        .iter()
        .map(|word| parse_hex(word).map_err(|why| Failure::Usage(format!("{word:?} is not hex bytes: {why}"))))
        .collect::<Result<_>>()?;
    if parts.iter().all(Vec::is_empty) {
        return Err(Failure::Usage("there are no bytes to explain".to_owned()));
    }
    if parts.len() > 1 && parts.iter().all(|part| part.len() >= 3) { Ok(parts) } else { Ok(vec![parts.concat()]) }
}
