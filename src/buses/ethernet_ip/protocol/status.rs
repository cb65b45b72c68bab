//! Status codes: encapsulation status, CIP general status, and the extended status of a connection that was not opened.
//! See reference 7. The names are from ODVA (`P`), and the remedies are assumptions (`U`).

use std::fmt;

use super::message::Service;

/// The encapsulation status. Unknown codes are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EncapsulationStatus(u32);

/// The general status of a CIP reply. Unknown codes are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GeneralStatus(u8);

/// A row of a status table.
#[derive(Clone, Copy, Debug)]
pub struct StatusTableRow<C> {
    /// Status code.
    pub code: C,
    /// Meaning of the code.
    pub meaning: &'static str,
    /// Suggested remedy.
    pub remedy: &'static str,
}

/// A row of the extended status table.
#[derive(Clone, Copy, Debug)]
pub struct ExtendedStatusTableRow {
    /// General status with which the code occurs.
    pub general: GeneralStatus,
    /// Code in the first extended status word.
    pub code: u16,
    /// Meaning of the code.
    pub meaning: &'static str,
    /// Suggested remedy.
    pub remedy: &'static str,
}

const fn row<C>(code: C, meaning: &'static str, remedy: &'static str) -> StatusTableRow<C> {
    StatusTableRow { code, meaning, remedy }
}

const RETRY_REMEDY: &str = "try again; if the error returns, restart the device";
const DEFECT_REMEDY: &str = "a defect of this program: report it with a trace";

/// Known encapsulation status codes.
pub const ENCAPSULATION_STATUS: [StatusTableRow<EncapsulationStatus>; 7] = [
    row(EncapsulationStatus::OK, "success", "nothing"),
    row(EncapsulationStatus(0x01), "command not supported", "use another command"),
    row(EncapsulationStatus(0x02), "not enough memory for the command", RETRY_REMEDY),
    row(EncapsulationStatus(0x03), "malformed data", DEFECT_REMEDY),
    row(EncapsulationStatus::NO_SESSION, "no such session", "connect again: the device has closed the session"),
    row(EncapsulationStatus(0x65), "wrong length", DEFECT_REMEDY),
    row(EncapsulationStatus::VERSION, "version not supported", "the device uses another version of EtherNet/IP"),
];

/// Known general status codes.
pub const GENERAL_STATUS: [StatusTableRow<GeneralStatus>; 31] = [
    row(GeneralStatus::OK, "success", "nothing"),
    row(GeneralStatus::CONNECTION, "connection failure", "see the words that follow"),
    row(GeneralStatus(0x02), "resources unavailable", "close another connection to the device, or restart it"),
    row(GeneralStatus(0x03), "invalid service parameter", DEFECT_REMEDY),
    row(GeneralStatus(0x04), "path segment error", DEFECT_REMEDY),
    row(GeneralStatus(0x05), "path unknown", "use an object that the device has; a hub has only those of its drives"),
    row(GeneralStatus(0x06), "partial transfer", "request less data at a time"),
    row(GeneralStatus(0x07), "connection lost", "connect again"),
    row(GeneralStatus(0x08), "service not supported", "use another service"),
    row(GeneralStatus(0x09), "invalid value", "give a value within its range"),
    row(GeneralStatus(0x0A), "attribute list error", "read the attributes one by one"),
    row(GeneralStatus(0x0B), "already in the requested state", "no action needed"),
    row(GeneralStatus(0x0C), "object state conflict", "stop the drive, or leave the state, then try again"),
    row(GeneralStatus(0x0D), "object already exists", "use the existing object"),
    row(GeneralStatus(0x0E), "attribute cannot be set", "it can only be read"),
    row(GeneralStatus(0x0F), "no permission", "check the access rights"),
    row(GeneralStatus(0x10), "device state conflict", "stop the drive, or leave the state, then try again"),
    row(GeneralStatus(0x11), "reply too long", "request less data at a time"),
    row(GeneralStatus(0x12), "value would be fragmented", DEFECT_REMEDY),
    row(GeneralStatus(0x13), "not enough data", "give a value of the attribute's length"),
    row(GeneralStatus(0x14), "attribute not supported", "use another attribute"),
    row(GeneralStatus(0x15), "too much data", "give a value of the attribute's length"),
    row(GeneralStatus(0x16), "object does not exist", "use an object that the device has"),
    row(GeneralStatus(0x18), "no stored attribute data", "save the attributes first"),
    row(GeneralStatus(0x19), "attributes could not be stored", RETRY_REMEDY),
    row(GeneralStatus(0x1C), "attributes missing in a list", DEFECT_REMEDY),
    row(GeneralStatus(0x1E), "embedded service failed", "see the words that follow"),
    row(GeneralStatus(0x1F), "vendor-specific error", "see the words that follow, and the device's manual"),
    row(GeneralStatus(0x20), "invalid parameter", "give a value within its range"),
    row(GeneralStatus(0x26), "invalid path length", DEFECT_REMEDY),
    row(GeneralStatus(0x2C), "attribute cannot be read", "it can only be set"),
];

