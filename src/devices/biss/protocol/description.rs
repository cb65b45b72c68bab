//! Encoder descriptions, which define the frame, registers, data areas and procedures of a type of encoder. The
//! built-in descriptions are RON files in `assets/devices/biss/`, and users can add files. This module does not open
//! any files.

mod codes;
mod description_error;
mod file;
mod german;
mod name;
mod register;
#[cfg(test)]
mod tests;

use std::fmt;

pub use description_error::{DescriptionErrorKind, UniqueItem};
pub use name::Name;
pub use register::{Access, Area, DecodedValue, Register, Role, ValueDecoding};

use super::address::RegisterAddress;
use super::procedure::ProcedureKind;
use super::single_cycle::Layout;
use super::status::{Firmware, ProfileId};

/// The description of an encoder type.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    name: String,
    identity: Option<Identity>,
    layout: Option<Layout>,
    lock: Option<Lock>,
    registers: Vec<Register>,
    banks: Vec<(u8, Name)>,
    areas: Vec<Area>,
    procedures: Vec<Procedure>,
}

/// The identity reported by an encoder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Profile ID (registers 42h and 43h).
    pub profile: ProfileId,
    /// Manufacturer ID (registers 7Eh and 7Fh).
    pub manufacturer: [u8; 2],
    /// Device ID (registers 78h to 7Dh).
    pub device_id: [u8; 6],
}

/// A mismatch between an encoder's identity and a description.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the encoder reports {found}, but the description \"{name}\" is for {expected}")]
pub struct IdentityMismatch {
    /// Name of the description.
    pub name: String,
    /// Identity in the description.
    pub expected: Identity,
    /// Identity reported by the encoder.
    pub found: Identity,
}

/// The lock that must be opened before a device mode can be selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lock {
    /// Address of the password register.
    pub password_at: RegisterAddress,
    /// Password that opens the lock.
    pub password: u8,
    /// Address of the device mode register.
    pub mode_at: RegisterAddress,
}

/// The registers of a guided procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Procedure {
    /// Kind of procedure.
    pub kind: ProcedureKind,
    /// Required device mode.
    pub mode: u8,
    /// Address of the command register.
    pub command: RegisterAddress,
    /// Address of the status register.
    pub status: RegisterAddress,
    /// First additional register, if any. It holds the error code of a Wiegand test, followed by the results, or the
    /// value of a preset.
    pub data: Option<RegisterAddress>,
    /// Oldest firmware that supports the procedure.
    pub since: Firmware,
}

/// An error in a description file, with its position.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}, column {column}: {problem}")]
pub struct DescriptionError {
    /// Name of the description file.
    pub file: String,
    /// Line number, counted from 1.
    pub line: usize,
    /// Column number, counted from 1.
    pub column: usize,
    /// Kind of error.
    pub problem: DescriptionErrorKind,
}

/// All known encoder descriptions, most specific first.
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptions(Vec<Description>);

impl Description {
    /// Parses a description. `file` is the name used in error messages.
    ///
    /// # Errors
    /// Returns an error with line and column if the text is not valid RON, a key is unknown or missing, a number is out
    /// of range, or registers overlap.
    pub fn parse(file: &str, text: &str) -> Result<Self, DescriptionError> {
        file::parse(text).map_err(|(place, what)| DescriptionError {
            file: file.to_owned(),
            line: place.line,
            column: place.col,
            problem: what,
        })
    }

    /// Returns the name of the described encoder.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the identity of the described encoders, or `None` if the description is generic.
    pub const fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Returns the layout of position frames, or `None` if the encoder's data sheet or the user must provide it.
    pub const fn layout(&self) -> Option<&Layout> {
        self.layout.as_ref()
    }

    /// Returns the lock that guards the device modes, or `None` if they are not locked.
    pub const fn lock(&self) -> Option<Lock> {
        self.lock
    }

    /// Returns the registers in the order of the file.
    pub fn registers(&self) -> &[Register] {
        &self.registers
    }

    /// Returns the data areas.
    pub fn areas(&self) -> &[Area] {
        &self.areas
    }

