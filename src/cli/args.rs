//! What can be written on the command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};

use super::Failure;
use crate::link::LinkUrl;
use crate::protocol::hiperface::{AccessCode, CodeNumber};
use crate::signal::capture::Columns;
use crate::signal::quality::Family;

/// Configure position encoders at a desk: read, compare, write, verify, save and restore. Without a command it opens the
/// window.
#[derive(Parser)]
#[command(name = "encoder-studio", version, after_help = KINDS)]
pub(super) struct Arguments {
    #[command(flatten)]
    pub(super) common: Common,
    /// A profile to open in the window.
    #[arg(long, value_name = "FILE")]
    pub(super) profile: Option<PathBuf>,
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

/// Which commands are for which kinds of device.
const KINDS: &str = "\
Kinds of device: hiperface and biss; diff, verify and restore find it in the profile. find is for hiperface alone; do has
other actions for each (help do). Without hardware: --link sim:, as in

  encoder-studio identify biss --link sim:

An address or a register is hexadecimal with 0x in front, else decimal.";

#[derive(Args)]
pub(super) struct Common {
    /// The link to the device: sim:, serial:PATH, tcp:HOST:PORT, bridge:PATH, bridge:tcp:HOST:PORT or replay:FILE, with
    /// ?name=value&…
    #[arg(long, global = true, value_name = "URL")]
    pub(super) link: Option<LinkUrl>,
    /// Print JSON.
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// hiperface: an access code other than 55h, as N=HEX; repeatable. Also in ENCODER_STUDIO_CODES="0=66,2=1A".
    #[arg(long = "code", global = true, value_name = "N=HEX")]
    // Taken as text: a message about a wrong argument repeats it, and this may be a code.
    pub(super) codes: Vec<String>,
    /// Record every frame into a file that replay: plays back; access codes are masked.
    #[arg(long, global = true, value_name = "FILE")]
    pub(super) trace: Option<PathBuf>,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Serial ports on this machine.
    Ports,
    /// hiperface: every address, speed and parity that answers.
    Find(Find),
    /// Who is there.
    Identify(Device),
    /// Errors and warnings, decoded; of hiperface the whole error queue.
    Status(Device),
    /// The position.
    Position(Position),
    /// One value: a data field, a register, a setting.
    Read(Read),
    /// Read everything that can be restored, and what identifies the device.
    Save(Save),
    /// What differs, field by field.
    Diff(Diff),
    /// Read back and compare; changes nothing.
    Verify(Verify),
    /// Make the device as the profile says.
    Restore(Restore),
    /// Write one value.
    Write(Write),
    /// An action: hiperface restart, check, data fields …; biss calibrate, filter, preset … (help do lists them).
    Do(Do),
    /// Explain captured bytes, offline.
    Decode(Decode),
    /// Quality of a recorded sine/cosine signal: amplitude, offsets, gain, phase, position error.
    Analyse(Analyse),
    /// Frames of SSI encoders: what they say, how they are made, decoders for other programs.
    #[command(subcommand)]
    Ssi(Ssi),
    /// Be a device, on a pseudo-terminal or a TCP port.
    Simulate(Simulate),
}

#[derive(Args)]
pub(super) struct Device {
    /// The kind of device.
    pub(super) device: DeviceKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum DeviceKind {
    /// HIPERFACE motor-feedback encoder.
    Hiperface,
    /// POSITAL kit encoder, or another with BiSS C; over UBICOM (serial:, tcp:) or an adapter (bridge:).
    Biss,
}

#[derive(Args)]
pub(super) struct Find {
    /// The kind of device: an encoder of another kind has no address and one speed.
    #[arg(value_parser = PossibleValuesParser::new(["hiperface"]).map(|_| DeviceKind::Hiperface))]
    pub(super) device: DeviceKind,
    /// Exactly one encoder is connected: also ask by broadcast.
    #[arg(long)]
    pub(super) one_encoder: bool,
    /// Wait so long for the encoder to be switched off and on, and ask within its default window.
    #[arg(long, value_name = "SECONDS")]
    pub(super) power_cycle: Option<u64>,
}

#[derive(Args)]
pub(super) struct Position {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// Number of lines; without it one, and with --csv as many as come until Ctrl-C.
    #[arg(long, allow_negative_numbers = true)]
    pub(super) count: Option<u64>,
    /// Print a table (CSV): a header once, then a line a reading.
    #[arg(long, conflicts_with = "json")]
    pub(super) csv: bool,
    /// Time between two readings in milliseconds; 0: as fast as the line allows.
    #[arg(long, default_value_t = 100, value_name = "MS", allow_negative_numbers = true)]
    pub(super) interval: u64,
}

#[derive(Args)]
pub(super) struct Read {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// What to read, by its name.
    ///
    /// hiperface: field:N, field:N@ADDR+COUNT (without +COUNT the rest of the field), status:N, analogue:CH, counter,
    /// address, settings.
    ///
    /// biss: 0x66 (a direct register, 0x40 to 0x7F), 0x24:0x10 (bank 24h, offset 10h); with +COUNT a run of them, as
    /// 0x24:0x10+4.
    pub(super) item: String,
}

#[derive(Args)]
pub(super) struct Save {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// The profile to write.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(super) file: PathBuf,
    /// hiperface: fail when a data field cannot be read because its access code is not known.
    #[arg(long)]
    pub(super) complete: bool,
}

#[derive(Args)]
pub(super) struct Diff {
    /// A profile.
    pub(super) left: PathBuf,
    /// Another profile; without it, --link.
    pub(super) right: Option<PathBuf>,
}

#[derive(Args)]
pub(super) struct Verify {
    /// The profile.
    pub(super) file: PathBuf,
}

#[derive(Args)]
pub(super) struct Restore {
    /// The profile.
    pub(super) file: PathBuf,
    /// Print exactly the operations that would be carried out; write nothing.
    #[arg(long)]
    pub(super) dry_run: bool,
    #[command(flatten)]
    pub(super) consent: Consenting,
    /// The profile may be of another serial number.
    #[arg(long)]
    pub(super) allow_other_device: bool,
    /// Also restore values of the mounting onto another serial number.
    #[arg(long)]
    pub(super) with_mounting: bool,
    /// hiperface: delete and create again where a field has another size and is not the last.
    #[arg(long)]
    pub(super) recreate: bool,
}

#[derive(Args)]
pub(super) struct Consenting {
    /// Write without asking.
    #[arg(long)]
    pub(super) yes: bool,
    /// Write although the device counts as worn.
    #[arg(long)]
    pub(super) force_wear: bool,
}

#[derive(Args)]
pub(super) struct Write {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// What to write, by its name.
    ///
    /// hiperface: field:N, field:N@ADDR+COUNT (without +COUNT as many bytes as are given), status:N, counter (to 0),
    /// address, settings.
    ///
    /// biss: 0x24:0x10 (bank 24h, offset 10h), 0x24:0x10+4 (a run of four), 0x40 to 0x7F (direct). Registers that a procedure
    /// writes (filter, preset, calibration) are changed with "do biss …".
    pub(super) item: String,
    /// A number (decimal or 0x); hex bytes for a data field and for a run of registers (+COUNT).
    #[arg(allow_hyphen_values = true)]
    pub(super) value: String,
    #[command(flatten)]
    pub(super) consent: Consenting,
}

#[derive(Args)]
pub(super) struct Do {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// What to do.
    pub(super) action: Action,
    /// What the action takes, as said there.
    #[arg(allow_negative_numbers = true)]
    pub(super) arguments: Vec<String>,
    #[command(flatten)]
    pub(super) consent: Consenting,
    /// hiperface set-position: exactly this value, also when it breaks the phase to the sine signal.
    #[arg(long)]
    pub(super) exact: bool,
    /// hiperface synchronise: the encoder is a kit, where its type does not tell.
    #[arg(long)]
    pub(super) kit: bool,
    /// biss: how long the motor may take to turn, or the shaft to rest, as an action needs it; 30 without a terminal, 300
    /// on one.
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u16).range(1..=3600))]
    pub(super) timeout: Option<u16>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Action {
    /// hiperface: restart the encoder and read its status.
    Reset,
    // Two kinds of device have it.
    #[value(
        help = "hiperface: the start-up sequence with a verdict a line, with restart behind it after a restart; biss: identity, errors, position, data sheet, limits, wear with a verdict a line"
    )]
    Check,
    /// hiperface: POSITION, the nearest value that keeps the phase to the sine signal.
    SetPosition,
    /// hiperface: POSITION, for kit encoders, aligns the code tracks as well.
    Synchronise,
    // Brackets in what rustdoc reads would be links.
    #[value(help = "hiperface: NUMBER SIZE|STATUS [code=N] [ce=0|1] [we=0|1]")]
    CreateField,
    /// hiperface: NUMBER SIZE, the last field only.
    ResizeField,
    /// hiperface: NUMBER, write protect.
    LockField,
    /// hiperface: NUMBER, make writable.
    UnlockField,
    /// hiperface: NUMBER, the last field only.
    DeleteField,
    /// hiperface: NUMBER HEX, the present code is given with --code.
    ChangeCode,
    /// hiperface: counter + 1.
    IncrementCounter,
    /// hiperface: counter to 0.
    ClearCounter,
    /// hiperface: SETTINGS, interface settings until the next restart.
    ConfigureForNow,
    /// biss: calibrate the singleturn; the motor turns counterclockwise, then clockwise, at 500 ± 2 rpm.
    Calibrate,
    #[value(
        help = "biss: [save], test the Wiegand sensor; the motor turns clockwise, then counterclockwise, at 500 to 2000 rpm"
    )]
    WiegandTest,
    /// biss: balanced|dynamic.
    Filter,
    #[value(
        help = "biss: [ST [MT]] [singleturn|multiturn]: store a value (MT 0 if left out), then make the shaft's place that value; without a value the stored one"
    )]
    Preset,
    /// biss: back to operation and the password cleared, after a procedure was cut off.
    LeadBack,
    #[value(
        help = "biss: [calibrate] [wiegand-test] [save] [preset=ST,MT] [data=FILE] in one run; without the first two both are meant"
    )]
    Mounting,
}

