//! The command `decode interbus`, which explains process data words. Options narrow an ambiguous word to one meaning.

use serde_json::{Map, Value as Json, json};

use super::args::WordOptions;
use super::meaning::{self, WordContext, WordMeaning};
use crate::cli::args::{DecodeArgs, Direction};
use crate::cli::decode::{FrameExplanation, show};
use crate::cli::number::parse_number;
use crate::cli::output::Output;
use crate::cli::{Failure, Result};
use crate::devices::interbus::protocol::{KIND, READ_OUTS, ReadOutNumber, SingleWord, WindowShift};

pub(super) fn decode(output: &Output, arguments: &DecodeArgs) -> Result {
    let options: WordOptions = arguments.own.read()?;
    let direction = options.way.direction;
    let known = WordContext {
        mode: options.mode.map(Into::into),
        read_out: options.read_out.as_deref().map(read_out).transpose()?,
        shift: options.shift.and_then(WindowShift::new),
    };
    let words: Vec<CapturedWord> = arguments.hex.iter().map(|word| parse_captured(word)).collect::<Result<_>>()?;
    if let (Some(CapturedWord::K1(word)), Some(Direction::Out)) =
        (words.iter().find(|word| matches!(word, CapturedWord::K1(_))), direction)
    {
        return Err(Failure::Usage(format!(
            "{word:04X} has 4 digits: only K3 encoders take words, K1 encoders do not"
        )));
    }
    let explained: Vec<FrameExplanation> = words.iter().map(|word| explain_word(*word, direction, &known)).collect();
    show(output, &explained)
}

#[derive(Clone, Copy)]
enum CapturedWord {
    /// A 16-bit word, entered as 4 digits.
    K1(u16),
    /// A 32-bit word, entered as 8 digits.
    Long(u32),
}

fn parse_captured(text: &str) -> Result<CapturedWord> {
    let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")).unwrap_or(text);
    // The number parser would also accept a sign.
    let number = digits.chars().all(|c| c.is_ascii_hexdigit()).then_some(digits);
    let word = match (number, digits.len()) {
        (Some(digits), 4) => u16::from_str_radix(digits, 16).ok().map(CapturedWord::K1),
        (Some(digits), 8) => u32::from_str_radix(digits, 16).ok().map(CapturedWord::Long),
        _ => None,
    };
    word.ok_or_else(|| {
        Failure::Usage(format!(
            "{text:?} is not a word of an INTERBUS encoder: enter 8 hexadecimal digits, such as 020000FF, or 4 for K1"
        ))
    })
}

/// Parses a read-out given as a hyphenated name or a number.
fn read_out(text: &str) -> Result<ReadOutNumber> {
    let named = READ_OUTS.iter().find(|row| row.name.replace(' ', "-") == text).map(|row| row.read_out);
    let numbered = || parse_number(text).and_then(|number| u16::try_from(number).ok()).map(ReadOutNumber::new);
    named.or_else(numbered).ok_or_else(|| {
        let names: Vec<String> = READ_OUTS.iter().map(|row| row.name.replace(' ', "-")).collect();
        Failure::Usage(format!(
            "{text:?} is not a read-out; read-outs are {}, or a number up to 0xFFFF",
            names.join(", ")
        ))
    })
}

fn explain_word(word: CapturedWord, direction: Option<Direction>, known: &WordContext) -> FrameExplanation {
    let (shown, meanings) = match word {
        CapturedWord::K1(word) => {
            (format!("{word:04X}"), Ok(vec![meaning::k1_word_meaning(SingleWord::parse_k1(word))]))
        }
        CapturedWord::Long(word) => (format!("{word:08X}"), word_meanings(word, direction, known)),
    };
    let mut more = Map::from_iter([("device".to_owned(), json!(KIND))]);
    if let Ok(meanings) = &meanings {
        more.insert("readings".to_owned(), meanings.iter().map(WordMeaning::json).collect::<Json>());
    }
    let meaning = meanings.map(|meanings| meanings.iter().map(WordMeaning::to_line).collect());
    FrameExplanation { compact: shown.clone(), shown, meaning, more }
}

fn word_meanings(
    word: u32,
    direction: Option<Direction>,
    known: &WordContext,
) -> std::result::Result<Vec<WordMeaning>, String> {
    match direction {
        Some(Direction::In) => Ok(meaning::in_word_meanings(word, known)),
        Some(Direction::Out) => meaning::out_word_meanings(word, known),
        // The encoder may send any word. If it has no meaning as an OUT word, it can only be an IN word.
        None => Ok(meaning::out_word_meanings(word, known)
            .unwrap_or_else(|_| meaning::meanings_in_other_modes(word, known))
            .into_iter()
            .chain(meaning::in_word_meanings(word, known))
            .collect()),
    }
}
