//! Errors in a description file. The RON parser passes on only the message of an error, so the error itself is stored
//! here until the parser has reported its position.

use std::cell::Cell;

use serde::de::Error;

use super::super::address::RegisterAddress;
use super::super::procedure::ProcedureKind;
use super::super::single_cycle::LayoutError;
use super::register::{Register, Role};

/// The kind of error in a description file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DescriptionErrorKind {
    /// The file does not have the form of a description. The string is the message of the RON parser.
    #[error("{0}")]
    Form(String),
    /// The address is not valid for a direct register.
    #[error("direct(0x{0:02X}): the address of a direct register must be from 0x40 to 0x7F")]
    Direct(u8),
    /// The offset is not valid for a register in a bank.
    #[error("bank(0x{bank:02X}, 0x{offset:02X}): the offset of a register in a bank must be from 0x00 to 0x3F")]
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
    #[error("\"{name}\": a register of {width} bytes at {address} extends past the end of the bank")]
    BeyondBank {
        /// Name of the register.
        name: String,
        /// Register width in bytes.
        width: u8,
        /// Address of the first byte of the register.
        address: RegisterAddress,
    },
    /// The number of default bytes differs from the width of the register.
    #[error("\"{name}\": the number of default bytes ({bytes}) does not match the register width ({width})")]
    Default {
        /// Name of the register.
        name: String,
        /// Number of default bytes.
        bytes: usize,
        /// Register width in bytes.
        width: u8,
    },
    /// The bit number exceeds the width of the register.
    #[error("\"{name}\": bit {bit} is outside the register (width in bytes: {width})")]
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
    NotFinite(String),
    /// A register that cannot be written has `saves` values, which would trigger a save.
    #[error("\"{0}\": a read-only register cannot have \"saves\" values")]
    SavesOnReadOnly(String),
    /// The first bank of an area comes after its last bank.
    #[error("\"{name}\": the first bank (0x{first:02X}) comes after the last bank (0x{last:02X})")]
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
    /// An item occurs in more than one row.
    #[error("{0} is defined more than once")]
    Twice(UniqueItem),
    /// The German name is empty.
    #[error("\"{0}\": the German name is empty")]
    GermanEmpty(String),
    /// A German name is listed for an English name that the description does not use.
    #[error("german: the description does not contain the name \"{0}\"")]
    UnusedGermanName(String),
}

/// An item that may occur only once in a description.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum UniqueItem {
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
    static LAST_ERROR: Cell<Option<DescriptionErrorKind>> = const { Cell::new(None) };
}

/// Stores an error, and returns its message for the RON parser, which adds the position.
pub(super) fn store_error<E: Error>(flaw: impl Into<DescriptionErrorKind>) -> E {
    let flaw = flaw.into();
    let words = E::custom(&flaw);
    LAST_ERROR.set(Some(flaw));
    words
}

/// Takes the last error stored on the current thread.
pub(super) fn take_error() -> Option<DescriptionErrorKind> {
    LAST_ERROR.take()
}