/// The action as it is written.
pub(super) fn action_name(action: Action) -> String {
    action.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}

/// An action that is for another kind of device.
pub(super) fn no_action(action: Action, kind: &str, known: &str) -> Failure {
    Failure::Usage(format!("{} is not an action of {kind} devices; these are {known}", action_name(action)))
}

#[derive(Args)]
pub(super) struct Decode {
    pub(super) protocol: DeviceKind,
    /// A frame as hex bytes; several frames as one argument each.
    ///
    /// biss: UBICOM frames, bridge packets (up to their 00), position frames of the kit encoder (41 bits right-justified:
    /// 16 turns, 17 steps, error, warning, CRC-6; one word of 11 hex digits or with 0x), and position words as "position"
    /// prints them (024698000h, or raw=610893824 from JSON or a table).
    #[arg(required = true)]
    pub(super) hex: Vec<String>,
}

#[derive(Args)]
pub(super) struct Analyse {
    /// A table of time, sine and cosine in seconds and volts; delimiter, decimal sign, header and units are found out.
    #[arg(value_name = "FILE.csv")]
    pub(super) file: PathBuf,
    /// Numbers of the columns, from 1: time, sine, cosine; or time, SIN, REFSIN, COS, REFCOS. Then, where there are such
    /// columns, reference=N (mechanical degrees) and absolute=N (steps of 1/32 period).
    #[arg(long, value_name = "1,2,3", value_parser = parse_columns)]
    pub(super) columns: Option<Columns>,
    /// Volts in one unit of the sine and cosine columns.
    #[arg(long, value_name = "X", value_parser = parse_factor, allow_negative_numbers = true)]
    pub(super) volts_per_unit: Option<f64>,
    /// The encoders by whose limits the signal is judged.
    #[arg(long, value_enum, default_value_t = Limits::Hiperface)]
    pub(super) limits: Limits,
    /// Signal periods in a revolution: for the speed, for what repeats with the revolution, and with a reference for DNL
    /// and INL.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000), allow_negative_numbers = true)]
    pub(super) periods: Option<u32>,
}

