//! Commands for HIPERFACE encoders.

mod act;
mod args;
mod codes;
mod decode;
mod inspect;
mod profiles;
mod run;
mod table;
mod write;

use clap::Arg;
use clap::builder::PossibleValue;

use self::args::{DoOptions, FindOptions, HiperfaceAction};
use self::codes::AccessCodeArgs;
use crate::app::TypeMap;
use crate::cli::args::{Command, CommonArgs, SimulateArgs};
use crate::cli::commands::{CommandId, DeviceCommands, KindOptions, arg_list, enum_values};
use crate::cli::output::Output;
use crate::cli::simulate::{ServableDevice, settings};
use crate::cli::{Failure, Result};
use crate::devices::hiperface::profile::Item;
use crate::devices::hiperface::protocol::{KIND, LineSettings};
use crate::devices::hiperface::sim::{Bus, Config};
use crate::units::{CharacterFormat, Moment};

pub(crate) struct HiperfaceCommands;

impl DeviceCommands for HiperfaceCommands {
    fn name(&self) -> &'static str {
        KIND
    }

    fn description(&self) -> &'static str {
        "HIPERFACE motor-feedback encoder"
    }

    fn command_help(&self, command: CommandId) -> Option<String> {
        let help = match command {
            CommandId::Find => "tries every address, baud rate and parity",
            CommandId::Status => "reads the whole error queue",
            CommandId::Read => {
                "items: field:N, field:N@ADDR+COUNT (without +COUNT, up to the end of the field), status:N, analogue:CH, counter, \
                 address, settings"
            }
            CommandId::Write => {
                "items: field:N, field:N@ADDR+COUNT (+COUNT is optional), status:N, counter (0 clears it), address, settings"
            }
            CommandId::Restore => "another type means another type byte",
            CommandId::Simulate => "for example --set model=sel37",
            _ => return None,
        };
        Some(help.to_owned())
    }

    fn options(&self, command: CommandId) -> Vec<Arg> {
        match command {
            CommandId::Find => arg_list::<FindOptions>(),
            CommandId::Do => arg_list::<DoOptions>(),
            _ => Vec::new(),
        }
    }

    fn common_options(&self) -> Vec<Arg> {
        arg_list::<AccessCodeArgs>()
    }

    fn add_given(&self, options: &KindOptions, given: TypeMap) -> Result<TypeMap> {
        Ok(given.with_value(codes::collect_access_codes(&options.read()?)?))
    }

    fn refused_option(&self, option: &str) -> Option<String> {
        let why = match option {
            "--code" => "is only for devices with access codes, which this device does not have",
            "--only-master" => "is only for hiperface, where a line has only one master",
            _ => return None,
        };
        Some(format!("{option} {why}"))
    }

    fn action_values(&self) -> Vec<PossibleValue> {
        enum_values::<HiperfaceAction>()
    }

    fn is_searchable(&self) -> bool {
        true
    }

    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result> {
        Some(match command {
            Command::Find(find) => inspect::find(common, output, find),
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

fn create_simulated(output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
    if arguments.bridge {
        return Err(Failure::Usage("--bridge is for biss: hiperface uses a serial port".to_owned()));
    }
    let config =
        Config::from_pairs(&settings(output, arguments)?).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Box::new(Bus::new(&config)))
}

impl ServableDevice for Bus {
    fn line_format(&self, now: Moment) -> Option<CharacterFormat> {
        self.encoder(0).and_then(|encoder| encoder.active_settings_at(now)).and_then(LineSettings::character_format)
    }
}

fn parse_item(text: &str) -> Result<Item> {
    text.parse().map_err(|error: crate::devices::hiperface::profile::ItemError| Failure::Usage(error.to_string()))
}
