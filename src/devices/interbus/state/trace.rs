//! Explains frames in the trace. Their meaning depends on the mode of the encoder, which earlier OUT words have
//! selected.

use super::word_meaning::{self, WordContext};
use crate::app::{FrameExplanation, Text, TraceFault};
use crate::devices::interbus::procedures::{FrameWord, GatewayFault, find_fault, word_in_frame};
use crate::devices::interbus::protocol::{Command, EncoderMode, ReadOutNumber, Reply, WindowShift, WordOrder};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain as explained;
use crate::link::{Direction, TraceEntry};

/// Decodes frames in the order in which they were transmitted.
#[derive(Debug)]
pub(super) struct FrameDecoder {
    /// Order of the two halves of a word.
    pub(super) order: WordOrder,
    pub(super) shift: Option<WindowShift>,
    mode: EncoderMode,
    read_out: Option<ReadOutNumber>,
    requested: Vec<u8>,
}

impl FrameDecoder {
    /// Creates a decoder for a new link. Initially, position mode is assumed.
    pub(super) fn new(order: WordOrder) -> Self {
        FrameDecoder { order, shift: None, mode: EncoderMode::Position, read_out: None, requested: Vec::new() }
    }

    pub(super) fn set_mode(&mut self, mode: EncoderMode) {
        self.mode = mode;
    }

    /// Explains a frame. There is no explanation for an intact frame without a process data word.
    pub(super) fn explain(&mut self, entry: &TraceEntry) -> FrameExplanation {
        let Some(bytes) = entry.bytes.to_bytes() else {
            return FrameExplanation::from_error(Text::new("trace.hidden"));
        };
        if entry.direction == Direction::Sent {
            self.requested.clone_from(&bytes);
            return self.explain_words(entry.direction, &bytes).into();
        }
        match find_fault(&self.requested, &bytes, self.order) {
            Some(GatewayFault::Broken(damage)) => FrameExplanation::from_error(explained::damage_text(damage)),
            Some(GatewayFault::Refused(exception)) => FrameExplanation {
                fault: Some(TraceFault::Reported),
                ..vec![explained::exception_text(exception)].into()
            },
            None => self.explain_received(&bytes),
        }
    }

    /// Explains a reply. An error word is marked as an error reported by the encoder.
    fn explain_received(&mut self, bytes: &[u8]) -> FrameExplanation {
        let meaning = self.explain_words(Direction::Received, bytes);
        let is_error = match word_in_frame(false, bytes, self.order) {
            Some(FrameWord::In(word)) => matches!(Reply::parse(word), Reply::Error(_)),
            _ => false,
        };
        FrameExplanation { fault: is_error.then_some(TraceFault::Reported), ..meaning.into() }
    }

    fn explain_words(&mut self, direction: Direction, bytes: &[u8]) -> Vec<Text> {
        match word_in_frame(direction == Direction::Sent, bytes, self.order) {
            Some(FrameWord::Out(word)) => {
                let command = self.command(word);
                self.track_command(command);
                vec![hex_word_text("ib_trace.out", word), word_meaning::command_text(command)]
            }
            Some(FrameWord::In(word)) => {
                let known = WordContext { mode: self.mode, read_out: self.read_out, shift: self.shift };
                vec![hex_word_text("ib_trace.in", word), word_meaning::word_text(word, &known)]
            }
            None => Vec::new(),
        }
    }

    /// Parses an OUT word in the known mode, or if that does not allow the word, in a mode that does.
    fn command(&self, word: u32) -> Command {
        let readings = || Command::all_meanings(word).into_iter().next();
        Command::in_mode(word, self.mode).ok().or_else(readings).unwrap_or(Command::Unknown(word))
    }

    fn track_command(&mut self, command: Command) {
        match command {
            Command::Cams(Some(_)) => self.mode = EncoderMode::Cam,
            Command::Cams(None) | Command::Velocity(false) => self.mode = EncoderMode::Position,
            Command::Velocity(true) => self.mode = EncoderMode::Velocity,
            _ if word_meaning::command_mode(command) == EncoderMode::Cam => self.mode = EncoderMode::Cam,
            _ => {}
        }
        self.read_out = if let Command::ReadOut(read_out) = command { Some(read_out) } else { None };
    }
}

fn hex_word_text(id: &'static str, word: u32) -> Text {
    TEXTS.text(id).with("word", format!("0x{word:08X}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::bits::{MaskedBytes, parse_hex};
    use crate::units::Moment;

    /// Damaged replies, rejections and replies with an error word must all be explained and marked (Modbus application
    /// protocol 1.1b3, 6.4 and 7; reference 2; issue 22.11).
    #[test]
    fn explains_and_marks_damaged_replies() {
        let request = "00 07 00 00 00 06 01 04 00 00 00 02";
        let cases = [
            ("good", "00 07 00 00 00 07 01 04 04 00 00 03 E8", None),
            ("late, to another request", "00 06 00 00 00 07 01 04 04 00 00 03 E8", None),
            ("an error word", "00 07 00 00 00 07 01 04 04 86 00 00 00", Some(TraceFault::Reported)),
            ("refused", "00 07 00 00 00 03 01 84 06", Some(TraceFault::Reported)),
            ("another unit", "00 07 00 00 00 07 02 04 04 00 00 03 E8", Some(TraceFault::Broken)),
            ("another function", "00 07 00 00 00 07 01 03 04 00 00 03 E8", Some(TraceFault::Broken)),
            ("one register", "00 07 00 00 00 05 01 04 02 03 E8", Some(TraceFault::Broken)),
            ("cut short", "00 07 00 00 00 07 01 04 04 00", Some(TraceFault::Broken)),
            ("no frame", "55 AA 55", Some(TraceFault::Broken)),
        ];
        for (label, reply, fault) in cases {
            let mut meaning = FrameDecoder::new(WordOrder::HighFirst);
            let mut said = |direction, text| {
                let bytes = MaskedBytes::unmasked(&parse_hex(text).unwrap());
                meaning.explain(&TraceEntry { at: Moment::START, direction, bytes })
            };
            assert_eq!(said(Direction::Sent, request).fault, None);
            let told = said(Direction::Received, reply);
            let words: Vec<String> = told.meaning.iter().map(|text| text.to_string_in(Language::English)).collect();
            assert_eq!(told.fault, fault, "{label}: {words:?}");
            assert!(!words.concat().is_empty(), "{label}");
        }
    }
}