/// Families of encoders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Limits {
    /// 0.9 … 1.1 V peak to peak, references at 2.0 … 3.0 V.
    Hiperface,
    /// 0.8 … 1.2 V peak to peak, references at 2.25 … 2.75 V.
    AfsAfm60,
    /// 0.9 … 1.1 V peak to peak, references at 2.375 … 2.625 V.
    Ttk70,
}

impl Limits {
    pub(super) fn family(self) -> Family {
        match self {
            Limits::Hiperface => Family::Hiperface,
            Limits::AfsAfm60 => Family::AfsAfm60,
            Limits::Ttk70 => Family::Ttk70,
        }
    }
}

#[derive(Subcommand)]
pub(super) enum Ssi {
    /// What frames say.
    Decode(SsiDecode),
    /// The frame of a position.
    Encode(SsiEncode),
    /// A decoder or table for other programs.
    Export(SsiExport),
}

#[derive(Args)]
pub(super) struct SsiDecode {
    #[command(flatten)]
    pub(super) layout: SsiLayout,
    /// Bits in the order of the clocks (0b1010… or 1010…), or 0x… right-justified; repeatable.
    #[arg(required = true, value_name = "FRAME")]
    pub(super) frames: Vec<String>,
}

#[derive(Args)]
pub(super) struct SsiEncode {
    #[command(flatten)]
    pub(super) layout: SsiLayout,
    /// Turns and steps as one number.
    #[arg(long, value_name = "N", required_unless_present = "steps", conflicts_with_all = ["turns", "steps"], allow_negative_numbers = true)]
    pub(super) position: Option<String>,
    /// Whole turns; 0 if left out.
    #[arg(long, value_name = "T", requires = "steps", allow_negative_numbers = true)]
    pub(super) turns: Option<String>,
    /// Steps within the turn.
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) steps: Option<String>,
    /// An error bit that speaks, by its name; repeatable.
    #[arg(long = "error", value_name = "NAME")]
    pub(super) errors: Vec<String>,
}

