//! The CIP objects of the target: identity, parameters (reference, section 7), and network.

use super::device::TargetDevice;
use crate::buses::ethernet_ip::protocol::{
    ConfigurationControl, EPath, GeneralStatus, Identity, LogicalKind, PacketError, Reply, Request, Revision, Segment,
    Service,
};
use crate::devices::hiperdrive::protocol::{ParameterAccess, ParameterNumber, ParameterRow, VENDOR, Value};

/// Device type assigned by ODVA to communications adapters.
const DEVICE_TYPE: u16 = 0x0C;
/// Product code of the virtual device. The real code is unknown (`U`).
const PRODUCT_CODE: u16 = 1;
const REVISION: Revision = Revision { major: 1, minor: 2 };
/// Status word of the identity object without a cyclic connection. Bits 7 to 4 show the state of the connection, and
/// bit 0 shows whether it has an owner.
const NOT_CONNECTED: u16 = 0x0030;
const CONNECTED: u16 = 0x0061;
const ETHERNET_LINK: u16 = 0xF6;
/// CIP class of the device parameters. The class for drive n is n higher.
const PARAMETERS: u16 = 0x64;
/// CIP status for an attribute that can be set but not read.
const NOT_GETTABLE: GeneralStatus = GeneralStatus::new(0x2C);

type ServiceResult = Result<Vec<u8>, GeneralStatus>;

impl TargetDevice {
    pub(super) fn handle_request(&mut self, request: &Request) -> Reply {
        match self.execute(request) {
            Ok(data) => request.success_reply(data),
            Err(status) => request.error_reply(status),
        }
    }

    pub(super) fn identity(&mut self) -> Identity {
        let topology = self.station.topology();
        let serial = ParameterNumber::new(17).and_then(|number| self.station.read(self.now, number).ok());
        Identity {
            vendor: VENDOR,
            device_type: DEVICE_TYPE,
            product_code: PRODUCT_CODE,
            revision: REVISION,
            status: if self.connections.has_cyclic_connection() { CONNECTED } else { NOT_CONNECTED },
            serial_number: match serial {
                // The serial number has 16 bits.
                Some(Value::Number(number)) => number as u32,
                _ => 0,
            },
            product_name: topology.category().to_owned(),
        }
    }

    fn execute(&mut self, request: &Request) -> ServiceResult {
        let (class, attribute) = class_and_attribute(&request.path)?;
        match class {
            Identity::CLASS => {
                let identity = self.identity();
                read(request, attribute, identity.emit_all(), |number| identity.attribute_bytes(number))
            }
            ConfigurationControl::CLASS if request.service == Service::SET => {
                self.network.set_attribute(attribute.ok_or(GeneralStatus::NO_ATTRIBUTE)?, &request.data)
            }
            ConfigurationControl::CLASS => {
                let network = &self.network;
                read(request, attribute, network.interface_attributes(), |number| network.interface(number))
            }
            ETHERNET_LINK => {
                read(request, attribute, self.network.link_attributes(), |number| self.network.link_attribute(number))
            }
            class => self.parameter(request, class, attribute),
        }
    }

    fn parameter(&mut self, request: &Request, class: u16, attribute: Option<u16>) -> ServiceResult {
        let places = u16::from(self.station.topology().drives());
        if !(PARAMETERS..=PARAMETERS + places).contains(&class) {
            return Err(GeneralStatus::PATH_UNKNOWN);
        }
        if ![Service::GET, Service::SET].contains(&request.service) {
            return Err(GeneralStatus::NO_SERVICE);
        }
        let number = attribute.and_then(|attribute| ParameterNumber::from_attribute(class, attribute));
        let (number, row) =
            number.and_then(|number| Some((number, number.row()?))).ok_or(GeneralStatus::NO_ATTRIBUTE)?;
        if request.service == Service::GET {
            self.get(number, row)
        } else {
            self.set_parameter(number, row, &request.data)
        }
    }

    fn get(&mut self, number: ParameterNumber, row: &ParameterRow) -> ServiceResult {
        if row.access == ParameterAccess::Write {
            return Err(NOT_GETTABLE);
        }
        let value = self.station.read(self.now, number).map_err(|refused| refused.status())?;
        let data = row.kind.emit(&value).map_err(|_| GeneralStatus::STATE)?;
        // Strings are short, so their length fits in a byte.
        let length = (self.counted_texts && row.kind.byte_length().is_none()).then_some(data.len() as u8);
        Ok(length.into_iter().chain(data).collect())
    }

    fn set_parameter(&mut self, number: ParameterNumber, row: &ParameterRow, data: &[u8]) -> ServiceResult {
        let length = row
            .kind
            .byte_length()
            .filter(|_| row.access != ParameterAccess::Read)
            .ok_or(GeneralStatus::NOT_SETTABLE)?;
        if data.len() < length {
            return Err(GeneralStatus::TOO_SHORT);
        }
        let value = row.kind.parse(data).map_err(|_| GeneralStatus::TOO_LONG)?;
        self.station.write(self.now, number, &value).map_err(|refused| refused.status())?;
        if (number, value) == (ParameterNumber::SAVE, Value::Number(-3)) {
            self.network.restore_factory();
        }
        Ok(Vec::new())
    }
}

/// Returns the class and attribute in a path, which must refer to the only instance of an object.
pub(super) fn class_and_attribute(path: &EPath) -> Result<(u16, Option<u16>), GeneralStatus> {
    let understood = |segment: &Segment| match segment {
        Segment::Logical { kind, .. } => *kind != LogicalKind::ConnectionPoint,
        _ => false,
    };
    if !path.0.iter().all(understood) {
        return Err(GeneralStatus::new(0x04));
    }
    let class = path.first_value(LogicalKind::Class).filter(|_| path.first_value(LogicalKind::Instance) == Some(1));
    Ok((class.ok_or(GeneralStatus::PATH_UNKNOWN)?, path.first_value(LogicalKind::Attribute)))
}

pub(super) const fn status_of(error: PacketError) -> GeneralStatus {
    match error {
        PacketError::Short { .. } => GeneralStatus::TOO_SHORT,
        PacketError::Long { .. } => GeneralStatus::TOO_LONG,
        PacketError::Value { .. } => GeneralStatus::INVALID_VALUE,
    }
}

/// Reads an attribute, or all attributes, of a read-only object.
fn read(
    request: &Request,
    attribute: Option<u16>,
    all: Vec<u8>,
    one: impl FnOnce(u16) -> Option<Vec<u8>>,
) -> ServiceResult {
    let found = attribute.and_then(one);
    match request.service {
        Service::GET_ALL => Ok(all),
        Service::GET => found.ok_or(GeneralStatus::NO_ATTRIBUTE),
        Service::SET if found.is_some() => Err(GeneralStatus::NOT_SETTABLE),
        Service::SET => Err(GeneralStatus::NO_ATTRIBUTE),
        _ => Err(GeneralStatus::NO_SERVICE),
    }
}
