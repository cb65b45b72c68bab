//! Common part of the `decode` command for all device kinds: parses captured bytes and prints their meaning.

use serde_json::{Map, Value as Json, json};

use super::output::Output;
use super::{Failure, Result, Success};
use crate::bits::parse_hex;

pub(crate) struct FrameExplanation {
    /// Captured frame in readable form.
    pub(crate) shown: String,
    pub(crate) compact: String,
    /// Meaning of the frame, one string per line, or the reason why the bytes are not a frame.
    pub(crate) meaning: std::result::Result<Vec<String>, String>,
    pub(crate) more: Map<String, Json>,
}

/// Prints the meaning of frames. If some frames are invalid, the valid ones are still printed before the command fails.
pub(crate) fn show(output: &Output, frames: &[FrameExplanation]) -> Result {
    let mut list = Vec::new();
    let mut text = String::new();
    let mut broken = Vec::new();
    for FrameExplanation { shown, compact, meaning, more } in frames {
        let (valid, lines) = match meaning {
            Ok(lines) => {
                text.push_str(&format!("{shown}\n"));
                text.extend(lines.iter().map(|line| format!("  {line}\n")));
                (true, lines.clone())
            }
            Err(why) => {
                broken.push(format!("{shown}: {why}."));
                (false, vec![why.clone()])
            }
        };
        let mut json = more.clone();
        json.extend([
            ("bytes".to_owned(), json!(compact)),
            ("valid".to_owned(), json!(valid)),
            ("meaning".to_owned(), json!(lines)),
        ]);
        list.push(Json::Object(json));
    }
    output.show(&json!({ "frames": list }), &text)?;
    if broken.is_empty() {
        return Ok(Success::Completed);
    }
    let more = broken.len().saturating_sub(3);
    if more > 1 {
        broken.truncate(3);
        broken.push(format!("{more} more are not valid either."));
    }
    Err(Failure::Failed(broken))
}

/// Parses hexadecimal bytes. If every argument has at least three bytes, each is a frame. Otherwise, all of them form
/// one frame.
pub(crate) fn parse_frames(words: &[String]) -> Result<Vec<Vec<u8>>> {
    let parts: Vec<Vec<u8>> = words.iter().map(|word| bytes(word)).collect::<Result<_>>()?;
    if parts.iter().all(Vec::is_empty) {
        return Err(Failure::Usage("no bytes to decode were given".to_owned()));
    }
    if parts.len() > 1 && parts.iter().all(|part| part.len() >= 3) { Ok(parts) } else { Ok(vec![parts.concat()]) }
}

pub(crate) fn bytes(word: &str) -> Result<Vec<u8>> {
    parse_hex(word).map_err(|why| Failure::Usage(format!("{word:?} is not a sequence of hexadecimal bytes: {why}")))
}
