//! Mistakes in a description file. The RON parser only passes on error messages, so a flaw is kept in this module until
//! the parser has reported its position.

use std::cell::Cell;

use serde::de::Error;

use super::super::address::RegisterAddress;
use super::super::procedure::ProcedureKind;
use super::super::single_cycle::LayoutError;
use super::register::{Register, Role};

/// A mistake in a description file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DescriptionErrorKind {
    /// The file does not have the form of a description. Contains the message of the RON parser.
    #[error("{0}")]
    Form(String),
    /// The address is not valid for a direct register.
    #[error("direct(0x{0:02X}): a direct register is from 0x40 to 0x7F")]
    Direct(u8),
    /// The offset is not valid for a register in a bank.
    #[error("bank(0x{bank:02X}, 0x{offset:02X}): a bank has registers from 0x00 to 0x3F")]
    Banked {
        /// Number of the bank.
        bank: u8,
        /// Offset within the bank.
        offset: u8,
    },
    /// The register is too wide or has a width of 0 bytes.
    #[error("\"{name}\": a register has 1 to {} bytes, not {width}", Register::MAX_WIDTH)]
    Width {
        /// Name of the register.
        name: String,
        /// Register width in bytes.
        width: u8,
    },
    /// The register extends beyond its bank.
    #[error("\"{name}\": {width} bytes from {address} on do not fit into the bank")]
    BeyondBank {
        /// Name of the register.
        name: String,
        /// Register width in bytes.
        width: u8,
        /// Address of the first byte of the register.
        address: RegisterAddress,
    },
    /// The number of default bytes differs from the width of the register.
    #[error("\"{name}\": {bytes} default bytes for a width of {width}")]
    Default {
        /// Name of the register.
        name: String,
        /// Number of default bytes.
        bytes: usize,
        /// Register width in bytes.
        width: u8,
    },
    /// The bit number exceeds the width of the register.
    #[error("\"{name}\": there is no bit {bit} in a width of {width}")]
    Bit {
        /// Name of the register.
        name: String,
        /// Number of the bit.
        bit: u8,
        /// Register width in bytes.
        width: u8,
    },
    /// The factor or offset is not a finite number.
    #[error("\"{0}\": factor and offset must be finite numbers")]
    Endless(String),
    /// Values are declared to save something, but the register cannot be written.
    #[error("\"{0}\": a register that is not written saves nothing")]
    SavesNothing(String),
    /// The first bank of an area comes after its last.
    #[error("\"{name}\": bank 0x{first:02X} comes after bank 0x{last:02X}")]
    Banks {
        /// Name of the area.
        name: String,
        /// First bank of the area.
        first: u8,
        /// Last bank of the area.
        last: u8,
    },
    /// The frame layout is impossible.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// An item is claimed by more than one row.
    #[error("{0} stands here for the second time")]
    Twice(Claim),
    /// The German name is empty.
    #[error("\"{0}\": the German name is empty")]
    GermanEmpty(String),
    /// A German name is given for an English name that does not occur in the description.
    #[error("german: nothing is called \"{0}\" here")]
    GermanNeedless(String),
}

/// An item that only one row of a description may claim.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum Claim {
    /// A register byte.
    #[error("register {0}")]
    Register(RegisterAddress),
    /// A register role.
    #[error("role {0:?}")]
    Role(Role),
    /// A bank number.
    #[error("bank 0x{0:02X}")]
    Bank(u8),
    /// A procedure kind.
    #[error("procedure {0:?}")]
    Procedure(ProcedureKind),
    /// Name in the list of German names.
    #[error("\"{0}\"")]
    Name(String),
}

thread_local! {
    static FOUND: Cell<Option<DescriptionErrorKind>> = const { Cell::new(None) };
}

/// Records a flaw and returns an error for the RON parser, which adds the position.
pub(super) fn found<E: Error>(flaw: impl Into<DescriptionErrorKind>) -> E {
    let flaw = flaw.into();
    let words = E::custom(&flaw);
    FOUND.set(Some(flaw));
    words
}

/// Takes the last flaw found on the current thread.
pub(super) fn take() -> Option<DescriptionErrorKind> {
    FOUND.take()
}