    /// Returns the name of a bank from the area to which it belongs, or from the list of banks.
    pub fn bank_name(&self, bank: u8) -> Option<&Name> {
        let area = self.areas.iter().find(|area| area.contains(bank)).map(|area| &area.name);
        area.or_else(|| self.banks.iter().find(|(own, _)| *own == bank).map(|(_, name)| name))
    }

    /// Returns the guided procedures.
    pub fn procedures(&self) -> &[Procedure] {
        &self.procedures
    }

    /// Returns the register with the given role, if any.
    pub fn register_with_role(&self, role: Role) -> Option<&Register> {
        self.registers.iter().find(|register| register.role == Some(role))
    }

    /// Returns the register that contains the byte at an address, if any.
    pub fn register_at(&self, address: RegisterAddress) -> Option<&Register> {
        self.registers.iter().find(|register| register.contains(address))
    }

    /// Returns the area that contains the byte at an address, if any.
    pub fn area_at(&self, address: RegisterAddress) -> Option<&Area> {
        self.areas.iter().find(|area| address.bank().is_some_and(|bank| area.contains(bank)))
    }

    /// Returns the procedure of the given kind, if the encoder supports it.
    pub fn procedure(&self, kind: ProcedureKind) -> Option<&Procedure> {
        self.procedures.iter().find(|procedure| procedure.kind == kind)
    }

    /// Returns the permitted access to the byte at an address, or `None` if the byte is not described.
    pub fn access_at(&self, address: RegisterAddress) -> Option<Access> {
        self.register_at(address)
            .map(|register| register.access)
            .or_else(|| self.area_at(address).map(|area| area.access))
    }

    /// Checks whether an encoder is of the described kind.
    ///
    /// # Errors
    /// Returns an [`IdentityMismatch`] with both identities if the encoder is of another kind.
    pub fn check_identity(&self, found: &Identity) -> Result<(), IdentityMismatch> {
        match &self.identity {
            Some(expected) if expected != found => {
                Err(IdentityMismatch { name: self.name.clone(), expected: expected.clone(), found: found.clone() })
            }
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hex = crate::bits::hex;
        write!(
            f,
            "profile {}, manufacturer {}, device ID {}",
            self.profile,
            hex(&self.manufacturer),
            hex(&self.device_id)
        )
    }
}

impl Descriptions {
    /// The descriptions that are shipped with the program, each with its file name.
    pub const BUILT_IN: [(&'static str, &'static str); 2] = [
        ("posital_kit.ron", include_str!("../../../../assets/devices/biss/posital_kit.ron")),
        ("unknown.ron", include_str!("../../../../assets/devices/biss/unknown.ron")),
    ];

    /// Parses description files. A file with an error does not affect the others.
    pub fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> (Self, Vec<DescriptionError>) {
        let mut errors = Vec::new();
        let mut read = Vec::new();
        for (file, text) in files {
            match Description::parse(file, text) {
                Ok(description) => read.push(description),
                Err(error) => errors.push(error),
            }
        }
        // Specific descriptions precede those that apply to any encoder.
        read.sort_by_key(|description| description.identity.is_none());
        (Descriptions(read), errors)
    }

    /// Creates the set of built-in descriptions.
    pub fn built_in() -> Self {
        // A test checks that the built-in files can be read.
        Self::read(Self::BUILT_IN).0
    }

    /// Adds `others` to the descriptions. They take precedence for the same encoder.
    #[must_use]
    pub fn merged_with(self, others: Descriptions) -> Self {
        let mut all = others.0;
        all.extend(self.0);
        all.sort_by_key(|description| description.identity.is_none());
        Descriptions(all)
    }

    /// Returns the description for the given identity. A description of this type takes precedence over a generic one.
    pub fn find(&self, identity: &Identity) -> Option<&Description> {
        self.0.iter().find(|description| description.check_identity(identity).is_ok())
    }

    /// Returns the description with the given name, if any.
    pub fn find_by_name(&self, name: &str) -> Option<&Description> {
        self.0.iter().find(|description| description.name == name)
    }

    /// Returns an iterator over the descriptions, most specific first.
    pub fn iter(&self) -> impl Iterator<Item = &Description> {
        self.0.iter()
    }
}
