//! The `decode` command, which explains captured UBICOM frames, bridge packets, position frames and position words
//! offline. The format is recognised by its checksum. A position word has no checksum, so it must be written as the
//! `position` command prints it, such as `0x024698000` (nine digits) or `raw=610893824`.

mod bridge;
mod position;
mod ubicom;

use serde_json::{Map, json};

use super::KIND;
use crate::buses::ubicom::protocol::{Request, SYNC};
use crate::cli::decode::{self, FrameExplanation, show};
use crate::cli::number::parse_number;
use crate::cli::output::Output;
use crate::cli::{Failure, Result};

enum CapturedData {
    /// Original input and bits of a position frame.
    Bits(String, u64),
    /// Original input and value of a position word.
    Word(String, u64),
    Bytes(Vec<u8>),
}

pub(super) fn decode(output: &Output, words: &[String]) -> Result {
    let mut explained = Vec::new();
    let mut requested = None;
    for captured in parse_captured(words)? {
        match captured {
            CapturedData::Bits(written, raw) => explained.push(position::explain_frame(raw, written)),
            CapturedData::Word(written, raw) => explained.push(position::explain_position_word(raw, written)),
            CapturedData::Bytes(bytes) => explained.extend(explain_bytes(&bytes, &mut requested)),
        }
    }
    show(output, &explained)
}

/// Parses the arguments. Nine hexadecimal digits after `0x`, digits followed by `h`, and numbers after `raw=` are
/// position words. Eleven digits, and any other number of digits after `0x`, are the bits of a frame. Everything else
/// is parsed as bytes.
fn parse_captured(words: &[String]) -> Result<Vec<CapturedData>> {
    let is_bits = |word: &String| match strip_hex_prefix(word) {
        (true, digits) => (3..=2 * position::BYTES).contains(&digits.len()),
        (false, digits) => digits.len() == 11 && digits.chars().all(|c| c.is_ascii_hexdigit()),
    };
    let is_word = |word: &String| match strip_hex_prefix(word) {
        (true, digits) => digits.len() == position::WORD_DIGITS,
        (false, word) => word.starts_with(RAW) || (word.len() > 3 && word.ends_with(['h', 'H'])),
    };
    if !words.iter().any(|word| is_bits(word) || is_word(word)) {
        words.iter().try_for_each(|word| require_even_digit_count(word))?;
        return Ok(decode::parse_frames(words)?.into_iter().map(CapturedData::Bytes).collect());
    }
    let one = |word: &String| match strip_hex_prefix(word) {
        _ if is_word(word) => position_word(word).map(|raw| CapturedData::Word(word.clone(), raw)),
        (_, digits) if is_bits(word) => u64::from_str_radix(digits, 16)
            .map(|raw| CapturedData::Bits(word.clone(), raw))
            .map_err(|_| Failure::Usage(format!("{word:?} is not a position frame in hexadecimal digits"))),
        _ => require_even_digit_count(word).and_then(|()| decode::bytes(word)).map(CapturedData::Bytes),
    };
    words.iter().map(one).collect()
}

const RAW: &str = "raw=";

fn position_word(word: &str) -> Result<u64> {
    let number = match word.strip_prefix(RAW) {
        Some(number) => parse_number(number).and_then(|number| u64::try_from(number).ok()),
        None => u64::from_str_radix(strip_hex_prefix(word).1.trim_end_matches(['h', 'H']), 16).ok(),
    };
    number
        .ok_or_else(|| Failure::Usage(format!("{word:?} is not a position word, such as 0x024698000 or raw=610893824")))
}

/// Rejects an argument with an odd number of digits, which cannot be bytes. It may be a position word without its
/// prefix.
fn require_even_digit_count(word: &str) -> Result<()> {
    let is_number = word.len() % 2 == 1 && word.len() > 1 && word.chars().all(|c| c.is_ascii_hexdigit());
    if !is_number {
        return Ok(());
    }
    let why = "has an odd number of digits, so it is not bytes; a position word is written 0x024698000 (nine digits) or \
               raw=610893824 (as JSON and tables have it), a position frame with 11 digits or 0x";
    Err(Failure::Usage(format!("{word:?} {why}")))
}

/// Strips a leading `0x`. Returns whether it was present, and the remaining digits.
fn strip_hex_prefix(word: &str) -> (bool, &str) {
    match word.strip_prefix("0x").or_else(|| word.strip_prefix("0X")) {
        Some(digits) => (true, digits),
        None => (false, word),
    }
}

/// Explains bytes according to the protocol whose checksum matches. If none matches, the protocol is guessed from the
/// framing.
fn explain_bytes(bytes: &[u8], requested: &mut Option<Request>) -> Vec<FrameExplanation> {
    let ubicom = ubicom::explain_frames(bytes, requested);
    let bridge = bridge::explain_packet(bytes);
    let position: Vec<FrameExplanation> = position::decode_bytes(bytes).into_iter().collect();
    let fits = |found: &Vec<FrameExplanation>| !found.is_empty() && found.iter().all(|one| one.meaning.is_ok());
    if fits(&ubicom) {
        ubicom
    } else if fits(&bridge) {
        bridge
    } else if fits(&position) {
        position
    } else if bytes.first() == Some(&SYNC) {
        ubicom
    } else if !position.is_empty() {
        position
    } else {
        bridge
    }
}

fn form_map(name: &str) -> Map<String, serde_json::Value> {
    Map::from_iter([("device".to_owned(), json!(KIND)), ("form".to_owned(), json!(name))])
}
