//! Command line arguments for any kind of device.

mod act;
mod build;
mod decode;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use jiff::Timestamp;

pub use act::ActionArgs;
pub use build::command;
pub(super) use build::{Arguments, ParsedCommand, parse_arguments};
pub use decode::DecodeArgs;
pub(crate) use decode::{Direction, DirectionOption};

use super::Failure;
use super::commands::{Commands, KindOptions};
use super::undo::UndoneEntry;
use crate::app::TypeMap;
use crate::link::LinkUrl;
use crate::store::{AssetName, EntryId, EntryUid, LogbookServer};
use crate::worker::SessionLog;

/// Help heading of the options that every command has.
const COMMON_HEADING: &str = "Common options";

/// Configure position encoders and small drives: read, compare, write, verify, save and restore. Without a command, the
/// window opens.
#[derive(Parser)]
#[command(name = "encoder-studio", version)]
struct Cli {
    /// Open this profile in the window.
    #[arg(long, value_name = "FILE")]
    profile: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

#[derive(Args)]
#[command(next_help_heading = COMMON_HEADING)]
pub struct CommonArgs {
    /// Link to the device: sim:, serial:PATH, tcp:HOST:PORT, modbus:HOST:PORT, enip:HOST, bridge:PATH,
    /// bridge:tcp:HOST:PORT or replay:FILE, followed by ?name=value&… for parameters.
    #[arg(long, global = true, value_name = "URL")]
    pub(crate) link: Option<LinkUrl>,
    /// Print JSON.
    #[arg(long, global = true)]
    pub(super) json: bool,
    /// Confirm that no drive or controller on the serial line is powered. Without this option, you are asked on a
    /// terminal; find requires this option if there is no terminal.
    #[arg(long, global = true)]
    pub(crate) only_master: bool,
    /// Record every frame in a file that can be opened with replay:FILE. Access codes are masked.
    #[arg(long, global = true, value_name = "FILE")]
    pub(super) trace: Option<PathBuf>,
    #[command(flatten)]
    pub(super) own: KindOptions,
    /// Commands of all kinds of device. Set by the argument parser.
    #[arg(skip = Commands::NONE)]
    pub(super) commands: Commands,
    /// Log to which the command adds its logbook entries. The command's session shares this log.
    #[arg(skip)]
    pub(super) log: SessionLog,
    /// Server through which the logbook is shared.
    #[arg(skip)]
    pub(super) server: LogbookServer,
}

impl CommonArgs {
    /// Returns the values given for the options that the kinds of device add.
    pub(super) fn kind_option_values(&self) -> Result<TypeMap, Failure> {
        self.commands.devices().iter().try_fold(TypeMap::default(), |given, device| device.add_given(&self.own, given))
    }
}

// A command that every kind of device has. No doc comment: clap would take it for the program's description.
#[derive(Subcommand)]
pub enum Command {
    /// List the serial ports of this computer.
    Ports,
    /// Search for devices.
    Find(FindArgs),
    /// Read the identity of a device.
    Identify(Device),
    /// Read and explain errors and warnings.
    Status(Status),
    /// Read the position, once or repeatedly.
    Position(Position),
    /// Read one value: a data field, a register or a parameter.
    Read(Read),
    /// Save all restorable values in a profile.
    Save(SaveArgs),
    /// Write a report of a profile, a device or a capture: all values with their meaning, the history in the logbook, and the
    /// differences to a profile. A device is read in the same way as by save.
    Report(ReportArgs),
    /// Compare two profiles, or a profile with a device.
    Diff(DiffArgs),
    /// Compare a device with a profile; exit status 3 if they differ.
    Verify(VerifyArgs),
    /// Write a profile to a device. Only values that differ are written.
    Restore(Restore),
    /// Write one value after showing the old and the new one.
    Write(Write),
    /// Carry out a device-specific action. The actions are listed by help do.
    Do(ActionArgs),
    /// Explain captured bytes without a device.
    Decode(DecodeArgs),
    /// Print the logbook, newest entry first: connections, writes, status codes read, saved profiles and device checks.
    Log(LogArgs),
    /// Undo a write recorded in the logbook, as far as possible: read, compare, and restore the previous values.
    Undo(UndoArgs),
    /// Serve a virtual device on a pseudo-terminal or a TCP port.
    Simulate(SimulateArgs),
}

#[derive(Args)]
pub struct Device {
    /// Kind of device.
    pub(super) device: String,
    #[command(flatten)]
    pub(super) own: KindOptions,
}

impl Command {
    /// Returns the asset to which the command assigns the device.
    pub(super) fn asset(&self) -> Option<&AssetName> {
        match self {
            Command::Save(save) => save.asset.name.as_ref(),
            Command::Restore(restore) => restore.asset.name.as_ref().filter(|_| !restore.dry_run),
            Command::Write(write) => write.asset.name.as_ref(),
            Command::Do(act) => act.asset.name.as_ref(),
            Command::Report(report) => report.asset.as_ref(),
            _ => None,
        }
    }
}

/// Option of the commands that assign a device to an asset.
#[derive(Args)]
pub(crate) struct AssetArgs {
    /// Assign the device to an asset: the motor or the axis on which it is mounted. The assignment remains in effect
    /// until the next one. log --asset prints the entries of the asset.
    #[arg(long = "asset", value_name = "NAME")]
    pub(super) name: Option<AssetName>,
}

#[derive(Args)]
pub struct FindArgs {
    /// Kind of device.
    pub(super) device: String,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

#[derive(Args)]
pub struct Status {
    /// Kind of device.
    pub(super) device: String,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

#[derive(Args)]
pub struct Position {
    /// Kind of device.
    pub(super) device: String,
    /// Number of readings. Default: 1; with --csv, until Ctrl-C.
    #[arg(long, allow_negative_numbers = true)]
    pub(super) count: Option<u64>,
    /// Print CSV: a header, then one line per reading.
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// Time between two readings in milliseconds; with 0, readings follow as fast as the link allows.
    #[arg(long, default_value_t = 100, value_name = "MS", allow_negative_numbers = true)]
    pub(super) interval: u64,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

#[derive(Args)]
pub struct Read {
    /// Kind of device.
    pub(super) device: String,
    /// Name of the value to read
    pub(crate) item: String,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

#[derive(Args)]
pub struct SaveArgs {
    /// Kind of device.
    pub(super) device: String,
    /// Profile to write.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub file: PathBuf,
    /// Replace an existing file without asking.
    #[arg(long)]
    pub(super) force: bool,
    /// Fail if a data field cannot be read because its access code is unknown.
    #[arg(long)]
    pub(crate) complete: bool,
    #[command(flatten)]
    pub(super) asset: AssetArgs,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

#[derive(Args)]
pub struct ReportArgs {
    /// Profile or capture (.csv) to read, or log:ENTRY for the values before a write of the logbook. With --link, the
    /// kind of device.
    #[arg(value_name = "FILE|DEVICE")]
    pub(crate) subject: PathBuf,
    /// Report to write: .html or .pdf.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(super) file: PathBuf,
    /// Replace an existing file without asking.
    #[arg(long)]
    pub(super) force: bool,
    /// Language of the report.
    #[arg(long, value_enum, default_value_t = ReportLanguage::En)]
    pub(super) language: ReportLanguage,
    /// List the differences to this profile, or to log:ENTRY.
    #[arg(long, value_name = "FILE")]
    pub(super) compare: Option<PathBuf>,
    /// Asset to name in the report. With --link, the device is assigned to it. Default: the asset of the device in the
    /// logbook.
    #[arg(long, value_name = "NAME")]
    pub(crate) asset: Option<AssetName>,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

/// Languages of reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ReportLanguage {
    /// English.
    En,
    /// German.
    De,
}

#[derive(Args)]
pub struct DiffArgs {
    /// Profile to compare, or log:ENTRY for the values before a write recorded in the logbook.
    pub(super) left: PathBuf,
    /// Second profile or log:ENTRY. Default: the device at --link.
    pub(super) right: Option<PathBuf>,
}

#[derive(Args)]
pub struct VerifyArgs {
    /// Profile to read.
    pub file: PathBuf,
}

#[derive(Args)]
pub struct Restore {
    /// Profile to read.
    pub file: PathBuf,
    /// Print the operations that would be carried out, without writing anything.
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub consent: ConsentArgs,
    /// Accept a profile from a device of the same type with another serial number.
    #[arg(long)]
    pub(crate) allow_other_device: bool,
    /// Accept a profile from another type of device; the end of --help explains what counts as one.
    #[arg(long)]
    pub(crate) allow_other_type: bool,
    /// Copy this data field of unknown meaning to a device with another serial number; repeatable.
    #[arg(long, value_name = "field:N")]
    pub(crate) copy: Vec<String>,
    /// Leave this data field of unknown meaning unchanged in the device; repeatable.
    #[arg(long, value_name = "field:N")]
    pub(crate) leave: Vec<String>,
    /// Also restore the values that depend on the mounting to a device with another serial number.
    #[arg(long)]
    pub(crate) with_mounting: bool,
    /// Delete and re-create a data field of a different size even if it is not the last one.
    #[arg(long)]
    pub(crate) recreate: bool,
    #[command(flatten)]
    pub(super) asset: AssetArgs,
    /// The write that the restore undoes. Set by the command undo.
    #[arg(skip)]
    pub(super) undone: Option<Box<UndoneEntry>>,
}

impl Restore {
    /// Creates a restore that undoes a write by means of its backup. It never accepts a different device.
    pub(super) fn from_backup(file: PathBuf, undo: &UndoArgs, undone: UndoneEntry) -> Self {
        Restore {
            file,
            dry_run: undo.dry_run,
            consent: ConsentArgs { undoes: Some(undone.uid().clone()), ..undo.consent },
            allow_other_device: false,
            allow_other_type: false,
            copy: Vec::new(),
            leave: Vec::new(),
            with_mounting: false,
            recreate: false,
            asset: AssetArgs { name: None },
            undone: Some(Box::new(undone)),
        }
    }
}

#[derive(Args)]
pub struct UndoArgs {
    /// Number of the entry, as printed by log.
    #[arg(value_parser = super::log::parse_entry)]
    pub(super) entry: EntryId,
    /// Print the operations that would be carried out, without writing anything.
    #[arg(long)]
    pub(super) dry_run: bool,
    #[command(flatten)]
    pub(super) consent: ConsentArgs,
}

#[derive(Args)]
pub struct ConsentArgs {
    /// Write without asking.
    #[arg(long)]
    pub yes: bool,
    /// Write even if the limit of write cycles is reached or their number is unknown.
    #[arg(long)]
    pub force_wear: bool,
    /// The entry of the logbook that the write undoes. Set by the command undo.
    #[arg(skip)]
    pub(super) undoes: Option<EntryUid>,
}

#[derive(Args)]
pub struct LogArgs {
    /// Print only entries for this kind of device.
    #[arg(long)]
    pub(super) device: Option<String>,
    /// Print only entries for the device with this serial number.
    #[arg(long, value_name = "SN")]
    pub(super) serial_number: Option<String>,
    /// Print only entries for this asset: those of each device while it was assigned to the asset.
    #[arg(long, value_name = "NAME")]
    pub(super) asset: Option<AssetName>,
    /// Print only entries since a date, such as 2026-11-27, or a time, such as 2026-11-27T14:30:00+01:00.
    #[arg(long, value_name = "DATE", value_parser = super::log::parse_date)]
    pub(super) since: Option<Timestamp>,
    /// Print only entries that contain this text.
    #[arg(long, value_name = "TEXT")]
    pub(super) search: Option<String>,
    /// Maximum number of entries to print.
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub(super) limit: u32,
}

#[derive(Args)]
pub struct Write {
    /// Kind of device.
    pub(super) device: String,
    /// Name of the value to write
    pub(crate) item: String,
    /// Number (decimal, or hexadecimal with 0x), hexadecimal bytes for a data field or consecutive registers (+COUNT),
    /// or a word or a range if the item accepts one.
    #[arg(allow_hyphen_values = true)]
    pub(crate) value: String,
    #[command(flatten)]
    pub consent: ConsentArgs,
    #[command(flatten)]
    pub(super) asset: AssetArgs,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}

#[derive(Args)]
pub struct SimulateArgs {
    /// Kind of device.
    pub(super) device: String,
    /// Serve on a pseudo-terminal, and create a symbolic link to it at PATH.
    #[arg(long, value_name = "PATH", conflicts_with = "listen")]
    pub(crate) pty: Option<PathBuf>,
    /// Listen on HOST:PORT, over TCP and, if the device uses it, UDP.
    #[arg(long, value_name = "ADDR")]
    pub(super) listen: Option<String>,
    /// Serve the encoder behind an adapter that speaks the bridge protocol.
    #[arg(long)]
    pub(crate) bridge: bool,
    /// Seed for the random faults.
    #[arg(long)]
    pub(super) seed: Option<u64>,
    /// Faults to inject, separated by commas: drop:P, flip:P, garbage:P, delay:MS, silent-after:N, die-in-store:N.
    #[arg(long, value_name = "SPEC")]
    pub(super) fault: Option<String>,
    /// Setting of the virtual device, as in sim:?rpm=60&echo=on; repeatable. An unknown name lists all settings.
    #[arg(long = "set", value_name = "NAME=VALUE")]
    pub(super) settings: Vec<String>,
    #[command(flatten)]
    pub(crate) own: KindOptions,
}
