//! Deserialization of description files. Each row is checked as soon as it has been parsed, because its position is
//! lost afterwards.

use std::collections::BTreeSet;
use std::fmt;

use ron::error::{Position, SpannedError};
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::super::address::RegisterAddress;
use super::super::crc::Crc;
use super::super::procedure::ProcedureKind;
use super::super::single_cycle::{Layout, LayoutError};
use super::super::status::{Firmware, ProfileId};
use super::codes::CodeTable;
use super::description_error::{self, DescriptionErrorKind, UniqueItem};
use super::german::GermanNames;
use super::name::Name;
use super::register::{Access, Area, Register, Role, ValueDecoding};
use super::{Description, Identity, Lock, Procedure};
use crate::bits::ByteOrder;

/// Parses a description file.
///
/// # Errors
/// Returns the error and its position in the file if the description is invalid.
pub(super) fn parse(text: &str) -> Result<Description, (Position, DescriptionErrorKind)> {
    description_error::take_error();
    let read: Result<File, SpannedError> = ron::from_str(text);
    let mut file = read.map_err(|SpannedError { code, span }| {
        (span.start, description_error::take_error().unwrap_or_else(|| DescriptionErrorKind::Form(code.to_string())))
    })?;
    std::mem::take(&mut file.german).translate(file.names_mut(), text)?;
    Ok(Description {
        name: file.name,
        identity: file.identity,
        layout: file.frame,
        lock: file.lock,
        registers: file.registers.0,
        banks: file.banks.0.into_iter().map(|row| (row.bank, row.name)).collect(),
        areas: file.areas.0,
        procedures: file.procedures.0,
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[serde(default)]
    identity: Option<Identity>,
    #[serde(default)]
    frame: Option<Layout>,
    #[serde(default)]
    lock: Option<Lock>,
    #[serde(default)]
    registers: Rows<Register>,
    #[serde(default)]
    banks: Rows<BankRow>,
    #[serde(default)]
    areas: Rows<Area>,
    #[serde(default)]
    procedures: Rows<Procedure>,
    #[serde(default)]
    german: GermanNames,
}

impl File {
    fn names_mut(&mut self) -> impl Iterator<Item = &mut Name> {
        let registers = self.registers.0.iter_mut().flat_map(|register| {
            let values: Box<dyn Iterator<Item = &mut Name>> = match &mut register.decoding {
                ValueDecoding::Bits(bits) => Box::new(bits.iter_mut().map(|(_, name)| name)),
                ValueDecoding::Choice(choices) => Box::new(choices.iter_mut().map(|(_, name)| name)),
                _ => Box::new(std::iter::empty()),
            };
            std::iter::once(&mut register.name).chain(values)
        });
        let banks = self.banks.0.iter_mut().map(|bank| &mut bank.name);
        registers.chain(banks).chain(self.areas.0.iter_mut().map(|area| &mut area.name))
    }
}

/// A register location, written as `direct(0x66)` or `bank(0x24, 0x10)`.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum RegisterLocation {
    Direct(u8),
    Bank(u8, u8),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct IdentityRow {
    profile: u16,
    manufacturer: [u8; 2],
    device_id: [u8; 6],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LayoutRow {
    multiturn: u8,
    singleturn: u8,
    error: bool,
    warning: bool,
    #[serde(default)]
    crc: Option<CrcRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CrcRow {
    polynomial: u64,
    #[serde(default)]
    start: u32,
    inverted: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LockRow {
    password_at: RegisterLocation,
    password: u8,
    mode_at: RegisterLocation,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RegisterRow {
    at: RegisterLocation,
    #[serde(default = "default_count")]
    width: u8,
    name: Name,
    #[serde(default)]
    role: Option<Role>,
    access: Access,
    #[serde(default)]
    order: ByteOrder,
    #[serde(default)]
    default: Vec<u8>,
    #[serde(default)]
    decode: ValueDecoding,
    #[serde(default)]
    codes: Option<CodeTable>,
    #[serde(default)]
    unit: String,
    #[serde(default)]
    saves: Vec<u8>,
    #[serde(default)]
    since: (u8, u8, u8),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BankRow {
    bank: u8,
    name: Name,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AreaRow {
    name: Name,
    banks: (u8, u8),
    access: Access,
    #[serde(default)]
    open: Option<u8>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProcedureRow {
    kind: ProcedureKind,
    mode: u8,
    command: RegisterLocation,
    status: RegisterLocation,
    #[serde(default)]
    data: Option<RegisterLocation>,
    #[serde(default)]
    since: (u8, u8, u8),
}

fn default_count() -> u8 {
    1
}

impl TryFrom<RegisterLocation> for RegisterAddress {
    type Error = DescriptionErrorKind;

    fn try_from(place: RegisterLocation) -> Result<Self, DescriptionErrorKind> {
        match place {
            RegisterLocation::Direct(address) => {
                RegisterAddress::direct_register(address).ok_or(DescriptionErrorKind::Direct(address))
            }
            RegisterLocation::Bank(bank, offset) => {
                RegisterAddress::in_bank(bank, offset).ok_or(DescriptionErrorKind::Banked { bank, offset })
            }
        }
    }
}

/// Implements `Deserialize` for rows that are checked while they are parsed, so that an error has the position of its
/// row.
macro_rules! checked {
    ($($row:ident => $own:ty,)*) => {$(
        impl<'de> Deserialize<'de> for $own {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $row::deserialize(deserializer)?.validate().map_err(description_error::store_error)
            }
        }
    )*};
}

checked! {
    IdentityRow => Identity,
    LayoutRow => Layout,
    LockRow => Lock,
    RegisterRow => Register,
    AreaRow => Area,
    ProcedureRow => Procedure,
}

impl IdentityRow {
    fn validate(self) -> Result<Identity, DescriptionErrorKind> {
        let IdentityRow { profile, manufacturer, device_id } = self;
        Ok(Identity { profile: ProfileId::new(profile), manufacturer, device_id })
    }
}

impl LayoutRow {
    fn validate(self) -> Result<Layout, LayoutError> {
        let crc = self.crc.map(|row| Crc::new(row.polynomial, row.start, row.inverted)).transpose()?;
        Layout::new(self.multiturn, self.singleturn, self.error, self.warning, crc)
    }
}

impl LockRow {
    fn validate(self) -> Result<Lock, DescriptionErrorKind> {
        let (password_at, mode_at) = (self.password_at.try_into()?, self.mode_at.try_into()?);
        Ok(Lock { password_at, password: self.password, mode_at })
    }
}

impl RegisterRow {
    fn validate(self) -> Result<Register, DescriptionErrorKind> {
        let address: RegisterAddress = self.at.try_into()?;
        let (name, width) = (self.name, self.width);
        if !(1..=Register::MAX_WIDTH).contains(&width) {
            return Err(DescriptionErrorKind::Width { name: name.to_string(), width });
        }
        if address.offset_by(width - 1).is_none() {
            return Err(DescriptionErrorKind::BeyondBank { name: name.to_string(), width, address });
        }
        if !self.default.is_empty() && self.default.len() != usize::from(width) {
            return Err(DescriptionErrorKind::Default { name: name.to_string(), bytes: self.default.len(), width });
        }
        let decoding = match self.codes {
            Some(table) => ValueDecoding::Choice(
                table.rows().iter().map(|(code, name)| ((*code).into(), Name::new(*name))).collect(),
            ),
            None => self.decode,
        };
        if let ValueDecoding::Bits(bits) = &decoding
            && let Some((bit, _)) = bits.iter().find(|(bit, _)| *bit >= width * 8)
        {
            return Err(DescriptionErrorKind::Bit { name: name.to_string(), bit: *bit, width });
        }
        if let ValueDecoding::Scaled { factor, offset } = decoding
            && !(factor.is_finite() && offset.is_finite())
        {
            return Err(DescriptionErrorKind::NotFinite(name.to_string()));
        }
        if !self.access.is_writable() && !self.saves.is_empty() {
            return Err(DescriptionErrorKind::SavesOnReadOnly(name.to_string()));
        }
        Ok(Register {
            address,
            width,
            name,
            role: self.role,
            access: self.access,
            order: self.order,
            default: self.default,
            decoding,
            unit: self.unit,
            saves: self.saves,
            since: firmware(self.since),
        })
    }
}

impl AreaRow {
    fn validate(self) -> Result<Area, DescriptionErrorKind> {
        let (first, last) = self.banks;
        if first > last {
            return Err(DescriptionErrorKind::Banks { name: self.name.to_string(), first, last });
        }
        Ok(Area { name: self.name, first, last, access: self.access, open: self.open })
    }
}

impl ProcedureRow {
    fn validate(self) -> Result<Procedure, DescriptionErrorKind> {
        Ok(Procedure {
            kind: self.kind,
            mode: self.mode,
            command: self.command.try_into()?,
            status: self.status.try_into()?,
            data: self.data.map(RegisterAddress::try_from).transpose()?,
            since: firmware(self.since),
        })
    }
}

fn firmware((major, minor, patch): (u8, u8, u8)) -> Firmware {
    Firmware::new(major, minor, patch)
}

/// A row of a description file. It lists what no other row may contain, such as its register addresses.
trait Row {
    fn unique_items(&self) -> Vec<UniqueItem>;
}

impl Row for Register {
    fn unique_items(&self) -> Vec<UniqueItem> {
        let bytes = (0..self.width).filter_map(|at| self.address.offset_by(at)).map(UniqueItem::Register);
        let role = self.role.map(UniqueItem::Role);
        bytes.chain(role).collect()
    }
}

impl Row for BankRow {
    fn unique_items(&self) -> Vec<UniqueItem> {
        vec![UniqueItem::Bank(self.bank)]
    }
}

impl Row for Area {
    fn unique_items(&self) -> Vec<UniqueItem> {
        (self.first..=self.last).map(UniqueItem::Bank).collect()
    }
}

impl Row for Procedure {
    fn unique_items(&self) -> Vec<UniqueItem> {
        vec![UniqueItem::Procedure(self.kind)]
    }
}

/// A list of rows without duplicate items.
struct Rows<T>(Vec<T>);

impl<T> Default for Rows<T> {
    fn default() -> Self {
        Rows(Vec::new())
    }
}

impl<'de, T: Deserialize<'de> + Row> Deserialize<'de> for Rows<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(RowsVisitor(std::marker::PhantomData))
    }
}

struct RowsVisitor<T>(std::marker::PhantomData<T>);

impl<'de, T: Deserialize<'de> + Row> Visitor<'de> for RowsVisitor<T> {
    type Value = Rows<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of rows")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Rows<T>, A::Error> {
        let mut claimed = BTreeSet::new();
        let mut rows = Vec::new();
        while let Some(row) = list.next_element::<T>()? {
            for claim in row.unique_items() {
                if claimed.contains(&claim) {
                    return Err(description_error::store_error(DescriptionErrorKind::Twice(claim)));
                }
                claimed.insert(claim);
            }
            rows.push(row);
        }
        Ok(Rows(rows))
    }
}
