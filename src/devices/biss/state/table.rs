//! The table of an encoder's registers: first the direct registers, then the banks. Every described register has a row,
//! and so has every byte without a description.

use super::memory::Memory;
use crate::bits::ByteOrder;
use crate::devices::biss::protocol::{Access, Description, EdsBank, Name, Register, RegisterAddress, ValueDecoding};

/// Last bank of the kit encoder, for descriptions that do not list any banks.
const LAST_BANK: u8 = 0x43;

#[derive(Clone, Debug, Default)]
pub struct Table {
    groups: Vec<Group>,
}

/// A group of rows: the direct registers or a bank.
#[derive(Clone, Debug)]
pub struct Group {
    /// Number of the bank, or `None` for the direct registers.
    pub bank: Option<u8>,
    /// Name of the bank, if the description contains one.
    pub name: Option<Name>,
    rows: Vec<Row>,
}

#[derive(Clone, Debug)]
pub struct Row {
    /// Register shown in the row. A byte without a description is shown as an unnamed register of width 1.
    pub register: Register,
    pub is_data: bool,
}

#[derive(Clone, Debug)]
pub struct RegisterEntry<'a> {
    pub row: &'a Row,
    /// Bytes in ascending order of address, with edits applied, or `None` if the register has not been read.
    pub bytes: Option<Vec<u8>>,
    /// Whether the value has changed since the previous reading.
    pub has_changed: bool,
    pub is_edited: bool,
}

impl Table {
    /// Creates the table for an encoder. `last` is the last bank according to the data sheet, if known.
    pub(super) fn from_description(description: &Description, last: Option<u8>) -> Self {
        let registers = description.registers().iter().filter_map(|own| own.address.bank());
        let areas = description.areas().iter().map(|area| area.last);
        let described = registers.chain(areas).chain(last).max();
        let last = described.filter(|last| *last > EdsBank::Encoder.kit_number()).unwrap_or(LAST_BANK);
        let groups = std::iter::once(None).chain((0..=last).map(Some));
        Table { groups: groups.map(|bank| Group::from_description(description, bank)).collect() }
    }

    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// Returns the index of the group for a bank, or for the direct registers if `bank` is `None`.
    pub fn position(&self, bank: Option<u8>) -> Option<usize> {
        self.groups.iter().position(|group| group.bank == bank)
    }
}

impl Group {
    fn from_description(description: &Description, bank: Option<u8>) -> Self {
        let area = bank.and_then(|bank| description.areas().iter().find(|area| area.contains(bank)));
        let mut rows: Vec<Row> = Vec::new();
        for at in bank_addresses(bank) {
            if rows.last().is_some_and(|row| row.register.contains(at)) {
                continue;
            }
            let described = description.registers().iter().find(|own| own.address == at).cloned();
            let access = area.map_or(Access::R, |area| area.access);
            rows.push(Row {
                register: described.unwrap_or_else(|| undescribed_register(at, access)),
                is_data: area.is_some(),
            });
        }
        let name = bank.and_then(|bank| description.bank_name(bank).cloned().or_else(|| standard_bank_name(bank)));
        Group { bank, name, rows }
    }

    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub fn start(&self) -> Option<RegisterAddress> {
        bank_addresses(self.bank).next()
    }

    /// Returns whether all readable registers in the group have been read.
    pub fn is_read(&self, memory: &Memory) -> bool {
        self.rows.iter().all(|row| memory.read(row.register.address).is_some() || row.register.access == Access::W)
    }

    pub fn entry<'a>(&'a self, row: usize, memory: &Memory) -> Option<RegisterEntry<'a>> {
        let row = self.rows.get(row)?;
        let places = || {
            let first = row.register.address.global_number();
            (first..first + u16::from(row.register.width)).filter_map(RegisterAddress::from_global)
        };
        Some(RegisterEntry {
            row,
            bytes: places().map(|at| memory.edited_value(at)).collect(),
            has_changed: places().any(|at| memory.has_changed(at)),
            is_edited: places().any(|at| memory.is_edited(at)),
        })
    }
}

impl RegisterEntry<'_> {
    /// Returns whether the value differs from the factory default. Returns `false` if no default is known or the
    /// register was not read.
    pub fn differs_from_factory_default(&self) -> bool {
        let default = &self.row.register.default;
        !default.is_empty() && self.bytes.as_ref().is_some_and(|own| own != default)
    }

    pub fn to_number(&self) -> Option<u64> {
        self.row.register.to_number(self.bytes.as_ref()?)
    }
}

fn bank_addresses(bank: Option<u8>) -> impl Iterator<Item = RegisterAddress> {
    let size = RegisterAddress::BANK_SIZE;
    (0..size).filter_map(move |offset| match bank {
        Some(bank) => RegisterAddress::in_bank(bank, offset),
        None => RegisterAddress::direct_register(size + offset),
    })
}

/// Creates a register for a byte without a description.
fn undescribed_register(address: RegisterAddress, access: Access) -> Register {
    Register {
        address,
        width: 1,
        name: Name::default(),
        role: None,
        access,
        order: ByteOrder::HighFirst,
        default: Vec::new(),
        decoding: ValueDecoding::Number,
        unit: String::new(),
        saves: Vec::new(),
        since: crate::devices::biss::protocol::Firmware::new(0, 0, 0),
    }
}

/// Returns the name of a data sheet bank, which all encoders with the BP3 profile share.
fn standard_bank_name(bank: u8) -> Option<Name> {
    [(EdsBank::Common, "EDS"), (EdsBank::Encoder, "EDS BP3")]
        .into_iter()
        .find(|(own, _)| own.kit_number() == bank)
        .map(|(_, name)| Name::new(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::protocol::Descriptions;

    fn kit() -> Table {
        let all = Descriptions::built_in();
        Table::from_description(all.find_by_name("POSITAL IXARC kit encoder").unwrap(), None)
    }

    /// There are 68 banks with 64 registers each, and 64 direct registers, according to appendix 9.1 of the manual.
    #[test]
    fn lists_every_register_once() {
        let table = kit();
        assert_eq!(table.groups().len(), 1 + 68);
        for group in table.groups() {
            let bytes: usize = group.rows().iter().map(|row| usize::from(row.register.width)).sum();
            assert_eq!(bytes, 64, "{:?}", group.bank);
        }
        assert_eq!(table.position(None), Some(0));
        assert_eq!(table.position(Some(0x43)), Some(68));
        assert_eq!(table.groups()[1 + 0x24].rows().len(), 64);
        assert!(table.groups()[1 + 0x24].rows().iter().all(|row| row.is_data && row.register.access == Access::Rw));
    }

    #[test]
    fn row_shows_edit_and_read_state() {
        let (table, mut memory) = (kit(), Memory::default());
        let direct = &table.groups()[0];
        let serial = direct.rows().iter().position(|row| row.register.name.english() == "serial number").unwrap();
        assert_eq!(direct.entry(serial, &memory).unwrap().bytes, None);
        assert!(!direct.is_read(&memory));
        memory.store_bytes(direct.start().unwrap(), &[7; 64]);
        let shown = direct.entry(serial, &memory).unwrap();
        assert_eq!(shown.to_number(), Some(0x0707_0707));
        assert!(direct.is_read(&memory) && !shown.is_edited && !shown.has_changed);
    }

    #[test]
    fn undescribed_encoder_has_banks() {
        let all = Descriptions::built_in();
        let unknown = all.iter().find(|own| own.identity().is_none()).unwrap();
        assert_eq!(Table::from_description(unknown, None).groups().len(), 69);
        assert_eq!(Table::from_description(unknown, Some(0x10)).groups().len(), 18);
    }
}
