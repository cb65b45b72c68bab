//! Faults injected into the write of a parameter.

use super::parameters::ParameterError;
use crate::devices::hiperdrive::protocol::ParameterNumber;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteFault {
    /// The write is rejected, as if it were not possible in this state.
    Refused,
    /// The write takes effect, but the line is lost afterwards.
    CutOff,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ActiveWriteFault {
    fault: Option<(ParameterNumber, WriteFault)>,
    is_cut_off: bool,
}

impl ActiveWriteFault {
    pub(super) const fn new(what: Option<(ParameterNumber, WriteFault)>) -> Self {
        ActiveWriteFault { fault: what, is_cut_off: false }
    }

    pub(super) const fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }

    pub(super) fn write(&mut self, number: ParameterNumber) -> Result<(), ParameterError> {
        match self.fault.filter(|(own, _)| *own == number) {
            Some((_, WriteFault::Refused)) => return Err(ParameterError::State),
            Some((_, WriteFault::CutOff)) => self.is_cut_off = true,
            None => {}
        }
        Ok(())
    }
}