#[derive(Args)]
pub(super) struct SsiExport {
    #[command(flatten)]
    pub(super) layout: SsiLayout,
    /// What to write.
    #[arg(long, value_enum)]
    pub(super) format: SsiFormat,
    /// The file to write; without it, it is printed.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(super) file: Option<PathBuf>,
}

#[derive(Args)]
pub(super) struct SsiLayout {
    /// A family with its settings, as ahm36,code=gray,st=12. What is left out is as delivered, with the largest resolution.
    ///
    /// Families: ahs36 ahm36 afs60 afm60 afs60s afm60s atm60 atm90 ars60 ttk70 kh53. Settings: code=binary|gray|gray-excess|bcd,
    /// over=position|padded|errors (what Gray goes over), mt= and st= (bits), steps= with turns= or revolutions=25/2,
    /// clocks=, align=left|right24|right25|tree12_13|tree13_12, shift=0|1, err=none|fix|following, step= (nanometres). Or
    /// linuxcnc: with a format string of LinuxCNC behind it.
    #[arg(long = "layout", value_name = "SPEC")]
    pub(super) spec: String,
}

/// What a layout can be exported as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SsiFormat {
    /// A function in C99.
    C,
    /// A function block in IEC 61131-3 structured text.
    St,
    /// The format string of LinuxCNC's ssi_chan.
    Linuxcnc,
    /// A row for each clock.
    Csv,
}

