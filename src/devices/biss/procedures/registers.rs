//! Register values read from an encoder, stored byte by byte, and functions that read the registers in a description.

use std::collections::BTreeMap;

use super::{Error, Master};
use crate::devices::biss::protocol::{DecodedValue, Description, Firmware, Register, RegisterAddress, Role};

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Registers(BTreeMap<RegisterAddress, u8>);

impl Registers {
    pub fn get(&self, address: RegisterAddress) -> Option<u8> {
        self.0.get(&address).copied()
    }

    /// Returns the bytes of consecutive registers by global address. Returns `None` if some of them have not been read.
    pub fn run(&self, start: RegisterAddress, count: u8) -> Option<Vec<u8>> {
        let first = start.global_number();
        (first..first.saturating_add(count.into())).map(|at| self.get(RegisterAddress::from_global(at)?)).collect()
    }

    /// Returns the bytes of a described register. Returns `None` if some of them have not been read.
    pub fn bytes(&self, register: &Register) -> Option<Vec<u8>> {
        self.run(register.address, register.width)
    }

    pub fn number_of(&self, description: &Description, role: Role) -> Option<u64> {
        let register = description.register_with_role(role)?;
        register.to_number(&self.bytes(register)?)
    }

    pub fn quantity_of(&self, description: &Description, role: Role) -> Option<f64> {
        let register = description.register_with_role(role)?;
        match register.decode(&self.bytes(register)?)? {
            DecodedValue::Scaled(value) => Some(value),
            DecodedValue::Number(value) | DecodedValue::Hex(value) => Some(value as f64),
            DecodedValue::Bits(_) | DecodedValue::Choice(..) | DecodedValue::Text(_) => None,
        }
    }

    /// Returns all registers in ascending order of address.
    pub fn iter(&self) -> impl Iterator<Item = (RegisterAddress, u8)> {
        self.0.iter().map(|(address, value)| (*address, *value))
    }

    /// Stores consecutive bytes that were read.
    pub(super) fn store_bytes(&mut self, start: RegisterAddress, bytes: &[u8]) {
        let places = (start.global_number()..).map_while(RegisterAddress::from_global);
        self.0.extend(places.zip(bytes.iter().copied()));
    }

    /// Reads consecutive registers and stores their values.
    ///
    /// # Errors
    /// Returns any error that [`Master::read_consecutive`] returns.
    pub(super) fn read(
        &mut self,
        master: &mut Master<'_>,
        start: RegisterAddress,
        count: u8,
    ) -> Result<Vec<u8>, Error> {
        let bytes = master.read_consecutive(start, count.into())?;
        self.store_bytes(start, &bytes);
        Ok(bytes)
    }

    pub(super) fn read_register(&mut self, master: &mut Master<'_>, register: &Register) -> Result<Vec<u8>, Error> {
        self.read(master, register.address, register.width)
    }

    /// Reads all described registers that this firmware has and that have not been read yet. Returns the addresses of
    /// those that the encoder does not have.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub(super) fn read_described_registers(
        &mut self,
        master: &mut Master<'_>,
        description: &Description,
        firmware: Option<Firmware>,
        progress: &mut dyn FnMut(u64, u64, RegisterAddress),
    ) -> Result<Vec<RegisterAddress>, Error> {
        let wanted: Vec<&Register> = description
            .registers()
            .iter()
            .filter(|register| is_readable(register, firmware) && self.bytes(register).is_none())
            .collect();
        let mut missing = Vec::new();
        for (done, register) in (0..).zip(&wanted) {
            progress(done, wanted.len() as u64, register.address);
            match self.read_register(master, register) {
                Ok(_) => {}
                Err(Error::NoSuchRegister { .. }) => missing.push(register.address),
                Err(error) => return Err(error),
            }
        }
        Ok(missing)
    }

    /// Reads the registers with the given roles, and skips those that the encoder does not have.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub(super) fn read_registers_with_roles(
        &mut self,
        master: &mut Master<'_>,
        description: &Description,
        firmware: Option<Firmware>,
        roles: &[Role],
    ) -> Result<(), Error> {
        for register in roles.iter().filter_map(|role| description.register_with_role(*role)) {
            if !is_readable(register, firmware) {
                continue;
            }
            match self.read_register(master, register) {
                Ok(_) | Err(Error::NoSuchRegister { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

/// Returns whether a register can be read with the given firmware. If the firmware is unknown, the oldest one is
/// assumed.
fn is_readable(register: &Register, firmware: Option<Firmware>) -> bool {
    register.access.is_readable() && firmware.unwrap_or_default() >= register.since
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::protocol::Descriptions;

    fn at(text: &str) -> RegisterAddress {
        text.parse().unwrap()
    }

    #[test]
    fn finds_values_by_address_and_role() {
        let kit = Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").cloned().unwrap();
        let mut registers = Registers::default();
        registers.store_bytes(at("0x44"), &[0x00, 0x12, 0xD6, 0x87]);
        registers.store_bytes(at("0x66"), &[0x4B]);
        assert_eq!(registers.number_of(&kit, Role::SerialNumber), Some(1_234_567));
        assert_eq!(registers.quantity_of(&kit, Role::Temperature), Some(25.0));
        assert_eq!(registers.number_of(&kit, Role::Errors), None);
        assert_eq!(registers.run(at("0x45"), 3), Some(vec![0x12, 0xD6, 0x87]));
        assert_eq!(registers.run(at("0x45"), 4), None);
        assert_eq!(registers.iter().count(), 5);
    }

    #[test]
    fn skips_registers_missing_in_firmware() {
        let kit = Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").cloned().unwrap();
        let errors = kit.register_with_role(Role::Errors).unwrap();
        assert!(is_readable(errors, Some(Firmware::new(1, 6, 0))));
        assert!(!is_readable(errors, Some(Firmware::new(1, 5, 9))) && !is_readable(errors, None));
        assert!(is_readable(kit.register_with_role(Role::Mode).unwrap(), None));
    }
}
