//! Explains process data words. The meaning of an IN word depends on the mode.

use super::format;
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::interbus::protocol::{
    CamOutput, Command, EncoderMode, ErrorWord, Parameter, ReadOutNumber, ReadOutValue, Reply, Value, WindowShift,
};
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain as explained;

/// What must be known about an encoder to interpret its IN words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordContext {
    pub mode: EncoderMode,
    pub read_out: Option<ReadOutNumber>,
    pub shift: Option<WindowShift>,
}

impl WordContext {
    /// Returns the context for interpreting the reply to a command.
    pub fn for_command(command: Command, shift: Option<WindowShift>) -> Self {
        let read_out = if let Command::ReadOut(what) = command { Some(what) } else { None };
        WordContext { mode: command_mode(command), read_out, shift }
    }
}

/// Describes an OUT word, even if it is illegal in the given mode.
pub fn describe_out_word(word: u32, mode: EncoderMode) -> Text {
    match Command::in_mode(word, mode) {
        Ok(command) => command_text(command),
        Err(refused) if matches!(refused.command, Command::Unknown(_)) => TEXTS.text("ib_word.unknown"),
        Err(refused) => TEXTS
            .text("ib_word.illegal")
            .with_text("mode", format::mode(refused.mode))
            .with_text("elsewhere", command_text(refused.command)),
    }
}

pub fn command_text(command: Command) -> Text {
    let cam = |id, number: u8| TEXTS.text(id).with("cam", number);
    match command {
        Command::Normal => TEXTS.text("ib_word.normal"),
        Command::Run => TEXTS.text("ib_word.run"),
        Command::Preset => TEXTS.text("ib_word.preset"),
        Command::FrabaPreset => TEXTS.text("ib_word.fraba"),
        Command::Set(Parameter::Default, _) => TEXTS.text("ib_word.default"),
        Command::Set(parameter, value) => TEXTS
            .text("ib_word.set")
            .with_text("parameter", format::parameter(parameter))
            .with_text("value", format::setting(parameter, value.get())),
        Command::Velocity(true) => TEXTS.text("ib_word.velocity_on"),
        Command::Velocity(false) => TEXTS.text("ib_word.velocity_off"),
        Command::ReadOut(read_out) => TEXTS.text("ib_word.read_out").with_text("what", explained::read_out(read_out)),
        Command::Cams(Some(program)) => TEXTS.text("ib_word.program").with("program", program.get()),
        Command::Cams(None) => TEXTS.text("ib_word.position_mode"),
        Command::Activate(mask) => TEXTS.text("ib_word.mask").with_text("cams", cams(mask)),
        Command::Shift(shift) => TEXTS.text("ib_word.shift").with("shift", shift.get()),
        Command::CamStart(number, at) => cam("ib_word.start", number.get()).with("at", at.get()),
        Command::CamStop(number, at) => cam("ib_word.stop", number.get()).with("at", at.get()),
        Command::ReadActivation => TEXTS.text("ib_word.read_mask"),
        Command::ReadCamStart(number) => cam("ib_word.read_start", number.get()),
        Command::ReadCamStop(number) => cam("ib_word.read_stop", number.get()),
        Command::ReadShift => TEXTS.text("ib_word.read_shift"),
        Command::Unknown(_) => TEXTS.text("ib_word.unknown"),
    }
}

/// Returns a mode in which the encoder accepts a command. Position mode is preferred over cam mode.
pub fn command_mode(command: Command) -> EncoderMode {
    if command.is_legal_in(EncoderMode::Position) || !command.is_legal_in(EncoderMode::Cam) {
        EncoderMode::Position
    } else {
        EncoderMode::Cam
    }
}

pub fn word_text(word: u32, known: &WordContext) -> Text {
    let reply = Reply::parse(word);
    match reply {
        Reply::Run { value, .. } => match known.mode {
            EncoderMode::Velocity => TEXTS.text("ib_word.speed").with("rpm", value.to_signed()),
            EncoderMode::Cam => outputs(word, known.shift),
            EncoderMode::Position | EncoderMode::Parameterisation | EncoderMode::ReadOut => {
                TEXTS.text("ib_word.position").with("position", value.get())
            }
        },
        Reply::Busy { .. } | Reply::Echo { .. } => describe_echo(reply, known.mode),
        Reply::ReadOut(value) => match known.read_out {
            Some(read_out) => TEXTS
                .text("ib_word.value")
                .with_text("what", explained::read_out(read_out))
                .with_text("value", format::read_out_value(read_out.value(value))),
            None => TEXTS
                .text("ib_word.some_value")
                .with_text("value", format::read_out_value(ReadOutValue::Plain(value.get()))),
        },
        Reply::UnknownReadOut(_) => TEXTS.text("ib_word.no_read_out"),
        Reply::Unknown { code, .. } => TEXTS.text("ib_word.unknown_reply").with("code", code.get()),
        Reply::Error(own) => error(own),
    }
}

