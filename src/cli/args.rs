//! The arguments of the command line, for any kind of device.

mod act;
pub(crate) mod build;
mod decode;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

pub use act::Do;
pub(super) use build::{Arguments, Called, parse_arguments};
pub use decode::Decode;
pub(crate) use decode::{Direction, DirectionOption};

use super::Failure;
use super::commands::{Commands, OwnOptions};
use crate::app::Given;
use crate::link::LinkUrl;

/// Configure position encoders at a desk: read, compare, write, verify, save and restore. Without a command it opens the
/// window.
#[derive(Parser)]
#[command(name = "encoder-studio", version)]
struct Front {
    #[command(flatten)]
    common: Common,
    /// A profile to open in the window.
    #[arg(long, value_name = "FILE")]
    profile: Option<PathBuf>,
}

#[derive(Args)]
pub struct Common {
    /// The link to the device: sim:, serial:PATH, tcp:HOST:PORT, modbus:HOST:PORT, enip:HOST, bridge:PATH,
    /// bridge:tcp:HOST:PORT or replay:FILE, with ?name=value&…
    #[arg(long, global = true, value_name = "URL")]
    pub(crate) link: Option<LinkUrl>,
    /// Print JSON.
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// On a serial line with one master: no drive or controller is connected to it or powered. Without this it is asked on
    /// a terminal; find needs it elsewhere.
    #[arg(long, global = true)]
    pub(crate) only_master: bool,
    /// Record every frame into a file that replay: plays back; access codes are masked.
    #[arg(long, global = true, value_name = "FILE")]
    pub(super) trace: Option<PathBuf>,
    #[command(flatten)]
    pub(super) own: OwnOptions,
    /// The kinds of device that have options among these; parsing puts them here.
    #[arg(skip = Commands::NONE)]
    pub(super) commands: Commands,
}

impl Common {
    /// Returns the values of the options that kinds of device add.
    pub(super) fn given(&self) -> Result<Given, Failure> {
        self.commands.devices().iter().try_fold(Given::default(), |given, device| device.given(&self.own, given))
    }
}

/// A command that is the same word for every kind of device.
#[derive(Subcommand)]
pub enum Command {
    /// Serial ports on this machine.
    Ports,
    /// The devices that answer.
    Find(Find),
    /// Reads the identity of the device
    Identify(Device),
    /// Errors and warnings, decoded.
    Status(Status),
    /// The position.
    Position(Position),
    /// One value: a data field, a register, a setting.
    Read(Read),
    /// Read everything that can be restored, and what identifies the device.
    Save(Save),
    /// Compares field by field
    Diff(Diff),
    /// Read back and compare; changes nothing.
    Verify(Verify),
    /// Make the device as the profile says.
    Restore(Restore),
    /// Write one value.
    Write(Write),
    /// An action of a kind of device (help do lists them).
    Do(Do),
    /// Explain captured bytes, offline.
    Decode(Decode),
    /// Be a device, on a pseudo-terminal or a TCP port.
    Simulate(Simulate),
}

#[derive(Args)]
pub struct Device {
    /// The kind of device.
    pub(super) device: String,
    #[command(flatten)]
    pub(super) own: OwnOptions,
}

#[derive(Args)]
pub struct Find {
    /// The kind of device.
    pub(super) device: String,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Args)]
pub struct Status {
    /// The kind of device.
    pub(super) device: String,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Args)]
pub struct Position {
    /// The kind of device.
    pub(super) device: String,
    /// Number of lines; without it one, and with --csv as many as come until Ctrl-C.
    #[arg(long, allow_negative_numbers = true)]
    pub(super) count: Option<u64>,
    /// Print a table (CSV): a header once, then a line a reading.
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// Time between two readings in milliseconds; 0: as fast as the line allows.
    #[arg(long, default_value_t = 100, value_name = "MS", allow_negative_numbers = true)]
    pub(super) interval: u64,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Args)]
pub struct Read {
    /// The kind of device.
    pub(super) device: String,
    /// Name of the value to read
    pub(crate) item: String,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Args)]
pub struct Save {
    /// The kind of device.
    pub(super) device: String,
    /// The profile to write.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub file: PathBuf,
    /// Replace a file that exists without asking.
    #[arg(long)]
    pub(super) force: bool,
    /// Fail when a data field cannot be read because its access code is not known.
    #[arg(long)]
    pub(crate) complete: bool,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Args)]
pub struct Diff {
    /// A profile.
    pub(super) left: PathBuf,
    /// Another profile; without it, --link.
    pub(super) right: Option<PathBuf>,
}

#[derive(Args)]
pub struct Verify {
    /// The profile.
    pub file: PathBuf,
}

#[derive(Args)]
pub struct Restore {
    /// The profile.
    pub file: PathBuf,
    /// Print exactly the operations that would be carried out; write nothing.
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub consent: Consenting,
    /// The profile may be of another serial number of the same type.
    #[arg(long)]
    pub(crate) allow_other_device: bool,
    /// The profile may be of another type of device (--help says what that is).
    #[arg(long)]
    pub(crate) allow_other_type: bool,
    /// Copy the bytes of unknown meaning of this data field onto another serial number; repeatable.
    #[arg(long, value_name = "field:N")]
    pub(crate) copy: Vec<String>,
    /// Leave the bytes of unknown meaning of this data field as the device has them; repeatable.
    #[arg(long, value_name = "field:N")]
    pub(crate) leave: Vec<String>,
    /// Also restore values of the mounting onto another serial number.
    #[arg(long)]
    pub(crate) with_mounting: bool,
    /// Delete and create again where a field has another size and is not the last.
    #[arg(long)]
    pub(crate) recreate: bool,
}

#[derive(Args)]
pub struct Consenting {
    /// Write without asking.
    #[arg(long)]
    pub yes: bool,
    /// Write although the device counts as worn, or the logbook cannot tell its write cycles.
    #[arg(long)]
    pub force_wear: bool,
}

#[derive(Args)]
pub struct Write {
    /// The kind of device.
    pub(super) device: String,
    /// Name of the value to write
    pub(crate) item: String,
    /// A number (decimal or 0x); hex bytes for a data field and for a run of registers (+COUNT); a word or a range where the
    /// item takes one.
    #[arg(allow_hyphen_values = true)]
    pub(crate) value: String,
    #[command(flatten)]
    pub consent: Consenting,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}

#[derive(Args)]
pub struct Simulate {
    /// The kind of device.
    pub(super) device: String,
    /// Make a pseudo-terminal and a symbolic link to it here.
    #[arg(long, value_name = "PATH", conflicts_with = "listen")]
    pub(crate) pty: Option<PathBuf>,
    /// Listen at HOST:PORT, over TCP, and over UDP where the device takes datagrams.
    #[arg(long, value_name = "ADDR")]
    pub(super) listen: Option<String>,
    /// Be an adapter in front of the encoder, which speaks the bridge protocol, instead of the line of the encoder.
    #[arg(long)]
    pub(crate) bridge: bool,
    /// Seed of the faults.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// drop:P, flip:P, garbage:P, delay:MS, silent-after:N, die-in-store:N; comma separated.
    #[arg(long, value_name = "SPEC")]
    pub(super) fault: Option<String>,
    /// A property of the virtual device, as after sim:? (rpm=60, echo=on …); repeatable. One that there is not is answered
    /// with all that there are.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub(super) settings: Vec<String>,
    #[command(flatten)]
    pub(crate) own: OwnOptions,
}
