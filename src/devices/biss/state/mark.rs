//! Validity of the last position. It is either part of the position, or taken from the error and warning registers that
//! were read with the last status.

use super::encoder::Encoder;
use crate::devices::biss::procedures::FlagRegister;

/// A mark that shows the validity of a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValidityMark {
    Invalid,
    Warned,
}

impl Encoder {
    /// Returns the mark for the last position. Returns `None` without a position, and for a valid position without a
    /// warning.
    pub fn position_mark(&self) -> Option<ValidityMark> {
        let reading = self.record.last()?;
        let status = self.status.as_ref();
        let is_set = |own: bool, bits: Option<&FlagRegister>| own || bits.is_some_and(|bits| bits.raw != 0);
        let errors = status.and_then(|own| own.errors.as_ref()).filter(|_| reading.error.is_none());
        let warnings = status.and_then(|own| own.warnings.as_ref()).filter(|_| reading.warning.is_none());
        if is_set(!reading.is_valid(), errors) {
            Some(ValidityMark::Invalid)
        } else {
            is_set(reading.warning == Some(true), warnings).then_some(ValidityMark::Warned)
        }
    }
}
