//! Commands for INTERBUS encoders behind a gateway, and offline explanations of process data words.

mod act;
mod args;
mod decode;
mod inspect;
mod meaning;
mod plan;
mod position;
mod profiles;
mod run;
mod simulate;
mod value;
mod write;

use clap::Arg;
use clap::builder::PossibleValue;

use self::args::{InterbusAction, WordOptions};
use crate::cli::args::{Command, CommonArgs, ConsentArgs, SimulateArgs};
use crate::cli::commands::{CommandId, DeviceCommands, arg_list, enum_values};
use crate::cli::consent::{ask_yes_no, can_prompt};
use crate::cli::output::Output;
use crate::cli::simulate::ServableDevice;
use crate::cli::{Failure, Result};
use crate::devices::interbus::profile::{Item, ItemError};
use crate::devices::interbus::protocol::KIND;
use crate::devices::interbus::state::TEXTS;
use crate::link::LinkScheme;

pub(crate) struct InterbusCommands;

/// Warning in the help of commands that read cam programs. The encoder stores the cams of a program when it leaves the
/// program (manual 5.4.4).
const CAM_READING_WARNING: &str = "reading cam programs selects them one after the other, which switches the live outputs of \
                        the encoder. On a terminal the command first asks whether the machine stands still; without \
                        a terminal it prints a note to stderr and continues. Each program that is read may cost one \
                        EEPROM write cycle, which is counted in the logbook.";

impl DeviceCommands for InterbusCommands {
    fn name(&self) -> &'static str {
        KIND
    }

    fn description(&self) -> &'static str {
        "INTERBUS encoder (K3) behind a Modbus/TCP gateway (modbus:); decode also explains words of K1 and K2"
    }

    fn help_note(&self) -> Option<&'static str> {
        Some("Reading a value of an INTERBUS encoder briefly replaces its position in the process data.")
    }

    fn command_help(&self, command: CommandId) -> Option<String> {
        let help = match command {
            CommandId::Read => {
                let items = "items: steps, revolutions, direction, preset, zero-shift, shift, cam:P:C (program 1 to 8, cam 0 to 7), \
                             cam-mask:P, temperature, operating-time";
                return Some(format!("{items}; {CAM_READING_WARNING}"));
            }
            CommandId::Save | CommandId::Diff | CommandId::Verify | CommandId::Report => CAM_READING_WARNING,
            CommandId::Write => {
                "items: as for read, except measured values; the direction is cw or ccw, and a cam is START..STOP. A preset is \
                 stored but not activated."
            }
            CommandId::Restore => {
                "another type means singleturn instead of multiturn, or a number of steps coded as N - 1"
            }
            CommandId::Decode => {
                "words of the process data, 8 hex digits each (a K2 word as a K3 position), or 4 for K1. Every possible meaning \
                 is printed; --direction and --mode select one."
            }
            _ => return None,
        };
        Some(help.to_owned())
    }

    fn options(&self, command: CommandId) -> Vec<Arg> {
        match command {
            CommandId::Decode => arg_list::<WordOptions>(),
            _ => Vec::new(),
        }
    }

    fn action_values(&self) -> Vec<PossibleValue> {
        enum_values::<InterbusAction>()
    }

    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result> {
        Some(match command {
            Command::Identify(_) => inspect::identify(common, output),
            Command::Status(_) => inspect::status(common, output),
            Command::Position(position) => position::position(common, output, position),
            Command::Read(read) => inspect::read(common, output, &read.item),
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

/// Parses an item name. The error for a nonexistent program or cam states the valid range.
fn parse_item(text: &str) -> Result<Item> {
    text.parse().map_err(|error: ItemError| match error {
        ItemError::Unknown(_) => Failure::Usage(error.to_string()),
        ItemError::Program { .. } | ItemError::Cam { .. } => Failure::Failed(vec![format!("{text}: {error}.")]),
    })
}

/// How much a command disturbs the process data that a connected machine uses.
#[derive(Clone, Copy)]
enum DisturbanceLevel {
    Reading,
    /// All cam programs are selected one after the other.
    Programs,
    /// The encoder returns to operation from a state in which another program left it, and stores the values set there.
    RestoringMode,
}

impl DisturbanceLevel {
    /// Prints the effect of a command before it begins. A command that switches live outputs must be confirmed on the
    /// terminal. No confirmation is needed for a virtual encoder, for an approved write, or without a terminal.
    fn confirm_start(self, common: &CommonArgs, output: &Output, consent: Option<&ConsentArgs>) -> Result<()> {
        self.print_effect(output);
        let is_virtual = common.link.as_ref().is_some_and(|link| link.scheme == LinkScheme::Sim);
        let consented = consent.is_some_and(|consent| consent.yes);
        if !matches!(self, DisturbanceLevel::Programs) || is_virtual || consented || !can_prompt() {
            return Ok(());
        }
        if ask_yes_no("Does the machine stand still? [y/N] ") {
            return Ok(());
        }
        Err(Failure::Failed(vec!["Not confirmed; no cam program was selected.".to_owned()]))
    }

    fn print_effect(self, output: &Output) {
        let id = match self {
            DisturbanceLevel::Reading => "ib_disturbs.reading",
            DisturbanceLevel::Programs => "ib_disturbs.programs",
            DisturbanceLevel::RestoringMode => "ib_disturbs.lead_back",
        };
        output.print_message(&TEXTS.text(id).terminal_text());
    }
}