const fn connection_row(code: u16, meaning: &'static str, remedy: &'static str) -> ExtendedStatusTableRow {
    ExtendedStatusTableRow { general: GeneralStatus::CONNECTION, code, meaning, remedy }
}

const OTHER_MASTER: &str = "close the connection of the other master first";
const SIZE_REMEDY: &str = "set parameter words and number of drives as in the device";

/// Known reasons for a failure to open or close a connection.
pub const EXTENDED_STATUS: [ExtendedStatusTableRow; 18] = [
    connection_row(0x0100, "connection already in use", "wait for its time-out, then connect again"),
    connection_row(0x0103, "transport class and trigger not supported", DEFECT_REMEDY),
    connection_row(0x0106, "another master owns the outputs", OTHER_MASTER),
    connection_row(0x0107, "connection does not exist", "no action needed: it has already ended"),
    connection_row(0x0108, "connection type not supported", "request a multicast connection from the target"),
    connection_row(0x0109, "connection size not supported", SIZE_REMEDY),
    connection_row(0x0111, "interval not supported", "request a longer interval"),
    connection_row(0x0113, "no connection available", OTHER_MASTER),
    connection_row(
        0x0114,
        "vendor or product does not match the key",
        "open it without a key, or check which device it is",
    ),
    connection_row(0x0115, "device type does not match the key", "open it without a key, or check which device it is"),
    connection_row(0x0116, "revision does not match the key", "open it without a key, or check which device it is"),
    connection_row(0x0117, "assemblies do not exist", "use the assemblies of the device: 104, 100, 101"),
    connection_row(0x0127, "size from originator to target not supported", SIZE_REMEDY),
    connection_row(0x0128, "size from target to originator not supported", SIZE_REMEDY),
    connection_row(0x0203, "connection timed out", "check cables and switches, or request a longer interval"),
    connection_row(0x0204, "request timed out", RETRY_REMEDY),
    connection_row(0x0312, "link address does not exist", "omit routes: the device is addressed directly"),
    connection_row(0x0315, "path segment not supported", DEFECT_REMEDY),
];

impl EncapsulationStatus {
    /// Success.
    pub const OK: EncapsulationStatus = EncapsulationStatus(0);
    /// 01h: the device does not support the command.
    pub const UNSUPPORTED: EncapsulationStatus = EncapsulationStatus(0x01);
    /// 03h: the data are invalid.
    pub const MALFORMED: EncapsulationStatus = EncapsulationStatus(0x03);
    /// 64h: the session is not registered.
    pub const NO_SESSION: EncapsulationStatus = EncapsulationStatus(0x64);
    /// 69h: the protocol version is not supported.
    pub const VERSION: EncapsulationStatus = EncapsulationStatus(0x69);

    /// Creates a status from its code. Every value is valid.
    pub const fn new(code: u32) -> Self {
        EncapsulationStatus(code)
    }

    /// Returns the status code.
    pub const fn code(self) -> u32 {
        self.0
    }

    /// Returns the table row of the status, or `None` if the status is unknown.
    pub fn row(self) -> Option<&'static StatusTableRow<EncapsulationStatus>> {
        ENCAPSULATION_STATUS.iter().find(|row| row.code == self)
    }
}

impl GeneralStatus {
    /// Success.
    pub const OK: GeneralStatus = GeneralStatus(0x00);
    /// 01h: a connection was not opened or closed. The extended status gives the reason.
    pub const CONNECTION: GeneralStatus = GeneralStatus(0x01);
    /// 05h: the object does not exist.
    pub const PATH_UNKNOWN: GeneralStatus = GeneralStatus(0x05);
    /// 08h: the object does not support the service.
    pub const NO_SERVICE: GeneralStatus = GeneralStatus(0x08);
    /// 09h: the attribute value is out of range.
    pub const INVALID_VALUE: GeneralStatus = GeneralStatus(0x09);
    /// 0Ch: the request is not possible in the current state.
    pub const STATE: GeneralStatus = GeneralStatus(0x0C);
    /// 0Eh: the attribute is read-only.
    pub const NOT_SETTABLE: GeneralStatus = GeneralStatus(0x0E);
    /// 13h: the request contains too little data.
    pub const TOO_SHORT: GeneralStatus = GeneralStatus(0x13);
    /// 14h: the object does not support the attribute.
    pub const NO_ATTRIBUTE: GeneralStatus = GeneralStatus(0x14);
    /// 15h: the request contains too much data.
    pub const TOO_LONG: GeneralStatus = GeneralStatus(0x15);

    /// Creates a status from its code. Every value is valid.
    pub const fn new(code: u8) -> Self {
        GeneralStatus(code)
    }

    /// Returns the status code.
    pub const fn code(self) -> u8 {
        self.0
    }

    /// Returns the table row of the status, or `None` if the status is unknown.
    pub fn row(self) -> Option<&'static StatusTableRow<GeneralStatus>> {
        GENERAL_STATUS.iter().find(|row| row.code == self)
    }
}

/// Returns the table row of an extended status code. Only codes of the connection manager's services are known.
pub fn find_extended_status(
    service: Service,
    status: GeneralStatus,
    code: u16,
) -> Option<&'static ExtendedStatusTableRow> {
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
