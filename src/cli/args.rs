//! What can be written on the command line.

mod act;
mod analyse;
mod decode;

use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};

pub(crate) use act::{Action, Do, action_name, no_action, no_option};
pub(super) use analyse::Analyse;
pub(crate) use decode::{Decode, Direction, Protocol, Words};

use crate::devices::hiperdrive::commands::{Move, listed_parameters};
use crate::devices::hiperface::protocol::{AccessCode, CodeNumber};
use crate::devices::ssi::commands::Ssi;
use crate::link::LinkUrl;

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
Kinds of device: hiperface, biss, ssi, interbus and hiperdrive; diff, verify and restore find it in the profile. find is for
hiperface and hiperdrive; do has other actions for each (help do). An SSI encoder sends its position and nothing else: --layout
says how its frame is made, and ssi explains frames offline. Reading an INTERBUS encoder replaces its position for a moment.
Without hardware: --link sim:, as in

  encoder-studio identify biss --link sim:

An address or a register is hexadecimal with 0x in front, else decimal.";

#[derive(Args)]
pub(crate) struct Common {
    /// The link to the device: sim:, serial:PATH, tcp:HOST:PORT, modbus:HOST:PORT, enip:HOST, bridge:PATH,
    /// bridge:tcp:HOST:PORT or replay:FILE, with ?name=value&…
    #[arg(long, global = true, value_name = "URL")]
    pub(crate) link: Option<LinkUrl>,
    /// Print JSON.
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// hiperface: an access code other than 55h, as N=HEX; repeatable. Also in ENCODER_STUDIO_CODES="0=66,2=1A".
    #[arg(long = "code", global = true, value_name = "N=HEX")]
    // Taken as text: a message about a wrong argument repeats it, and this may be a code.
    pub(super) codes: Vec<String>,
    /// hiperface on a serial line: no drive or controller is connected to it or powered. Without this it is asked on a
    /// terminal; find needs it elsewhere.
    #[arg(long, global = true)]
    pub(crate) only_master: bool,
    /// Record every frame into a file that replay: plays back; access codes are masked.
    #[arg(long, global = true, value_name = "FILE")]
    pub(super) trace: Option<PathBuf>,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Serial ports on this machine.
    Ports,
    /// hiperface: every address, speed and parity that answers; hiperdrive: every adapter and hub in the network.
    Find(Find),
    /// Who is there.
    Identify(Device),
    /// Errors and warnings, decoded; of hiperface the whole error queue.
    Status(Status),
    /// The position.
    Position(Position),
    /// One value: a data field, a register, a setting.
    ///
    /// Cam programs of an INTERBUS encoder are selected one after the other to be read, which switches its live outputs. On
    /// a terminal it asks first whether the machine stands still; without one it says so and goes on.
    #[command(after_long_help = listed_parameters())]
    Read(Read),
    /// Read everything that can be restored, and what identifies the device.
    ///
    /// Cam programs of an INTERBUS encoder are selected one after the other to be read, which switches its live outputs. On
    /// a terminal it asks first whether the machine stands still; without one it says so and goes on.
    Save(Save),
    /// What differs, field by field.
    ///
    /// Cam programs of an INTERBUS encoder are selected one after the other to be read, which switches its live outputs. On
    /// a terminal it asks first whether the machine stands still; without one it says so and goes on.
    Diff(Diff),
    /// Read back and compare; changes nothing.
    ///
    /// Cam programs of an INTERBUS encoder are selected one after the other to be read, which switches its live outputs. On
    /// a terminal it asks first whether the machine stands still; without one it says so and goes on.
    Verify(Verify),
    /// Make the device as the profile says.
    Restore(Restore),
    /// Write one value.
    Write(Write),
    /// hiperdrive: a drive goes to a position. Ctrl-C stops it; it is off afterwards.
    Move(Move),
    /// An action: hiperface restart, check, data fields …; biss calibrate, filter …; hiperdrive save … (help do lists them).
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
pub(crate) enum DeviceKind {
    /// HIPERFACE motor-feedback encoder.
    Hiperface,
    /// POSITAL kit encoder, or another with BiSS C; over UBICOM (serial:, tcp:) or an adapter (bridge:).
    Biss,
    /// SSI encoder; it sends its position and nothing else: --layout says how its frame is made.
    Ssi,
    /// INTERBUS encoder (K3) behind a Modbus/TCP gateway (modbus:); words of K1 and K2 are explained offline (decode).
    Interbus,
    /// HIPERDRIVE with EtherNet/IP (enip:), one behind an adapter or up to eight behind a hub.
    Hiperdrive,
}

#[derive(Args)]
pub(crate) struct Find {
    /// The kind of device: an encoder of another kind has no address and one speed.
    #[arg(value_parser = PossibleValuesParser::new(["hiperface", "hiperdrive"]).map(|word| found(&word)))]
    pub(super) device: DeviceKind,
    /// hiperface: exactly one encoder is connected: also ask by broadcast.
    #[arg(long)]
    pub(crate) one_encoder: bool,
    /// hiperface: wait so long for the encoder to be switched off and on, and ask within its default window.
    #[arg(long, value_name = "SECONDS")]
    pub(crate) power_cycle: Option<u64>,
}

/// The kind of a word that there is.
fn found(word: &str) -> DeviceKind {
    if word == "hiperdrive" { DeviceKind::Hiperdrive } else { DeviceKind::Hiperface }
}

#[derive(Args)]
pub(crate) struct Status {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// ssi: how its frame is made, a profile or a family with its settings (help ssi decode says which).
    #[arg(long, value_name = "FILE|SPEC")]
    pub(crate) layout: Option<String>,
}

#[derive(Args)]
pub(crate) struct Position {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// ssi: how its frame is made, a profile or a family with its settings (help ssi decode says which).
    #[arg(long, value_name = "FILE|SPEC")]
    pub(crate) layout: Option<String>,
    /// Number of lines; without it one, and with --csv as many as come until Ctrl-C.
    #[arg(long, allow_negative_numbers = true)]
    pub(super) count: Option<u64>,
    /// Print a table (CSV): a header once, then a line a reading.
    #[arg(long, conflicts_with = "json")]
    pub(crate) csv: bool,
    /// Time between two readings in milliseconds; 0: as fast as the line allows.
    #[arg(long, default_value_t = 100, value_name = "MS", allow_negative_numbers = true)]
    pub(super) interval: u64,
    #[command(flatten)]
    pub(crate) of: OfDrive,
}

#[derive(Args)]
pub(crate) struct OfDrive {
    /// hiperdrive: which drive of a hub, 1 to 8; without it the first, or the one that a parameter's number names.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=8))]
    pub(crate) drive: Option<u8>,
}

#[derive(Args)]
pub(crate) struct Read {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// What to read, by its name.
    ///
    /// hiperface: field:N, field:N@ADDR+COUNT (without +COUNT the rest of the field), status:N, analogue:CH, counter,
    /// address, settings.
    ///
    /// biss: 0x66 (a direct register, 0x40 to 0x7F), 0x24:0x10 (bank 24h, offset 10h); with +COUNT a run of them, as
    /// 0x24:0x10+4.
    ///
    /// interbus: steps, revolutions, direction, preset, zero-shift, shift, cam:P:C (program 1 to 8, cam 0 to 7),
    /// cam-mask:P, temperature, operating-time.
    ///
    /// hiperdrive: a parameter's number: 17, 158; of another drive of a hub 158 with --drive 2, or 258.
    pub(crate) item: String,
    #[command(flatten)]
    pub(crate) of: OfDrive,
}

#[derive(Args)]
pub(crate) struct Save {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// The profile to write.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Replace a file that exists without asking.
    #[arg(long)]
    pub(super) force: bool,
    /// hiperface: fail when a data field cannot be read because its access code is not known.
    #[arg(long)]
    pub(crate) complete: bool,
    /// ssi: the layout to save, a profile or a family with its settings (help ssi decode says which).
    #[arg(long, value_name = "FILE|SPEC")]
    pub(crate) layout: Option<String>,
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
    pub(crate) file: PathBuf,
}

#[derive(Args)]
pub(crate) struct Restore {
    /// The profile.
    pub(crate) file: PathBuf,
    /// Print exactly the operations that would be carried out; write nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) consent: Consenting,
    /// The profile may be of another serial number of the same type.
    #[arg(long)]
    pub(crate) allow_other_device: bool,
    /// The profile may be of another type of device.
    ///
    /// hiperface: another type byte. biss: another profile ID, manufacturer or device ID, or another number of bits of turns
    /// or steps. interbus: single turn instead of multiturn, or steps counted less one. hiperdrive: an adapter, a hub with
    /// four or with eight places instead of another one, or another variant of drive at a place.
    #[arg(long)]
    pub(crate) allow_other_type: bool,
    /// hiperface: copy the bytes of unknown meaning of this data field onto another serial number; repeatable.
    #[arg(long, value_name = "field:N")]
    pub(crate) copy: Vec<String>,
    /// hiperface: leave the bytes of unknown meaning of this data field as the encoder has them; repeatable.
    #[arg(long, value_name = "field:N")]
    pub(crate) leave: Vec<String>,
    /// Also restore values of the mounting onto another serial number.
    #[arg(long)]
    pub(crate) with_mounting: bool,
    /// hiperface: delete and create again where a field has another size and is not the last.
    #[arg(long)]
    pub(crate) recreate: bool,
}

#[derive(Args)]
pub(crate) struct Consenting {
    /// Write without asking.
    #[arg(long)]
    pub(crate) yes: bool,
    /// Write although the device counts as worn, or the logbook cannot tell its write cycles.
    #[arg(long)]
    pub(crate) force_wear: bool,
}

#[derive(Args)]
pub(crate) struct Write {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// What to write, by its name.
    ///
    /// hiperface: field:N, field:N@ADDR+COUNT (without +COUNT as many bytes as are given), status:N, counter (to 0),
    /// address, settings.
    ///
    /// biss: 0x24:0x10 (bank 24h, offset 10h), 0x24:0x10+4 (a run of four), 0x40 to 0x7F (direct). Registers that a procedure
    /// writes (filter, preset, calibration) are changed with "do biss …".
    ///
    /// interbus: what read has but for what is measured; a preset is stored and not fired.
    ///
    /// hiperdrive: a parameter that can be written, as read has it; it is saved where it can be. 101 to 104 move a drive and are
    /// never written; 47 and 198 are "do hiperdrive save", "set-position" and others.
    pub(crate) item: String,
    /// A number (decimal or 0x); hex bytes for a data field and for a run of registers (+COUNT); interbus: cw or ccw for the
    /// direction, START..STOP for a cam.
    #[arg(allow_hyphen_values = true)]
    pub(crate) value: String,
    #[command(flatten)]
    pub(crate) consent: Consenting,
    #[command(flatten)]
    pub(crate) of: OfDrive,
}

#[derive(Args)]
pub(crate) struct Simulate {
    /// The kind of device.
    pub(super) device: DeviceKind,
    /// Make a pseudo-terminal and a symbolic link to it here.
    #[arg(long, value_name = "PATH", conflicts_with = "listen")]
    pub(crate) pty: Option<PathBuf>,
    /// Listen at HOST:PORT; hiperdrive over TCP and over UDP.
    #[arg(long, value_name = "ADDR")]
    pub(super) listen: Option<String>,
    /// hiperdrive: a hub with so many places for drives instead of an adapter.
    #[arg(long, value_name = "PLACES", value_parser = ["4", "8"])]
    pub(super) hub: Option<String>,
    /// biss: be an adapter in front of the encoder, which speaks the bridge protocol, instead of its UBICOM line.
    #[arg(long)]
    pub(crate) bridge: bool,
    /// ssi: the encoder behind the adapter, a profile or a family with its settings (help ssi decode says which); without
    /// it atm60,code=gray.
    #[arg(long, value_name = "FILE|SPEC")]
    pub(crate) layout: Option<String>,
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
pub(crate) struct Code {
    pub(crate) number: CodeNumber,
    pub(crate) code: AccessCode,
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

/// An access code: one or two hex digits, with or without `0x` or a final `h`.
pub(crate) fn parse_code(text: &str) -> Option<AccessCode> {
    match crate::bits::parse_hex(text.trim()).ok()?.as_slice() {
        [byte] => Some(AccessCode::new(*byte)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use clap::{Arg, CommandFactory};

    use super::Arguments;

    /// Commands, options and the values they take, without their descriptions: scripts rely on them. With
    /// `ENCODER_STUDIO_RECORD=1` the recording is written anew.
    #[test]
    fn commands_and_options_are_as_recorded() {
        let mut text = String::new();
        list(&mut text, "encoder-studio", &Arguments::command());
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/cli/options.txt");
        if std::env::var_os("ENCODER_STUDIO_RECORD").is_some() {
            std::fs::write(path, &text).unwrap();
        }
        let recorded = std::fs::read_to_string(path).unwrap();
        for (is, was) in text.lines().zip(recorded.lines()) {
            assert_eq!(is, was);
        }
        assert_eq!(text, recorded);
    }

    fn list(text: &mut String, path: &str, command: &clap::Command) {
        let _ = writeln!(text, "{path}");
        let arguments: Vec<&Arg> = command.get_arguments().collect();
        for arg in arguments {
            let name = match (arg.get_long(), arg.get_short()) {
                (Some(long), Some(short)) => format!("-{short}, --{long}"),
                (Some(long), None) => format!("--{long}"),
                (None, Some(short)) => format!("-{short}"),
                (None, None) => format!("<{}>", arg.get_id()),
            };
            let _ = write!(text, "  {name} {:?}", arg.get_action());
            for (word, is) in [("global", arg.is_global_set()), ("required", arg.is_required_set())] {
                let _ = write!(text, "{}", if is { format!(" {word}") } else { String::new() });
            }
            for value in arg.get_possible_values() {
                let _ = write!(text, " {}", value.get_name());
            }
            let _ = writeln!(text);
        }
        for own in command.get_subcommands() {
            list(text, &format!("{path} {}", own.get_name()), own);
        }
    }
}
