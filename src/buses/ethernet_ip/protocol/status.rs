//! The statuses of the two layers: encapsulation status, CIP general status, and the words that follow it when a
//! connection was not opened (reference 7; names as in ODVA, `P`; remedies `U`).

use std::fmt;

use super::message::Service;

/// Status of a frame. Unknown codes are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EncapsulationStatus(u32);

/// Status of a CIP reply. Unknown codes are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GeneralStatus(u8);

/// A row of a table.
#[derive(Clone, Copy, Debug)]
pub struct StatusRow<C> {
    /// The code.
    pub code: C,
    /// The meaning.
    pub meaning: &'static str,
    /// The remedy.
    pub remedy: &'static str,
}

/// A row of the table of extended status.
#[derive(Clone, Copy, Debug)]
pub struct ExtendedStatusRow {
    /// The general status that it follows.
    pub general: GeneralStatus,
    /// The first word after it.
    pub code: u16,
    /// The meaning.
    pub meaning: &'static str,
    /// The remedy.
    pub remedy: &'static str,
}

const fn row<C>(code: C, meaning: &'static str, remedy: &'static str) -> StatusRow<C> {
    StatusRow { code, meaning, remedy }
}

const AGAIN: &str = "try again; where it comes back, restart the device";
const DEFECT: &str = "this program has sent something wrong: report it with a trace";

/// The statuses of a frame.
pub const ENCAPSULATION_STATUS: [StatusRow<EncapsulationStatus>; 7] = [
    row(EncapsulationStatus::OK, "success", "nothing"),
    row(EncapsulationStatus(0x01), "command not supported", "ask for something else: the device does not have it"),
    row(EncapsulationStatus(0x02), "no memory left for the command", AGAIN),
    row(EncapsulationStatus(0x03), "malformed data", DEFECT),
    row(EncapsulationStatus::NO_SESSION, "no such session", "connect anew: the device has forgotten the session"),
    row(EncapsulationStatus(0x65), "wrong length", DEFECT),
    row(EncapsulationStatus::VERSION, "version not supported", "the device speaks another version of EtherNet/IP"),
];

/// The statuses of a request.
pub const GENERAL_STATUS: [StatusRow<GeneralStatus>; 31] = [
    row(GeneralStatus::OK, "success", "nothing"),
    row(GeneralStatus::CONNECTION, "connection failure", "see what stands behind it"),
    row(GeneralStatus(0x02), "no resources left", "close another connection to the device, or restart it"),
    row(GeneralStatus(0x03), "wrong parameter of the service", DEFECT),
    row(GeneralStatus(0x04), "path segment not understood", DEFECT),
    row(
        GeneralStatus(0x05),
        "path unknown",
        "ask for an object that the device has; a hub has those of its drives alone",
    ),
    row(GeneralStatus(0x06), "partial transfer", "ask for less at a time"),
    row(GeneralStatus(0x07), "connection lost", "connect anew"),
    row(GeneralStatus(0x08), "service not supported", "ask for something else: the object does not have it"),
    row(GeneralStatus(0x09), "invalid value", "give a value within its range"),
    row(GeneralStatus(0x0A), "error in a list of attributes", "ask for the attributes one by one"),
    row(GeneralStatus(0x0B), "already so", "nothing: it is as it should be"),
    row(
        GeneralStatus(0x0C),
        "not possible in the object's state",
        "stop the drive, or leave the state, then try again",
    ),
    row(GeneralStatus(0x0D), "object exists already", "use the one there is"),
    row(GeneralStatus(0x0E), "attribute cannot be set", "leave it: it can only be read"),
    row(GeneralStatus(0x0F), "not permitted", "ask who has the rights"),
    row(
        GeneralStatus(0x10),
        "not possible in the device's state",
        "stop the drive, or leave the state, then try again",
    ),
    row(GeneralStatus(0x11), "reply too long", "ask for less at a time"),
    row(GeneralStatus(0x12), "a value would be split", DEFECT),
    row(GeneralStatus(0x13), "too few data", "give a value of the attribute's length"),
    row(GeneralStatus(0x14), "attribute not supported", "ask for another: the object does not have it"),
    row(GeneralStatus(0x15), "too many data", "give a value of the attribute's length"),
    row(GeneralStatus(0x16), "object does not exist", "ask for an object that the device has"),
    row(GeneralStatus(0x18), "attributes are not kept", "save them otherwise"),
    row(GeneralStatus(0x19), "attributes could not be kept", AGAIN),
    row(GeneralStatus(0x1C), "a list lacks attributes", DEFECT),
    row(GeneralStatus(0x1E), "embedded service failed", "see what stands behind it"),
    row(GeneralStatus(0x1F), "error of the maker's own", "see what stands behind it, and in the device's manual"),
    row(GeneralStatus(0x20), "invalid parameter", "give a value within its range"),
    row(GeneralStatus(0x26), "path of a wrong size", DEFECT),
    row(GeneralStatus(0x2C), "attribute cannot be read", "leave it: it can only be set"),
];

const fn connection(code: u16, meaning: &'static str, remedy: &'static str) -> ExtendedStatusRow {
    ExtendedStatusRow { general: GeneralStatus::CONNECTION, code, meaning, remedy }
}

