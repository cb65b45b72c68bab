//! Mistakes in a description's file, as facts. The reader of RON passes on sentences alone, so that a flaw waits here until
//! it has told where it was.

use std::cell::Cell;

use serde::de::Error;

use super::super::address::RegisterAddress;
use super::super::procedure::ProcedureKind;
use super::super::single_cycle::LayoutError;
use super::register::{Register, Role};

/// A mistake in a description.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Flaw {
    /// Not the form of a description, as the reader of RON says.
    #[error("{0}")]
    Form(String),
    /// No direct register.
    #[error("direct(0x{0:02X}): a direct register is from 0x40 to 0x7F")]
    Direct(u8),
    /// No register of a bank.
    #[error("bank(0x{bank:02X}, 0x{offset:02X}): a bank has registers from 0x00 to 0x3F")]
    Banked {
        /// The bank.
        bank: u8,
        /// The place in it.
        offset: u8,
    },
    /// A register that is too wide, or has no byte.
    #[error("\"{name}\": a register has 1 to {} bytes, not {width}", Register::MAX_WIDTH)]
    Width {
        /// The register's name.
        name: String,
        /// Its bytes.
        width: u8,
    },
    /// A register that leaves its bank.
    #[error("\"{name}\": {width} bytes from {address} on do not fit into the bank")]
    BeyondBank {
        /// The register's name.
        name: String,
        /// Its bytes.
        width: u8,
        /// Its first byte.
        address: RegisterAddress,
    },
    /// Not as many default bytes as the register is wide.
    #[error("\"{name}\": {bytes} default bytes for a width of {width}")]
    Default {
        /// The register's name.
        name: String,
        /// Bytes as delivered.
        bytes: usize,
        /// Its bytes.
        width: u8,
    },
    /// A bit that the register does not have.
    #[error("\"{name}\": there is no bit {bit} in a width of {width}")]
    Bit {
        /// The register's name.
        name: String,
        /// The bit.
        bit: u8,
        /// Its bytes.
        width: u8,
    },
    /// A factor or an offset that is no number.
    #[error("\"{0}\": factor and offset must be finite numbers")]
    Endless(String),
    /// Values that save something in a register that is not written.
    #[error("\"{0}\": a register that is not written saves nothing")]
    SavesNothing(String),
    /// Banks of an area in the wrong order.
    #[error("\"{name}\": bank 0x{first:02X} comes after bank 0x{last:02X}")]
    Banks {
        /// The area's name.
        name: String,
        /// The first bank.
        first: u8,
        /// The last bank.
        last: u8,
    },
    /// A frame that cannot be.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// Something that only one row may have.
    #[error("{0} stands here for the second time")]
    Twice(Claim),
    /// A name without a German text.
    #[error("\"{0}\": the German name is empty")]
    GermanEmpty(String),
    /// A German text for what has no such name.
    #[error("german: nothing is called \"{0}\" here")]
    GermanNeedless(String),
}

/// Something that only one row may have.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum Claim {
    /// A byte.
    #[error("register {0}")]
    Register(RegisterAddress),
    /// A role.
    #[error("role {0:?}")]
    Role(Role),
    /// A bank.
    #[error("bank 0x{0:02X}")]
    Bank(u8),
    /// A procedure.
    #[error("procedure {0:?}")]
    Procedure(ProcedureKind),
    /// A name in the list of German ones.
    #[error("\"{0}\"")]
    Name(String),
}

thread_local! {
    static FOUND: Cell<Option<Flaw>> = const { Cell::new(None) };
}

/// Tells the reader of RON about a flaw: it adds where that is.
pub(super) fn found<E: Error>(flaw: impl Into<Flaw>) -> E {
    let flaw = flaw.into();
    let words = E::custom(&flaw);
    FOUND.set(Some(flaw));
    words
}

/// Takes the flaw that was found last on this thread.
pub(super) fn take() -> Option<Flaw> {
    FOUND.take()
}
