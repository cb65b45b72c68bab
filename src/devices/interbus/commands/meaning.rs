//! Explains process data words as text.

use serde_json::{Value as Json, json};

use crate::devices::interbus::protocol::{
    CamOutput, Command, EncoderMode, Parameter, ReadOutNumber, ReadOutValue, Reply, SingleWord, StartupMode, Value,
    WindowShift,
};

/// What is known about the encoder that sent or received a word.
pub(super) struct WordContext {
    pub(super) mode: Option<EncoderMode>,
    pub(super) read_out: Option<ReadOutNumber>,
    pub(super) shift: Option<WindowShift>,
}

pub(super) struct WordMeaning {
    direction: &'static str,
    /// Modes in which the word has this meaning, or an empty list for all modes.
    modes: Vec<EncoderMode>,
    words: String,
    value: Option<u32>,
    /// Whether the word may be sent in these modes.
    legal: bool,
}

impl WordMeaning {
    pub(super) fn to_line(&self) -> String {
        let modes: Vec<&str> = self.modes.iter().map(|mode| mode.name()).collect();
        match modes.split_last() {
            None => format!("{}: {}", self.direction, self.words),
            Some((one, [])) => format!("{} in {one} mode: {}", self.direction, self.words),
            Some((last, first)) => format!("{} in {} or {last} mode: {}", self.direction, first.join(", "), self.words),
        }
    }

    pub(super) fn json(&self) -> Json {
        let modes: Vec<&str> = self.modes.iter().map(|mode| mode.name()).collect();
        let direction = self.direction.to_lowercase();
        json!({"direction": direction, "modes": modes, "meaning": self.words, "value": self.value, "legal": self.legal})
    }
}

pub(super) fn k1_word_meaning(word: SingleWord) -> WordMeaning {
    let position = word.position().get();
    let words =
        format!("position {position} of a K1 encoder{}", unexpected_bits(word.unexpected_bits(), "above bit 11"));
    WordMeaning { direction: "IN", modes: Vec::new(), words, value: Some(position), legal: true }
}

/// Returns every meaning of an OUT word, or the reason why the word must not be sent.
pub(super) fn out_word_meanings(word: u32, known: &WordContext) -> Result<Vec<WordMeaning>, String> {
    let readings = Command::all_meanings(word);
    if let [Command::Unknown(_)] = readings.as_slice() {
        return Err("nothing that an encoder is asked in any mode".to_owned());
    }
    let meaning = |command: Command, modes: Vec<EncoderMode>| {
        let (words, value) = command_description(command);
        WordMeaning { direction: "OUT", modes, words, value, legal: true }
    };
    let legal = |command: Command| EncoderMode::ALL.into_iter().filter(move |mode| command.is_legal_in(*mode));
    match known.mode {
        None => Ok(readings
            .into_iter()
            .map(|command| {
                let modes: Vec<EncoderMode> = legal(command).collect();
                let everywhere = modes.len() == EncoderMode::ALL.len();
                meaning(command, if everywhere { Vec::new() } else { modes })
            })
            .collect()),
        Some(mode) => match Command::in_mode(word, mode) {
            Ok(command) => Ok(vec![meaning(command, vec![mode])]),
            Err(refused) => Err(format!("not legal in {mode}: {}", wrong_mode_text(refused.command))),
        },
    }
}

/// Returns what an OUT word would mean in another mode, if it must not be sent in the known mode.
pub(super) fn meanings_in_other_modes(word: u32, known: &WordContext) -> Vec<WordMeaning> {
    let refused = known.mode.and_then(|mode| Command::in_mode(word, mode).err());
    refused
        .filter(|refused| !matches!(refused.command, Command::Unknown(_)))
        .map(|refused| WordMeaning {
            direction: "OUT",
            modes: vec![refused.mode],
            words: format!("not legal, {}", wrong_mode_text(refused.command)),
            value: command_description(refused.command).1,
            legal: false,
        })
        .into_iter()
        .collect()
}

fn wrong_mode_text(command: Command) -> String {
    let modes: Vec<&str> =
        EncoderMode::ALL.into_iter().filter(|mode| command.is_legal_in(*mode)).map(EncoderMode::name).collect();
    format!("\"{}\" is for {} mode", command_description(command).0, modes.join(" or "))
}