#[derive(Args)]
pub(super) struct Simulate {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// Make a pseudo-terminal and a symbolic link to it here.
    #[arg(long, value_name = "PATH", conflicts_with = "listen")]
    pub(super) pty: Option<PathBuf>,
    /// Listen at HOST:PORT.
    #[arg(long, value_name = "ADDR")]
    pub(super) listen: Option<String>,
    /// biss: be an adapter in front of the encoder, which speaks the bridge protocol, instead of its UBICOM line.
    #[arg(long)]
    pub(super) bridge: bool,
    /// Seed of the faults.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// drop:P, flip:P, garbage:P, delay:MS, silent-after:N, die-in-store:N; comma separated.
    #[arg(long, value_name = "SPEC")]
    pub(super) fault: Option<String>,
    /// A property of the virtual encoder, as after sim:? (rpm=60, echo=on; hiperface model=sel37; biss firmware=1.2.0 …);
    /// repeatable. One that there is not is answered with all that there are.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub(super) settings: Vec<String>,
}

/// An access code with its number.
#[derive(Clone, Copy)]
pub(super) struct Code {
    pub(super) number: CodeNumber,
    pub(super) code: AccessCode,
}

impl FromStr for Code {
    type Err = String;

    /// The message never repeats the text: it may be a code.
    fn from_str(text: &str) -> Result<Self, String> {
        let form = || "an access code is given as N=HEX with N from 0 to 3, as in 2=1A".to_owned();
        let (number, code) = text.split_once('=').ok_or_else(form)?;
        let number = number.trim().parse().ok().and_then(CodeNumber::new).ok_or_else(form)?;
        Ok(Code { number, code: parse_code(code).ok_or_else(form)? })
    }
}

fn parse_columns(text: &str) -> Result<Columns, String> {
    let number = |word: &str| word.trim().parse().ok().filter(|number: &usize| *number > 0);
    let mut numbers: Vec<usize> = Vec::new();
    let (mut reference_angle, mut absolute) = (None, None);
    for word in text.split(',') {
        let place = match word.split_once('=') {
            None => &mut None,
            Some(("reference", _)) => &mut reference_angle,
            Some(("absolute", _)) => &mut absolute,
            Some((name, _)) => return Err(format!("{name} is no column; there are reference= and absolute=")),
        };
        let column = number(word.split_once('=').map_or(word, |(_, number)| number));
        *place = Some(column.ok_or("columns are numbers from 1, as in 1,2,3 or 1,2,3,reference=4")?);
        if !word.contains('=') {
            numbers.extend(column);
        }
    }
    let (time, sine, cosine, references) = match *numbers.as_slice() {
        [time, sine, cosine] => (Some(time), sine, cosine, None),
        [time, sine, refsin, cosine, refcos] => (Some(time), sine, cosine, Some((refsin, refcos))),
        _ => return Err("three or five column numbers from 1 are needed, as in 1,2,3".to_owned()),
    };
    numbers.extend(reference_angle.into_iter().chain(absolute));
    let different: std::collections::BTreeSet<&usize> = numbers.iter().collect();
    if different.len() < numbers.len() {
        return Err("a column stands there twice".to_owned());
    }
    Ok(Columns { time, sine, cosine, references, reference_angle, absolute })
}

fn parse_factor(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0);
    factor.ok_or_else(|| "a number above 0 is needed, as in 0.001".to_owned())
}

/// An access code: one or two hex digits, with or without `0x` or a final `h`.
pub(super) fn parse_code(text: &str) -> Option<AccessCode> {
    match crate::bits::parse_hex(text.trim()).ok()?.as_slice() {
        [byte] => Some(AccessCode::new(*byte)),
        _ => None,
    }
}
