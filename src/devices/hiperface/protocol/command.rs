//! The twenty HIPERFACE commands (manual, "Übersicht der Commands").

use std::time::Duration;

/// Command byte without the error bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
#[expect(missing_docs, reason = "the name in the table below is the documentation")]
pub enum Command {
    ReadPosition = 0x42,
    SetPosition = 0x43,
    ReadAnalogue = 0x44,
    ReadCounter = 0x46,
    IncrementCounter = 0x47,
    ClearCounter = 0x49,
    ReadData = 0x4A,
    StoreData = 0x4B,
    FieldStatus = 0x4C,
    DefineField = 0x4D,
    FreeMemory = 0x4E,
    ChangeCode = 0x4F,
    ReadStatus = 0x50,
    ReadTypeLabel = 0x52,
    Reset = 0x53,
    SetAddress = 0x55,
    ReadSerial = 0x56,
    ConfigureLine = 0x57,
    Synchronise = 0x63,
    ConfigureLineTemporarily = 0x67,
}

/// Row of the manual's command table.
#[derive(Clone, Copy, Debug)]
pub struct CommandRow {
    /// The command.
    pub command: Command,
    /// Name in the manual.
    pub name: &'static str,
    /// Whether access code 0 is required.
    pub code0: bool,
    /// Maximum processing time, excluding the transfer and the protocol time-out. It is zero if the command has no
    /// reply.
    pub max_time: Duration,
    /// Number of bytes between the command byte and the checksum of the request. For command 4Bh, this is the minimum.
    pub request_payload: usize,
    /// Whether the command changes non-volatile data.
    pub persistent: bool,
}

const fn row(
    command: Command,
    name: &'static str,
    code0: bool,
    max_ms: u64,
    request_payload: usize,
    persistent: bool,
) -> CommandRow {
    CommandRow { command, name, code0, max_time: Duration::from_millis(max_ms), request_payload, persistent }
}

/// Command table in the order of the manual. The times are the manual's "maximale Antwortzeit".
#[rustfmt::skip]
pub const COMMANDS: [CommandRow; 20] = [
    //                                      name                                code0  ms  payload persistent
    row(Command::ReadPosition,              "read position",                    false,  10, 0, false),
    row(Command::SetPosition,               "set position",                     true,   40, 5, true),
    row(Command::ReadAnalogue,              "read analogue value",              false,   5, 1, false),
    row(Command::ReadCounter,               "read counter",                     false,   5, 0, false),
    row(Command::IncrementCounter,          "increment counter",                false,  30, 0, true),
    row(Command::ClearCounter,              "clear counter",                    true,   30, 1, true),
    row(Command::ReadData,                  "read data",                        false,  30, 4, false),
    row(Command::StoreData,                 "store data",                       false, 250, 5, true),
    row(Command::FieldStatus,               "read data field status",           false,   5, 1, false),
    row(Command::DefineField,               "create, change or delete a data field", false, 70, 3, true),
    row(Command::FreeMemory,                "read available memory",            false,   5, 0, false),
    row(Command::ChangeCode,                "change access code",               false,  40, 3, true),
    row(Command::ReadStatus,                "read encoder status",              false,   5, 0, false),
    row(Command::ReadTypeLabel,             "read type label",                  false,   5, 0, false),
    row(Command::Reset,                     "reset",                            false,   0, 0, false),
    row(Command::SetAddress,                "set address",                      true,   40, 2, true),
    row(Command::ReadSerial,                "read serial number and firmware",  false,   5, 0, false),
    row(Command::ConfigureLine,             "configure serial interface",       true,   40, 2, true),
    row(Command::Synchronise,               "set position and synchronise",     true,   40, 5, true),
    row(Command::ConfigureLineTemporarily,  "configure serial interface temporarily", false, 5, 1, false),
];

impl Command {
    /// Returns the command with the given command byte, or `None` if the byte is not assigned. The error bit is
    /// ignored.
    pub fn from_byte(byte: u8) -> Option<Self> {
        COMMANDS.iter().map(|row| row.command).find(|command| command.byte() == byte & 0x7F)
    }

    /// Returns the command byte without the error bit.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// Returns the row of the command in the manual's table.
    pub fn row(self) -> &'static CommandRow {
        // A test checks that the table lists every variant, so the fallback is never used.
        let [first, ..] = &COMMANDS;
        COMMANDS.iter().find(|row| row.command == self).unwrap_or(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Command table transcribed from page 18 of the manual: command byte, Code 0 mark, and maximum time in ms (None
    /// for "---").
    const MANUAL: [(u8, bool, Option<u64>); 20] = [
        (0x42, false, Some(10)),
        (0x43, true, Some(40)),
        (0x44, false, Some(5)),
        (0x46, false, Some(5)),
        (0x47, false, Some(30)),
        (0x49, true, Some(30)),
        (0x4A, false, Some(30)),
        (0x4B, false, Some(250)),
        (0x4C, false, Some(5)),
        (0x4D, false, Some(70)),
        (0x4E, false, Some(5)),
        (0x4F, false, Some(40)),
        (0x50, false, Some(5)),
        (0x52, false, Some(5)),
        (0x53, false, None),
        (0x55, true, Some(40)),
        (0x56, false, Some(5)),
        (0x57, true, Some(40)),
        (0x63, true, Some(40)),
        (0x67, false, Some(5)),
    ];

    #[test]
    fn command_table_matches_manual() {
        for ((byte, code0, ms), row) in MANUAL.into_iter().zip(COMMANDS) {
            assert_eq!(row.command.byte(), byte);
            assert_eq!(row.code0, code0, "{byte:02X}");
            assert_eq!(row.max_time, Duration::from_millis(ms.unwrap_or(0)), "{byte:02X}");
        }
    }

    #[test]
    fn every_command_has_row_and_byte() {
        for row in COMMANDS {
            assert_eq!(row.command.row().name, row.name);
            assert_eq!(Command::from_byte(row.command.byte()), Some(row.command));
            assert_eq!(Command::from_byte(row.command.byte() | 0x80), Some(row.command));
        }
        let known = (0..=0x7F).filter(|byte| Command::from_byte(*byte).is_some()).count();
        assert_eq!(known, 20);
    }
}