/// Returns the meaning of an IN word in the known mode, or all possible meanings if the mode is unknown.
pub(super) fn in_word_meanings(word: u32, known: &WordContext) -> Vec<WordMeaning> {
    let reply = Reply::parse(word);
    let meaning = |modes: &[EncoderMode], words: String, value: Option<u32>| WordMeaning {
        direction: "IN",
        modes: modes.iter().copied().filter(|mode| known.mode.is_none_or(|known| known == *mode)).collect(),
        words,
        value,
        legal: true,
    };
    use EncoderMode::{Cam, Parameterisation, Position, ReadOut, Velocity};
    let mut all = match reply {
        Reply::Run { value, stray: bits } => {
            let stray = unexpected_bits(bits.into(), "in bits 30 to 25");
            let number = value.get();
            vec![
                meaning(&[Position, Parameterisation, ReadOut], format!("position {number}{stray}"), Some(number)),
                meaning(&[Velocity], format!("speed {} rpm{stray}", value.to_signed()), Some(number)),
                meaning(&[Cam], outputs(word, known.shift), None),
            ]
        }
        Reply::Busy { .. } | Reply::Echo { .. } => vec![
            meaning(&[Position, Parameterisation, ReadOut, Velocity], describe_echo(reply, Parameterisation), None),
            meaning(&[Cam], describe_echo(reply, Cam), None),
        ],
        Reply::ReadOut(value) => vec![meaning(&EncoderMode::ALL, read_out(value, known.read_out), Some(value.get()))],
        Reply::UnknownReadOut(_) => {
            vec![meaning(&EncoderMode::ALL, "unknown parameter in a read-out".to_owned(), None)]
        }
        Reply::Unknown { code, data } => {
            let words = format!("a read-out word with code {}, which the manual does not have", code.get());
            vec![meaning(&EncoderMode::ALL, words, Some(data.get()))]
        }
        Reply::Error(error) => {
            let words = format!(
                "error, {} (code {}, data 0x{:X}): {}",
                error.meaning(),
                error.code.get(),
                error.data.get(),
                error.remedy()
            );
            vec![meaning(&EncoderMode::ALL, words, Some(error.data.get()))]
        }
    };
    all.retain(|meaning_of_mode| !meaning_of_mode.modes.is_empty());
    for meaning_of_mode in &mut all {
        if meaning_of_mode.modes.len() == EncoderMode::ALL.len() {
            meaning_of_mode.modes.clear();
        }
    }
    all
}

fn unexpected_bits(bits: u32, place: &str) -> String {
    if bits == 0 { String::new() } else { format!("; warning: 0x{bits:X} {place} should be 0") }
}

fn command_description(command: Command) -> (String, Option<u32>) {
    let with = |words: String, value: u32| (words, Some(value));
    match command {
        Command::Set(Parameter::Default, _) => {
            ("set the encoder to default (only in the appendix of the manual)".to_owned(), None)
        }
        Command::Set(parameter, value) => with(describe_setting(parameter, value), value.get()),
        Command::ReadOut(read_out) => with(format!("read out {}", name(read_out)), read_out.to_u16().into()),
        Command::Cams(Some(program)) => with(format!("cam mode with program {}", program.get()), program.get().into()),
        Command::Activate(mask) => with(format!("activation mask 0x{mask:04X}: {}", cams(mask)), mask.into()),
        Command::Shift(shift) => with(format!("shift of the window {}", shift.get()), shift.get().into()),
        Command::CamStart(cam, at) => with(format!("cam {} starts at {}", cam.get(), at.get()), at.get()),
        Command::CamStop(cam, at) => with(format!("cam {} stops at {}", cam.get(), at.get()), at.get()),
        Command::ReadCamStart(cam) => with(format!("read the start of cam {}", cam.get()), cam.get().into()),
        Command::ReadCamStop(cam) => with(format!("read the stop of cam {}", cam.get()), cam.get().into()),
        other => (other.name().to_owned(), None),
    }
}

fn describe_setting(parameter: Parameter, value: Value) -> String {
    let row = parameter.row();
    let number = value.get();
    let range = parameter.range_with_any_gear();
    let meaning = match (parameter, number) {
        (Parameter::Direction, 3) => ", clockwise",
        (Parameter::Direction, 4) => ", counterclockwise",
        _ => "",
    };
    let beyond = if range.contains(&number) {
        String::new()
    } else {
        format!("; warning: beyond {} to {}", range.start(), range.end())
    };
    format!("set {} to {number}{meaning}{beyond}", row.name)
}

