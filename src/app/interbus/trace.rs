//! What the frames of the trace say: the words in them. A word means what the encoder's mode makes of it, which the OUT
//! words before it have chosen.

use super::said::{self, Known};
use crate::app::Text;
use crate::device::interbus::{Carried, carried};
use crate::link::{Direction, TraceEntry};
use crate::protocol::interbus::{Command, Mode, ReadOut, WindowShift, WordOrder};

/// Reads frames in the order in which they went over the wire.
#[derive(Debug)]
pub(super) struct Meaning {
    /// Which half of a word comes first.
    pub(super) order: WordOrder,
    /// The shift of the window, where it was read.
    pub(super) shift: Option<WindowShift>,
    mode: Mode,
    read_out: Option<ReadOut>,
}

impl Meaning {
    /// What a link leads to begins with a position.
    pub(super) fn new(order: WordOrder) -> Self {
        Meaning { order, shift: None, mode: Mode::Position, read_out: None }
    }

    /// The encoder is known to be in this mode.
    pub(super) fn found(&mut self, mode: Mode) {
        self.mode = mode;
    }

    /// What a frame says, and nothing for bytes that carry no word.
    pub(super) fn of(&mut self, entry: &TraceEntry) -> Vec<Text> {
        let Some(bytes) = entry.bytes.to_bytes() else { return Vec::new() };
        match carried(entry.direction == Direction::Sent, &bytes, self.order) {
            Some(Carried::Out(word)) => {
                let command = self.command(word);
                self.follow(command);
                vec![word_of("ib_trace.out", word), said::asked(command)]
            }
            Some(Carried::In(word)) => {
                let known = Known { mode: self.mode, read_out: self.read_out, shift: self.shift };
                vec![word_of("ib_trace.in", word), said::told(word, &known)]
            }
            None => Vec::new(),
        }
    }

    /// What is sent is legal in the mode that the encoder is in: where that is another one than is known here, the word
    /// tells so.
    fn command(&self, word: u32) -> Command {
        let readings = || Command::readings(word).into_iter().next();
        Command::in_mode(word, self.mode).ok().or_else(readings).unwrap_or(Command::Unknown(word))
    }

    fn follow(&mut self, command: Command) {
        match command {
            Command::Cams(Some(_)) => self.mode = Mode::Cam,
            Command::Cams(None) | Command::Velocity(false) => self.mode = Mode::Position,
            Command::Velocity(true) => self.mode = Mode::Velocity,
            _ if said::mode_of(command) == Mode::Cam => self.mode = Mode::Cam,
            _ => {}
        }
        self.read_out = if let Command::ReadOut(read_out) = command { Some(read_out) } else { None };
    }
}

fn word_of(id: &'static str, word: u32) -> Text {
    Text::new(id).with("word", format!("0x{word:08X}"))
}