/// Returns a warning if bits that should be 0 are set.
pub fn unexpected_bits(word: u32) -> Option<Text> {
    match Reply::parse(word) {
        Reply::Run { stray, .. } if stray != 0 => {
            Some(TEXTS.text("ib_word.stray").with("bits", format!("0x{:08X}", u32::from(stray) << Value::BITS)))
        }
        _ => None,
    }
}

fn error(error: ErrorWord) -> Text {
    let id = match (error.code.get(), error.data.get()) {
        (1, _) => "ib_error.data",
        (2, _) => "ib_error.code",
        (3, _) => "ib_error.lost",
        (0xC, ErrorWord::CAM_BEYOND_RANGE) => "ib_error.cam",
        (0xC, _) => "ib_error.maker",
        _ => "ib_error.invalid",
    };
    TEXTS.text(id).with("word", format!("0x{:08X}", Reply::Error(error).emit()))
}

fn describe_echo(reply: Reply, mode: EncoderMode) -> Text {
    let in_mode = if mode == EncoderMode::Cam { EncoderMode::Cam } else { EncoderMode::Parameterisation };
    match reply.echoed_command(in_mode) {
        Some(command) => TEXTS.text("ib_word.echo").with_text("command", command_text(command)),
        None if matches!(reply, Reply::Busy { .. }) => TEXTS.text("ib_word.busy"),
        None => TEXTS.text("ib_word.other_echo"),
    }
}

fn cams(mask: u16) -> Text {
    let numbers: Vec<String> = (0..16).filter(|bit| mask >> bit & 1 != 0).map(|bit| bit.to_string()).collect();
    if numbers.is_empty() { TEXTS.text("ib_item.no_cam") } else { literal_text(numbers.join(", ")) }
}

fn outputs(word: u32, shift: Option<WindowShift>) -> Text {
    let Ok(output) = CamOutput::parse(word) else { return TEXTS.text("ib_word.outputs_invalid") };
    let on = cams(output.outputs.into());
    match shift {
        Some(shift) if shift.mask() != 0 => TEXTS
            .text("ib_word.outputs")
            .with_text("cams", on)
            .with("position", format!("0x{:07X}", output.position_bits(shift))),
        _ => TEXTS.text("ib_word.outputs_only").with_text("cams", on),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;

    fn known(mode: EncoderMode) -> WordContext {
        WordContext { mode, read_out: None, shift: WindowShift::new(0) }
    }

    /// The words are from references 3, 5 and 7.
    #[test]
    fn decodes_words_by_mode() {
        let english = |text: Text| text.to_string_in(Language::English);
        for (word, mode, says) in [
            (0x0200_00FF, EncoderMode::Position, "Steps := 255"),
            (0x0600_0004, EncoderMode::Parameterisation, "Direction := counterclockwise"),
            (0x2040_0001, EncoderMode::Position, "Send the speed instead of the position"),
            (0x2040_0001, EncoderMode::Cam, "Active cams: 0"),
            (0x2040_0093, EncoderMode::Cam, "Active cams: 0, 1, 4, 7"),
            (0x4600_0015, EncoderMode::Cam, "Cam 3 starts at 21"),
            (0x2021_000C, EncoderMode::Position, "Read out: temperature"),
            (
                0x4600_0015,
                EncoderMode::Position,
                "This word is not valid in position mode. In another mode, it is the following command: Cam 3 starts at 21",
            ),
        ] {
            assert_eq!(english(describe_out_word(word, mode)), says, "{word:08X}");
        }
        for (word, mode, says) in [
            (0x0012_3456, EncoderMode::Position, "position 1193046"),
            (0xC000_0000, EncoderMode::Position, "busy"),
            // −60 as a number of 25 bits.
            (0x01FF_FFC4, EncoderMode::Velocity, "speed -60 rpm"),
            (0xC200_00FF, EncoderMode::Parameterisation, "echo of: Steps := 255"),
            (0x01CD_EF20, EncoderMode::Cam, "cams on: 5; window 0x001CDEF"),
            (0x8000_0000, EncoderMode::Cam, "position or cam outputs not valid (0x80000000)"),
            (0x9800_0004, EncoderMode::Cam, "start or stop of a cam outside the measuring range (0x98000004)"),
        ] {
            assert_eq!(english(word_text(word, &known(mode))), says, "{word:08X}");
        }
        let temperature = WordContext { read_out: Some(ReadOutNumber::TEMPERATURE), ..known(EncoderMode::ReadOut) };
        assert_eq!(english(word_text(0xA1FF_FF9C, &temperature)), "temperature: -10.0 °C");
        assert_eq!(word_text(0xA1FF_FF9C, &temperature).to_string_in(Language::German), "Temperatur: -10,0 °C");
        assert!(
            unexpected_bits(0x0412_3456).is_some()
                && unexpected_bits(0x0012_3456).is_none()
                && unexpected_bits(0xC200_00FF).is_none()
        );
    }
}
