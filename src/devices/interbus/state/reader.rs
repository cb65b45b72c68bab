//! Decodes words that the user has typed, for example from a PLC monitor. No device is needed.

use super::word_meaning::{self, WordContext};
use crate::app::Text;
use crate::devices::interbus::protocol::{EncoderMode, ReadOutNumber, SingleWord, WindowShift};
use crate::devices::interbus::state::TEXTS;

/// Source of a word: its direction and the class of the encoder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WordSource {
    /// IN word of a K3 encoder.
    #[default]
    In,
    /// OUT word to a K3 encoder.
    Out,
    /// 16-bit IN word of a K1 encoder.
    K1,
    /// IN word of a K2 encoder.
    K2,
}

impl WordSource {
    pub const ALL: [WordSource; 4] = [WordSource::In, WordSource::Out, WordSource::K1, WordSource::K2];

    pub const fn keyword(self) -> &'static str {
        match self {
            WordSource::In => "ib_reader.in",
            WordSource::Out => "ib_reader.out",
            WordSource::K1 => "ib_reader.k1",
            WordSource::K2 => "ib_reader.k2",
        }
    }

    pub const fn has_mode(self) -> bool {
        matches!(self, WordSource::In | WordSource::Out)
    }

    const fn digit_count(self) -> usize {
        match self {
            WordSource::K1 => 4,
            WordSource::In | WordSource::Out | WordSource::K2 => 8,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    pub source: WordSource,
    pub mode: EncoderMode,
    /// The read-out to which the IN word replies, if any.
    pub read_out: Option<ReadOutNumber>,
    pub shift: WindowShift,
}

impl Default for Reading {
    fn default() -> Self {
        Reading { source: WordSource::In, mode: EncoderMode::Position, read_out: None, shift: WindowShift::default() }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DecodedWord {
    /// Word as entered.
    pub word: String,
    /// Meaning of the word, or a message if the entry is not a word.
    pub meaning: Result<Text, Text>,
    pub warning: Option<Text>,
}

impl Reading {
    /// Decodes words separated by blanks or commas. They may have the prefix `0x` or the suffix `h`.
    pub fn decode_words(&self, text: &str) -> Vec<DecodedWord> {
        let words = text.split([' ', ',', ';', '\n', '\r', '\t']).filter(|word| !word.is_empty());
        words.map(|word| self.decode_word(word)).collect()
    }

    fn decode_word(&self, typed: &str) -> DecodedWord {
        let bare = typed.trim_start_matches("0x").trim_start_matches("0X").trim_end_matches(['h', 'H']);
        let digits = self.source.digit_count();
        let number = Some(bare).filter(|own| own.len() == digits).and_then(|own| u32::from_str_radix(own, 16).ok());
        let Some(number) = number else {
            let why = TEXTS.text("ib_reader.no_word").with("word", typed).with("digits", digits);
            return DecodedWord { word: typed.to_owned(), meaning: Err(why), warning: None };
        };
        let single = |own: SingleWord| {
            let position = TEXTS.text("ib_word.position").with("position", own.position().get());
            let bits = || TEXTS.text("ib_word.stray").with("bits", format!("0x{:X}", own.unexpected_bits()));
            (position, (own.unexpected_bits() != 0).then(bits))
        };
        let known = WordContext { mode: self.mode, read_out: self.read_out, shift: Some(self.shift) };
        let (meaning, warning) = match self.source {
            WordSource::Out => (word_meaning::describe_out_word(number, self.mode), None),
            WordSource::In => (word_meaning::word_text(number, &known), word_meaning::unexpected_bits(number)),
            // A K1 word has four digits.
            WordSource::K1 => single(SingleWord::parse_k1(number as u16)),
            WordSource::K2 => single(SingleWord::parse_k2(number)),
        };
        DecodedWord { word: bare.to_ascii_uppercase(), meaning: Ok(meaning), warning }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;

    #[test]
    fn decodes_typed_words() {
        let says = |reading: Reading, text: &str| -> Vec<String> {
            let lines = reading.decode_words(text).into_iter();
            lines.map(|line| line.meaning.unwrap_or_else(|why| why).to_string_in(Language::English)).collect()
        };
        let of = |way| Reading { source: way, ..Reading::default() };
        // The word is from reference 7.
        assert_eq!(says(of(WordSource::K1), "0FFF"), ["position 4095"]);
        assert_eq!(says(of(WordSource::In), "0x00123456, C0000000"), ["position 1193046", "busy"]);
        assert_eq!(says(of(WordSource::Out), "080003e8h"), ["Preset value := 1000"]);
        assert_eq!(says(of(WordSource::K2), "00FFFFFF"), ["position 16777215"]);
        // Bits 15 to 12 of a K1 word should be 0 (reference 1).
        assert!(of(WordSource::K1).decode_words("1FFF").iter().all(|line| line.warning.is_some()));
        for (way, text) in [(WordSource::In, "123"), (WordSource::K1, "00000FFF"), (WordSource::Out, "0200000G")] {
            assert!(of(way).decode_words(text).iter().all(|line| line.meaning.is_err()), "{text}");
        }
        assert!(of(WordSource::In).decode_words(" \n").is_empty());
    }
}
