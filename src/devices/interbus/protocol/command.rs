//! OUT words, which are the master's commands to a K3 encoder (references 3 and 5), and the modes in which they are
//! allowed.

use super::cam::{CamNumber, ProgramNumber};
use super::cam_output::WindowShift;
use super::mode::EncoderMode;
use super::parameter::Parameter;
use super::read_out::ReadOutNumber;
use super::value::{Code, Value};

/// Meaning of an OUT word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// 00000000h: normal operation.
    Normal,
    /// 80000000h: runs the encoder. The rising edge of bit 31 ends a parameterisation, a read-out or a change of cams.
    Run,
    /// 40000000h: applies the programmed preset to the position. A preset can be applied once each time it is
    /// programmed.
    Preset,
    /// 60000000h: applies the preset, any number of times. Each use must be followed by *run*.
    FrabaPreset,
    /// Sets a parameter.
    Set(Parameter, Value),
    /// 20400001h or 20400000h: outputs the speed or the position in the IN word.
    Velocity(bool),
    /// 2021xxxxh: requests a read-out.
    ReadOut(ReadOutNumber),
    /// 2080000ph: selects cam mode with the given program. `None` selects position mode.
    Cams(Option<ProgramNumber>),
    /// 2040cccch: sets the active cams, with bit i for cam i. The upper byte is 0, as there are only 8 cams (reference
    /// 6.9).
    Activate(u16),
    /// 201000ssh: sets the window shift.
    Shift(WindowShift),
    /// First byte 40h to 4Fh: sets the start position of a cam.
    CamStart(CamNumber, Value),
    /// First byte 60h to 6Fh: sets the stop position of a cam.
    CamStop(CamNumber, Value),
    /// 20200000h: reads the activation mask.
    ReadActivation,
    /// 2020001ch: reads the start position of a cam.
    ReadCamStart(CamNumber),
    /// 2020002ch: reads the stop position of a cam.
    ReadCamStop(CamNumber),
    /// 20200040h: reads the window shift. The manual's 20200030h is a misprint (reference 6.5).
    ReadShift,
    /// A word that the manual does not define.
    Unknown(u32),
}

/// Error for a command that must not be sent, because in its current mode the encoder would interpret it differently or
/// ignore it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{:08X} ({}) is not valid in {mode}", command.emit(), command.name())]
pub struct ForbiddenCommandError {
    /// The intended command.
    pub command: Command,
    /// Current mode of the encoder.
    pub mode: EncoderMode,
}

const RUN: u32 = 0x8000_0000;
const PRESET: u32 = 0x4000_0000;
const FRABA_PRESET: u32 = 0x6000_0000;
const SHIFT: u32 = 0x2010_0000;
const READ_CAMS: u32 = 0x2020_0000;
const READ_START: u32 = 0x10;
const READ_STOP: u32 = 0x20;
const READ_SHIFT: u32 = 0x40;
const READ_OUT: u32 = 0x2021_0000;
const MASK: u32 = 0x2040_0000;
const CAMS: u32 = 0x2080_0000;
/// Bits 31..29 of the word that sets the start of a cam.
const START: u32 = 0b010 << 29;
const STOP: u32 = 0b011 << 29;

impl Command {
    /// Returns the word.
    pub fn emit(self) -> u32 {
        let edge =
            |which: u32, cam: CamNumber, position: Value| which | u32::from(cam.get()) << Value::BITS | position.get();
        match self {
            Command::Normal => 0,
            Command::Run => RUN,
            Command::Preset => PRESET,
            Command::FrabaPreset => FRABA_PRESET,
            Command::Set(parameter, value) => u32::from(parameter.row().code) << Value::BITS | value.get(),
            Command::Velocity(on) => MASK | u32::from(on),
            Command::ReadOut(read_out) => READ_OUT | u32::from(read_out.to_u16()),
            Command::Cams(program) => CAMS | program.map_or(0, |program| u32::from(program.get())),
            Command::Activate(mask) => MASK | u32::from(mask),
            Command::Shift(shift) => SHIFT | u32::from(shift.get()),
            Command::CamStart(cam, position) => edge(START, cam, position),
            Command::CamStop(cam, position) => edge(STOP, cam, position),
            Command::ReadActivation => READ_CAMS,
            Command::ReadCamStart(cam) => READ_CAMS | READ_START | u32::from(cam.get()),
            Command::ReadCamStop(cam) => READ_CAMS | READ_STOP | u32::from(cam.get()),
            Command::ReadShift => READ_CAMS | READ_SHIFT,
            Command::Unknown(word) => word,
        }
    }

    /// Returns the meanings that a word has in any mode. There are one or two, or only [`Command::Unknown`] if the
    /// manual does not define the word.
    pub fn all_meanings(word: u32) -> Vec<Command> {
        let both: Vec<Command> =
            [Command::decode_non_cam_command(word), Command::parse_cam_word(word)].into_iter().flatten().collect();
        // Both decoders accept the selection of a program, which has the same meaning in all modes.
        match both.as_slice() {
            [] => vec![Command::Unknown(word)],
            [one, other] if one == other => vec![*one],
            _ => both,
        }
    }