fn name(read_out: ReadOutNumber) -> String {
    match (read_out.row(), read_out.register()) {
        (Some(row), _) => row.name.to_owned(),
        (None, Some(register)) => format!("register {register} of the chip"),
        (None, None) => format!("0x{:X}, which the manual does not have", read_out.to_u16()),
    }
}

fn cams(mask: u16) -> String {
    let numbers: Vec<String> = (0..16).filter(|bit| mask >> bit & 1 != 0).map(|bit| bit.to_string()).collect();
    match numbers.as_slice() {
        [] => "no cam".to_owned(),
        [one] => format!("cam {one}"),
        several => format!("cams {}", several.join(", ")),
    }
}

fn outputs(word: u32, shift: Option<WindowShift>) -> String {
    let Ok(output) = CamOutput::parse(word) else {
        return "cam outputs not valid".to_owned();
    };
    let window = match shift {
        Some(shift) if shift.mask() == 0 => "no bit of the position".to_owned(),
        Some(shift) => {
            format!("position 0x{:07X} in the bits 0x{:07X}", output.position_bits(shift), shift.mask())
        }
        None => format!("window 0x{:05X} (--shift says of which bits)", output.window),
    };
    format!("{} on; {window}{}", cams(output.outputs.into()), unexpected_bits(output.stray.into(), "in bits 30 to 25"))
}

fn describe_echo(reply: Reply, mode: EncoderMode) -> String {
    let (code, manufacturer, data) = match reply {
        Reply::Busy { manufacturer, data } => (0, manufacturer, data),
        Reply::Echo { manufacturer, code, data } => (code.get(), manufacturer, data),
        _ => return String::new(),
    };
    let with = if manufacturer { ", manufacturer bit" } else { "" };
    match (reply.echoed_command(mode), code) {
        (Some(command), 0) if !matches!(command, Command::CamStart(..) | Command::CamStop(..)) => {
            format!("echo of \"{}\"", command_description(command).0)
        }
        (Some(command), 0) => format!("busy{with}, or echo of \"{}\"", command_description(command).0),
        (Some(command), _) => format!("echo of \"{}\"", command_description(command).0),
        (None, 0) if data == Value::default() => format!("busy{with}"),
        (None, 0) => format!("busy{with}, data {}", data.get()),
        (None, code) => format!("echo of code {code}{with}, data {}", data.get()),
    }
}

fn read_out(value: Value, read_out: Option<ReadOutNumber>) -> String {
    let number = value.get();
    match read_out {
        Some(read_out) => format!("{} {}", name(read_out), scaled_value(value, read_out)),
        None => format!(
            "read-out value {number} (0x{number:X}); as temperature {}, as operating time {} (--read-out says what it is)",
            scaled_value(value, ReadOutNumber::TEMPERATURE),
            scaled_value(value, ReadOutNumber::OPERATING_TIME),
        ),
    }
}

fn scaled_value(value: Value, read_out: ReadOutNumber) -> String {
    match read_out.value(value) {
        ReadOutValue::Plain(number) => format!("{number} (0x{number:X})"),
        ReadOutValue::Minutes(minutes) => format!("{minutes} min"),
        ReadOutValue::TenthsOfDegree(tenths) => format!("{:.1} °C", f64::from(tenths) / 10.0),
        ReadOutValue::StartupMode(mode) => match mode {
            StartupMode::K2 => "K2 (0)".to_owned(),
            StartupMode::K3 => "K3 (1)".to_owned(),
            StartupMode::Velocity => "velocity (2)".to_owned(),
            StartupMode::Cams(program) => format!("cam program {} ({})", program.get(), mode.emit()),
            StartupMode::Unknown(value) => format!("{}, which the manual does not have", value.get()),
        },
        ReadOutValue::Flags(flags) => format!(
            "0x{:X}: {}, {}{}",
            flags.value().get(),
            if flags.steps_minus_one() { "steps−1 mode" } else { "steps as they are" },
            if flags.counts_turns() { "multiturn" } else { "single turn" },
            unexpected_bits(flags.unknown_bits(), "is unknown and"),
        ),
    }
}
