//! The description of an encoder: a file that anyone can write (RON, `assets/devices/biss/`), with the frame, the
//! registers, the areas of plain data and the procedures of one kind of encoder. It is data: nothing is opened here.

mod codes;
mod file;
mod flaw;
mod german;
mod name;
mod register;
#[cfg(test)]
mod tests;

use std::fmt;

pub use flaw::{Claim, Flaw};
pub use name::Name;
pub use register::{Access, Area, Decoded, Decoding, Register, Role};

use super::address::RegisterAddress;
use super::procedure::ProcedureKind;
use super::single_cycle::Layout;
use super::status::{Firmware, ProfileId};

/// A kind of encoder.
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

/// The identity that an encoder reports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// 42h and 43h.
    pub profile: ProfileId,
    /// 7Eh and 7Fh.
    pub manufacturer: [u8; 2],
    /// 78h…7Dh.
    pub device_id: [u8; 6],
}

/// An encoder is not of the kind that is described.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the encoder says {found}; the description \"{name}\" is for {expected}")]
pub struct Mismatch {
    /// The description's name.
    pub name: String,
    /// The identity in the description.
    pub expected: Identity,
    /// The identity of the encoder.
    pub found: Identity,
}

/// The lock that has to be opened before a device mode can be selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lock {
    /// Register of the password.
    pub password_at: RegisterAddress,
    /// The password.
    pub password: u8,
    /// Register of the device mode.
    pub mode_at: RegisterAddress,
}

/// The registers of a guided procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Procedure {
    /// The procedure.
    pub kind: ProcedureKind,
    /// The device mode that it needs.
    pub mode: u8,
    /// Register of its commands.
    pub command: RegisterAddress,
    /// Register of its status.
    pub status: RegisterAddress,
    /// The first of its further registers: the error code and results of a Wiegand test, the value of a preset.
    pub data: Option<RegisterAddress>,
    /// Older firmware has no such procedure.
    pub since: Firmware,
}

/// An error in a description, with its position.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}, line {line}, column {column}: {problem}")]
pub struct DescriptionError {
    /// The file's name as given.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column, counted from 1.
    pub column: usize,
    /// The problem.
    pub problem: Flaw,
}

/// All known kinds of encoders, the most specific first.
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptions(Vec<Description>);

impl Description {
    /// Parses a description. `file` is its name for errors.
    ///
    /// # Errors
    /// Returns line and column: text that is not RON, unknown or missing keys, numbers outside their range, overlapping
    /// registers.
    pub fn parse(file: &str, text: &str) -> Result<Self, DescriptionError> {
        file::parse(text).map_err(|(place, what)| DescriptionError {
            file: file.to_owned(),
            line: place.line,
            column: place.col,
            problem: what,
        })
    }

    /// Returns the name of the encoder.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the identity of encoders of this kind; `None` for any.
    pub const fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Returns the frame of the position data; `None` if the encoder's data sheet or the user has to supply it.
    pub const fn layout(&self) -> Option<&Layout> {
        self.layout.as_ref()
    }

    /// Returns the lock of the device modes; `None` if there is none.
    pub const fn lock(&self) -> Option<Lock> {
        self.lock
    }

    /// Returns the registers, in the order of the file.
    pub fn registers(&self) -> &[Register] {
        &self.registers
    }

    /// Returns the banks of plain data.
    pub fn areas(&self) -> &[Area] {
        &self.areas
    }

    /// Returns the name of a bank: from its area, or from the list of banks.
    pub fn bank_name(&self, bank: u8) -> Option<&Name> {
        let area = self.areas.iter().find(|area| area.contains(bank)).map(|area| &area.name);
        area.or_else(|| self.banks.iter().find(|(own, _)| *own == bank).map(|(_, name)| name))
    }

    /// Returns the guided procedures.
    pub fn procedures(&self) -> &[Procedure] {
        &self.procedures
    }

    /// Returns the register that plays a role.
    pub fn with_role(&self, role: Role) -> Option<&Register> {
        self.registers.iter().find(|register| register.role == Some(role))
    }

    /// Returns the register to which a byte belongs.
    pub fn at(&self, address: RegisterAddress) -> Option<&Register> {
        self.registers.iter().find(|register| register.contains(address))
    }

    /// Returns the area to which a byte belongs.
    pub fn area_at(&self, address: RegisterAddress) -> Option<&Area> {
        self.areas.iter().find(|area| address.bank().is_some_and(|bank| area.contains(bank)))
    }

    /// Returns a procedure, if the encoder has it.
    pub fn procedure(&self, kind: ProcedureKind) -> Option<&Procedure> {
        self.procedures.iter().find(|procedure| procedure.kind == kind)
    }

    /// Returns the access to the byte at an address.
    pub fn access(&self, address: RegisterAddress) -> Option<Access> {
        self.at(address).map(|register| register.access).or_else(|| self.area_at(address).map(|area| area.access))
    }

    /// Checks whether an encoder is of this kind.
    ///
    /// # Errors
    /// [`Mismatch`], with both sides.
    pub fn check(&self, found: &Identity) -> Result<(), Mismatch> {
        match &self.identity {
            Some(expected) if expected != found => {
                Err(Mismatch { name: self.name.clone(), expected: expected.clone(), found: found.clone() })
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
    /// The descriptions that ship with the program, with their files' names.
    pub const BUILT_IN: [(&'static str, &'static str); 2] = [
        ("posital_kit.ron", include_str!("../../../../assets/devices/biss/posital_kit.ron")),
        ("unknown.ron", include_str!("../../../../assets/devices/biss/unknown.ron")),
    ];

    /// Reads files; returns the reason for each that cannot be used, which does not affect the others.
    pub fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> (Self, Vec<DescriptionError>) {
        let mut errors = Vec::new();
        let mut read = Vec::new();
        for (file, text) in files {
            match Description::parse(file, text) {
                Ok(description) => read.push(description),
                Err(error) => errors.push(error),
            }
        }
        // Those for one kind of encoder before those for any.
        read.sort_by_key(|description| description.identity.is_none());
        (Descriptions(read), errors)
    }

    /// Creates the built-in ones.
    pub fn built_in() -> Self {
        // A test checks that they can be read.
        Self::read(Self::BUILT_IN).0
    }

    /// Returns these descriptions with those of `others`, which take precedence for the same encoder.
    #[must_use]
    pub fn overlaid_with(self, others: Descriptions) -> Self {
        let mut all = others.0;
        all.extend(self.0);
        all.sort_by_key(|description| description.identity.is_none());
        Descriptions(all)
    }

    /// Returns the description of an encoder with this identity: its own, otherwise one for any.
    pub fn find(&self, identity: &Identity) -> Option<&Description> {
        self.0.iter().find(|description| description.check(identity).is_ok())
    }

    /// Returns the description with this name.
    pub fn named(&self, name: &str) -> Option<&Description> {
        self.0.iter().find(|description| description.name == name)
    }

    /// Returns all of them.
    pub fn iter(&self) -> impl Iterator<Item = &Description> {
        self.0.iter()
    }
}
