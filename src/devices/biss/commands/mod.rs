//! Commands for BiSS encoders.

mod act;
mod args;
mod decode;
mod inspect;
mod plan;
mod profiles;
mod register_text;
mod run;
mod write;

use std::time::Duration;

use clap::builder::PossibleValue;
use clap::{Arg, ValueEnum};

use self::args::{BissAction, DoOptions};
use crate::buses::bridge::sim as bridge;
use crate::buses::ubicom::protocol as ubicom;
use crate::cli::args::{Command, CommonArgs, SimulateArgs};
use crate::cli::commands::{CommandId, DeviceCommands, arg_list, enum_values};
use crate::cli::output::Output;
use crate::cli::simulate::{ServableDevice, settings};
use crate::cli::{Failure, Result};
use crate::devices::biss::profile::{ItemError, RegisterRange};
use crate::devices::biss::protocol::KIND;
use crate::devices::biss::sim;
use crate::kinds::attachable_kinds;
use crate::sim::ConfigError;
use crate::units::{CharacterFormat, Moment};

const OPERATOR_TIMEOUT: Duration = Duration::from_secs(30);

pub(crate) struct BissCommands;

impl DeviceCommands for BissCommands {
    fn name(&self) -> &'static str {
        KIND
    }

    fn description(&self) -> &'static str {
        "POSITAL kit encoder or other BiSS C encoder, over UBICOM (serial:, tcp:) or through an adapter (bridge:)"
    }

    fn command_help(&self, command: CommandId) -> Option<String> {
        let help = match command {
            CommandId::Read => {
                "items: 0x66 (direct register, 0x40 to 0x7F), 0x24:0x10 (bank 24h, offset 10h), 0x24:0x10+4 (four consecutive \
                 registers)"
            }
            CommandId::Write => {
                "items: 0x24:0x10 (bank 24h, offset 10h), 0x24:0x10+4 (four consecutive registers), 0x40 to 0x7F (direct). To \
                 change filter, preset or calibration, use \"do biss …\"."
            }
            CommandId::Restore => {
                "another type means another profile ID, manufacturer or device ID, or a different number of turn bits or step bits"
            }
            CommandId::Decode => {
                "UBICOM frames, bridge packets (to the final 00), position frames of the kit encoder (41 bits, right-justified: \
                 16 for turns, 17 for steps, error, warning, CRC-6; as one word of 11 hex digits or with 0x), and position words as \
                 \"position\" prints them (0x024698000, or raw=610893824 from JSON or a table)"
            }
            CommandId::Simulate => "serves UBICOM; for example --set firmware=1.2.0",
            _ => return None,
        };
        Some(help.to_owned())
    }

    fn options(&self, command: CommandId) -> Vec<Arg> {
        match command {
            CommandId::Do => arg_list::<DoOptions>(),
            _ => Vec::new(),
        }
    }

    fn action_values(&self) -> Vec<PossibleValue> {
        enum_values::<BissAction>().into_iter().filter(|action| !is_combined(action)).collect()
    }

    fn combined_actions(&self) -> Vec<PossibleValue> {
        enum_values::<BissAction>().into_iter().filter(is_combined).collect()
    }

    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result> {
        Some(match command {
            Command::Identify(_) => inspect::identify(common, output),
            Command::Status(_) => inspect::status(common, output),
            Command::Position(position) => inspect::position(common, output, position),
            Command::Read(read) => inspect::read(common, output, &read.item),
            Command::Save(save) => profiles::save(common, output, save),
            Command::Write(write) => write::write(common, output, write),
            Command::Do(act) => act::run_action(common, output, act),
            Command::Decode(decode) => decode::decode(output, &decode.hex),
            _ => return None,
        })
    }

    fn create_simulated(&self, output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
        create_simulated(output, arguments)
    }
}

fn is_combined(action: &PossibleValue) -> bool {
    BissAction::Mounting.to_possible_value().as_ref() == Some(action)
}

fn create_simulated(output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
    let settings = settings(output, arguments)?;
    let known = bridge::all_setting_names(attachable_kinds());
    let needs_adapter = |name: &str| known.contains(&name) && !sim::Config::KEYS.contains(&name);
    if let Some((name, _)) = settings.iter().find(|(name, _)| needs_adapter(name)).filter(|_| !arguments.bridge) {
        return Err(Failure::Usage(format!("{name} is a setting of the adapter and requires --bridge")));
    }
    let refused = |error: ConfigError| Failure::Usage(error.to_string());
    Ok(match arguments.bridge {
        true => Box::new(bridge::Adapter::from_pairs(&settings, attachable_kinds()).map_err(refused)?),
        false => Box::new(sim::UbicomPort::new(&sim::Config::from_pairs(&settings).map_err(refused)?)),
    })
}

impl ServableDevice for sim::UbicomPort {
    fn line_format(&self, _now: Moment) -> Option<CharacterFormat> {
        Some(ubicom::FORMAT)
    }
}

fn parse_item(text: &str) -> Result<RegisterRange> {
    text.parse().map_err(|error: ItemError| Failure::Usage(error.to_string()))
}