    /// Parses a word the way an encoder in the given mode interprets it.
    ///
    /// # Errors
    /// Returns [`ForbiddenCommandError`] if the word has no meaning in this mode. The error contains its meaning in
    /// another mode, if any.
    pub fn in_mode(word: u32, mode: EncoderMode) -> Result<Command, ForbiddenCommandError> {
        let readings = Command::all_meanings(word);
        match readings.iter().find(|command| command.is_legal_in(mode)) {
            Some(command) => Ok(*command),
            None => Err(ForbiddenCommandError {
                command: readings.first().copied().unwrap_or(Command::Unknown(word)),
                mode,
            }),
        }
    }

    /// Checks that an encoder in the given mode would interpret the command as intended.
    ///
    /// # Errors
    /// Returns [`ForbiddenCommandError`] if the command must not be sent in this mode.
    pub fn ensure_legal(self, mode: EncoderMode) -> Result<(), ForbiddenCommandError> {
        if self.is_legal_in(mode) { Ok(()) } else { Err(ForbiddenCommandError { command: self, mode }) }
    }

    /// Returns whether the command may be sent in a mode. A word stays in the process data until the next one is
    /// written, so a word that enters a mode is also legal in that mode. Read-outs are allowed while the outputs are
    /// valid, since one of them returns the mode (`U`: not documented).
    pub const fn is_legal_in(self, mode: EncoderMode) -> bool {
        use EncoderMode::{Cam, Parameterisation, Position, ReadOut, Velocity};
        match self {
            Command::Normal | Command::Run => true,
            Command::Preset | Command::FrabaPreset => matches!(mode, Position),
            Command::Set(..) => matches!(mode, Position | Parameterisation),
            Command::Velocity(_) => matches!(mode, Position | Velocity),
            Command::ReadOut(_) => matches!(mode, Position | ReadOut | Velocity | Cam),
            Command::Cams(_) => matches!(mode, Position | Cam),
            Command::Activate(_)
            | Command::Shift(_)
            | Command::CamStart(..)
            | Command::CamStop(..)
            | Command::ReadActivation
            | Command::ReadCamStart(_)
            | Command::ReadCamStop(_)
            | Command::ReadShift => matches!(mode, Cam),
            Command::Unknown(_) => false,
        }
    }

    /// Returns the English name of the command.
    pub fn name(self) -> &'static str {
        match self {
            Command::Normal => "normal running",
            Command::Run => "run",
            Command::Preset => "set preset",
            Command::FrabaPreset => "FRABA preset",
            Command::Set(parameter, _) => parameter.name(),
            Command::Velocity(true) => "velocity start",
            Command::Velocity(false) => "velocity stop",
            Command::ReadOut(_) => "read-out",
            Command::Cams(Some(_)) => "cam program",
            Command::Cams(None) => "position mode",
            Command::Activate(_) => "activation mask",
            Command::Shift(_) => "shift of the window",
            Command::CamStart(..) => "start of a cam",
            Command::CamStop(..) => "stop of a cam",
            Command::ReadActivation => "read the activation mask",
            Command::ReadCamStart(_) => "read the start of a cam",
            Command::ReadCamStop(_) => "read the stop of a cam",
            Command::ReadShift => "read the shift of the window",
            Command::Unknown(_) => "an unknown word",
        }
    }

    /// Parses an OUT word received while no cam program is selected.
    fn decode_non_cam_command(word: u32) -> Option<Command> {
        let low = word as u16;
        match word {
            0 => Some(Command::Normal),
            RUN => Some(Command::Run),
            PRESET => Some(Command::Preset),
            FRABA_PRESET => Some(Command::FrabaPreset),
            _ if word == MASK | u32::from(low & 1) => Some(Command::Velocity(low == 1)),
            _ if word >> 16 == READ_OUT >> 16 => Some(Command::ReadOut(ReadOutNumber::new(low))),
            _ if word >> 16 == CAMS >> 16 => program(low),
            _ if word >> 29 == 0 => Parameter::from_code(Code::from_word(word))
                .map(|parameter| Command::Set(parameter, Value::from_word(word))),
            _ => None,
        }
    }

    /// Parses an OUT word received while a cam program is selected.
    fn parse_cam_word(word: u32) -> Option<Command> {
        let low = word as u16;
        let cam = || CamNumber::new(Code::from_word(word).get());
        let read_cam = || u8::try_from(low & 0xF).ok().and_then(CamNumber::new);
        match word >> 16 {
            high if high == CAMS >> 16 => program(low),
            high if high == MASK >> 16 => Some(Command::Activate(low)),
            high if high == SHIFT >> 16 => u8::try_from(low).ok().and_then(WindowShift::new).map(Command::Shift),
            high if high == READ_CAMS >> 16 => match u32::from(low) {
                0 => Some(Command::ReadActivation),
                READ_SHIFT => Some(Command::ReadShift),
                number if number & !0xF == READ_START => read_cam().map(Command::ReadCamStart),
                number if number & !0xF == READ_STOP => read_cam().map(Command::ReadCamStop),
                _ => None,
            },
            _ if word & STOP == START && word >> 31 == 0 => {
                cam().map(|cam| Command::CamStart(cam, Value::from_word(word)))
            }
            _ if word & STOP == STOP && word >> 31 == 0 => {
                cam().map(|cam| Command::CamStop(cam, Value::from_word(word)))
            }
            _ => None,
        }
    }
}

fn program(number: u16) -> Option<Command> {
    match u8::try_from(number).ok()? {
        0 => Some(Command::Cams(None)),
        number => ProgramNumber::new(number).map(|program| Command::Cams(Some(program))),
    }
}
