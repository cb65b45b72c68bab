//! Command names for display.

use crate::app::Text;
use crate::devices::hiperface::protocol::Command;
use crate::devices::hiperface::state::TEXTS;

pub fn command_text(command: Command) -> Text {
    TEXTS.text(match command {
        Command::ReadPosition => "command.read_position",
        Command::SetPosition => "command.set_position",
        Command::ReadAnalogue => "command.read_analogue",
        Command::ReadCounter => "command.read_counter",
        Command::IncrementCounter => "command.increment_counter",
        Command::ClearCounter => "command.clear_counter",
        Command::ReadData => "command.read_data",
        Command::StoreData => "command.store_data",
        Command::FieldStatus => "command.field_status",
        Command::DefineField => "command.define_field",
        Command::FreeMemory => "command.free_memory",
        Command::ChangeCode => "command.change_code",
        Command::ReadStatus => "command.read_status",
        Command::ReadTypeLabel => "command.read_type_label",
        Command::Reset => "command.reset",
        Command::SetAddress => "command.set_address",
        Command::ReadSerial => "command.read_serial",
        Command::ConfigureLine => "command.configure_line",
        Command::Synchronise => "command.synchronise",
        Command::ConfigureLineTemporarily => "command.configure_line_temporarily",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::devices::hiperface::protocol::COMMANDS;

    #[test]
    fn commands_use_protocol_names() {
        for row in COMMANDS {
            assert_eq!(command_text(row.command).to_string_in(Language::English), row.name);
            assert_ne!(command_text(row.command).to_string_in(Language::German), row.name);
        }
    }
}
