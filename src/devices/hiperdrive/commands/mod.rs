//! Commands for HIPERDRIVE drives behind an adapter or a hub. Words and packets can also be decoded without a device.

mod act;
mod args;
mod decode;
mod find;
mod image;
mod inspect;
mod meaning;
mod r#move;
mod plan;
mod position;
mod profiles;
mod run;
mod simulate;
mod write;

use clap::builder::PossibleValue;
use clap::{Arg, ArgMatches, Args};

use self::args::{DoOptions, DriveOption, HiperdriveAction, HubOption, MoveArgs, WordOptions};
use crate::cli::args::{Command, CommonArgs, SimulateArgs};
use crate::cli::commands::{CliCommand, CommandId, DeviceCommands, arg_list, enum_values, parse};
use crate::cli::output::Output;
use crate::cli::simulate::ServableDevice;
use crate::cli::{Failure, Result};
use crate::devices::hiperdrive::profile::{Item, ItemError};
use crate::devices::hiperdrive::protocol::{KIND, PARAMETERS};
use crate::devices::hiperdrive::state::TEXTS;

pub(crate) struct HiperdriveCommands;

impl DeviceCommands for HiperdriveCommands {
    fn name(&self) -> &'static str {
        KIND
    }

    fn description(&self) -> &'static str {
        "HIPERDRIVE with EtherNet/IP (enip:): one drive behind an adapter, or up to eight behind a hub"
    }

    fn command_help(&self, command: CommandId) -> Option<String> {
        let help = match command {
            CommandId::Find => "searches the network for adapters and hubs",
            CommandId::Read => {
                let items =
                    "items: parameter numbers, such as 17 or 158; for drive 2 of a hub, use 258, or 158 with --drive 2";
                return Some(format!("{items}.\n\n{}", parameter_list_help()));
            }
            CommandId::Write => {
                "items: writable parameters, numbered as for read; the value is saved if the drive can store it. 101 to 104 move \
                 a drive and are never written. 47, 197 (with 0) and 198 do the same as save, acknowledge and set-position of \
                 \"do hiperdrive\"; 199 resets a drive and is not written."
            }
            CommandId::Restore => {
                "another type means another category (adapter, 4-port hub, 8-port hub), or another drive variant at a port"
            }
            CommandId::Decode => {
                "control and status words, 4 hex digits each (0439); process data as sent (8, 16, 32, 40, 64 or 72 \
                 bytes); parameter words (8 bytes); EtherNet/IP packets with their parameters"
            }
            CommandId::Simulate => "--listen serves TCP and UDP",
            _ => return None,
        };
        Some(help.to_owned())
    }

    fn options(&self, command: CommandId) -> Vec<Arg> {
        match command {
            CommandId::Status | CommandId::Position | CommandId::Read | CommandId::Write => arg_list::<DriveOption>(),
            CommandId::Do => arg_list::<DoOptions>(),
            CommandId::Decode => arg_list::<WordOptions>(),
            _ => Vec::new(),
        }
    }

    fn action_values(&self) -> Vec<PossibleValue> {
        enum_values::<HiperdriveAction>()
    }

    fn setting_options(&self) -> Vec<Arg> {
        arg_list::<HubOption>()
    }

    fn extra_commands(&self) -> &'static [&'static dyn CliCommand] {
        &[&MoveCommand]
    }

    fn is_searchable(&self) -> bool {
        true
    }

    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result> {
        Some(match command {
            Command::Find(_) => find::find(common, output),
            Command::Identify(_) => inspect::identify(common, output),
            Command::Status(status) => inspect::status(common, output, status),
            Command::Position(position) => position::position(common, output, position),
            Command::Read(read) => inspect::read(common, output, read),
            Command::Save(save) => profiles::save(common, output, save),
            Command::Write(write) => write::write(common, output, write),
            Command::Do(act) => act::run_action(common, output, act),
            Command::Decode(decode) => decode::decode(output, decode),
            _ => return None,
        })
    }

    fn create_simulated(&self, output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
        simulate::create_simulated(output, arguments)
    }
}

struct MoveCommand;

impl CliCommand for MoveCommand {
    fn command(&self) -> clap::Command {
        MoveArgs::augment_args(clap::Command::new("move"))
            .about("hiperdrive: move a drive to a position, then switch the drive off. Ctrl-C stops the motion")
    }

    fn run(&self, common: &CommonArgs, output: &Output, matches: &ArgMatches) -> Result {
        r#move::execute_move(common, output, &parse(matches)?)
    }
}

/// Returns the help text that lists all parameters with their numbers, one per line.
fn parameter_list_help() -> String {
    let mut text = "\
HIPERDRIVE parameters (below 100: device, from 101: drive 1, from 201: drive 2, and so on up to drive 8):
"
    .to_owned();
    for row in PARAMETERS {
        let unit = if row.unit.is_empty() { String::new() } else { format!(", {}", row.unit) };
        text.push_str(&format!("  {:3}  {}{unit}\n", row.number, row.name));
    }
    text
}

/// Parses a parameter given by the user.
fn parse_item(text: &str, of: &DriveOption) -> Result<Item> {
    let item = text.parse::<Item>().and_then(|item| match (of.drive, Item::parse_number(text)) {
        (Some(drive), Some(number)) => Item::new(number, Some(drive)),
        (Some(drive), None) if item.0.drive().map(|own| own.get()) != Some(drive) => {
            Err(ItemError::NoDrive { number: item.0.drive1_number(), drive })
        }
        _ => Ok(item),
    });
    item.map_err(|error| {
        Failure::Usage(match error {
            ItemError::NoParameter(number) => TEXTS.text("hd_said.unknown").with("number", number).terminal_text(),
            error => error.to_string(),
        })
    })
}