const OTHER_MASTER: &str = "close the connection of the other master first";
const SIZE: &str = "choose with or without parameter words as the device is set, and the number of its drives";

/// Why a connection was not opened or closed.
pub const EXTENDED_STATUS: [ExtendedStatusRow; 18] = [
    connection(0x0100, "connection in use already", "wait for its time-out, then connect anew"),
    connection(0x0103, "transport class and trigger not supported", DEFECT),
    connection(0x0106, "another master owns the outputs", OTHER_MASTER),
    connection(0x0107, "no such connection", "nothing: it has ended already"),
    connection(0x0108, "kind of connection not supported", "ask for a multicast connection from the target"),
    connection(0x0109, "size of the connection not supported", SIZE),
    connection(0x0111, "interval not supported", "ask for a longer interval"),
    connection(0x0113, "no connection left", OTHER_MASTER),
    connection(0x0114, "maker or product does not fit the key", "open it without a key, or see which device it is"),
    connection(0x0115, "device type does not fit the key", "open it without a key, or see which device it is"),
    connection(0x0116, "revision does not fit the key", "open it without a key, or see which device it is"),
    connection(0x0117, "no such assemblies", "name the assemblies that the device has: 104, 100, 101"),
    connection(0x0127, "size from originator to target not supported", SIZE),
    connection(0x0128, "size from target to originator not supported", SIZE),
    connection(0x0203, "connection timed out", "check cables and switches, or ask for a longer interval"),
    connection(0x0204, "request timed out", AGAIN),
    connection(0x0312, "no such link address", "leave routes away: the device is asked directly"),
    connection(0x0315, "segment of the path not understood", DEFECT),
];

impl EncapsulationStatus {
    /// Done.
    pub const OK: EncapsulationStatus = EncapsulationStatus(0);
    /// 01h: the device does not have the command.
    pub const UNSUPPORTED: EncapsulationStatus = EncapsulationStatus(0x01);
    /// 03h: the data are invalid.
    pub const MALFORMED: EncapsulationStatus = EncapsulationStatus(0x03);
    /// 64h: the session is not registered.
    pub const NO_SESSION: EncapsulationStatus = EncapsulationStatus(0x64);
    /// 69h: another version of the protocol.
    pub const VERSION: EncapsulationStatus = EncapsulationStatus(0x69);

    /// Creates it: any number is a status.
    pub const fn new(code: u32) -> Self {
        EncapsulationStatus(code)
    }

    /// Returns its number.
    pub const fn code(self) -> u32 {
        self.0
    }

    /// Returns the row; `None` for an unknown status.
    pub fn row(self) -> Option<&'static StatusRow<EncapsulationStatus>> {
        ENCAPSULATION_STATUS.iter().find(|row| row.code == self)
    }
}

impl GeneralStatus {
    /// Done.
    pub const OK: GeneralStatus = GeneralStatus(0x00);
    /// 01h: a connection was not opened or closed; the words after it tell why.
    pub const CONNECTION: GeneralStatus = GeneralStatus(0x01);
    /// 05h: there is no such object.
    pub const PATH_UNKNOWN: GeneralStatus = GeneralStatus(0x05);
    /// 08h: the object does not have the service.
    pub const NO_SERVICE: GeneralStatus = GeneralStatus(0x08);
    /// 09h: value out of range.
    pub const INVALID_VALUE: GeneralStatus = GeneralStatus(0x09);
    /// 0Ch: not in this state.
    pub const STATE: GeneralStatus = GeneralStatus(0x0C);
    /// 0Eh: read-only attribute.
    pub const NOT_SETTABLE: GeneralStatus = GeneralStatus(0x0E);
    /// 13h: the value is too short.
    pub const TOO_SHORT: GeneralStatus = GeneralStatus(0x13);
    /// 14h: the object does not have the attribute.
    pub const NO_ATTRIBUTE: GeneralStatus = GeneralStatus(0x14);
    /// 15h: the value is too long.
    pub const TOO_LONG: GeneralStatus = GeneralStatus(0x15);

    /// Creates it: any number is a status.
    pub const fn new(code: u8) -> Self {
        GeneralStatus(code)
    }

    /// Returns its number.
    pub const fn code(self) -> u8 {
        self.0
    }

    /// Returns the row; `None` for an unknown status.
    pub fn row(self) -> Option<&'static StatusRow<GeneralStatus>> {
        GENERAL_STATUS.iter().find(|row| row.code == self)
    }
}

/// Returns the meaning of the first word after a status; only those of the connection manager's services are known.
pub fn extended_row(service: Service, status: GeneralStatus, code: u16) -> Option<&'static ExtendedStatusRow> {
    let connections = [Service::FORWARD_OPEN, Service::FORWARD_CLOSE].contains(&service);
    EXTENDED_STATUS.iter().find(|row| connections && row.general == status && row.code == code)
}

impl fmt::Display for EncapsulationStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:08X} {}", self.0, self.row().map_or("unknown status", |row| row.meaning))
    }
}

impl fmt::Display for GeneralStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "0x{:02X} {}", self.0, self.row().map_or("unknown status", |row| row.meaning))
    }
}
