//! The `decode hiperdrive` command: control and status words, process data, parameter words, and packets that contain
//! any of these.

use serde_json::{Map, json};

use super::args::WordOptions;
use super::image;
use super::meaning::{self, DecodeContext, WordMeaning, parameter_words};
use crate::bits::{hex, hex_compact};
use crate::buses::ethernet_ip::commands::{self as ethernet_ip, DecodedBytes, Device};
use crate::cli::args::DecodeArgs;
use crate::cli::decode::{FrameExplanation, parse_frames, show};
use crate::cli::output::Output;
use crate::cli::{Failure, Result};
use crate::devices::hiperdrive::protocol::{KIND, Layout};

pub(super) fn decode(output: &Output, arguments: &DecodeArgs) -> Result {
    let options: WordOptions = arguments.own.read()?;
    let known =
        DecodeContext { direction: options.way.direction, order: options.order.map(Into::into).unwrap_or_default() };
    let explained: Vec<FrameExplanation> =
        parse_captured(&arguments.hex)?.iter().map(|captured| explain_captured(captured, &known)).collect();
    show(output, &explained)
}

enum CapturedData {
    /// A word, given as four hexadecimal digits.
    Word(u16),
    Bytes(Vec<u8>),
}

/// Parses the arguments. Four hexadecimal digits are a word; anything else is a sequence of bytes.
fn parse_captured(arguments: &[String]) -> Result<Vec<CapturedData>> {
    let word = |text: &String| {
        let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")).unwrap_or(text);
        let is_word = digits.len() == 4 && digits.chars().all(|c| c.is_ascii_hexdigit());
        is_word.then(|| u16::from_str_radix(digits, 16).ok()).flatten().map(CapturedData::Word)
    };
    let words: Vec<Option<CapturedData>> = arguments.iter().map(word).collect();
    match words.iter().filter(|word| word.is_some()).count() {
        0 => Ok(parse_frames(arguments)?.into_iter().map(CapturedData::Bytes).collect()),
        all if all == arguments.len() => Ok(words.into_iter().flatten().collect()),
        _ => Err(Failure::Usage(
            "words (4 hexadecimal digits, such as 0439) and bytes cannot be mixed: decode them separately".to_owned(),
        )),
    }
}

fn explain_captured(captured: &CapturedData, known: &DecodeContext) -> FrameExplanation {
    let (shown, compact, meaning_lines) = match captured {
        CapturedData::Word(word) => {
            let text = format!("{word:04X}");
            (text.clone(), text, meaning::from_word(*word, known).map(|readings| meaning_lines(&readings)))
        }
        CapturedData::Bytes(bytes) => (hex(bytes), hex_compact(bytes), decode_bytes(bytes, known)),
    };
    let (meaning, mut more) = match meaning_lines {
        Ok(DecodedBytes { lines, more, .. }) => (Ok(lines), more),
        Err(why) => (Err(why), Map::new()),
    };
    more.insert("device".to_owned(), json!(KIND));
    FrameExplanation { shown, compact, meaning, more }
}

fn meaning_lines(readings: &[WordMeaning]) -> DecodedBytes {
    let list = readings.iter().map(WordMeaning::json).collect();
    let more = Map::from_iter([("readings".to_owned(), list)]);
    DecodedBytes { lines: readings.iter().flat_map(WordMeaning::to_lines).collect(), more, data: None }
}

/// Decodes bytes as a packet, or as process data if their length matches a layout. If the direction is known, bytes of
/// such a length are always decoded as process data.
fn decode_bytes(bytes: &[u8], known: &DecodeContext) -> std::result::Result<DecodedBytes, String> {
    let fits = Layout::all_with_length(bytes.len()).next().is_some();
    let packet = ethernet_ip::explain_packet(bytes, Device::Known(parameter_words))
        .filter(|_| !fits || known.direction.is_none());
    if let Some(explained) = packet {
        let mut explained = explained?;
        if let Some((data, to_target)) = explained.data.take() {
            let readings = image::explain_cyclic(&data, to_target, known);
            explained.lines.extend(readings.iter().flat_map(WordMeaning::to_lines));
            explained.more.insert("readings".to_owned(), readings.iter().map(WordMeaning::json).collect());
        }
        return Ok(explained);
    }
    if !fits {
        return Err(format!(
            "no process data (8, 16, 32, 40, 64 or 72 bytes, not {}) and no EtherNet/IP packet; a single word is written as \
             0439",
            bytes.len()
        ));
    }
    image::decode_bytes(bytes, known).map(|readings| meaning_lines(&readings))
}
