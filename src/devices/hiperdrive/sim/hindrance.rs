//! Injected faults of writing a parameter.

use super::parameters::Refused;
use crate::devices::hiperdrive::protocol::ParameterNumber;

/// The kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hindrance {
    /// Access is refused: not in this state.
    Refused,
    /// The connection is lost after the first access, which takes effect; nothing more gets through.
    CutOff,
}

/// The present fault, and whether the line was lost by it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Hindered {
    what: Option<(ParameterNumber, Hindrance)>,
    is_cut_off: bool,
}

impl Hindered {
    pub(super) const fn by(what: Option<(ParameterNumber, Hindrance)>) -> Self {
        Hindered { what, is_cut_off: false }
    }

    pub(super) const fn is_cut_off(&self) -> bool {
        self.is_cut_off
    }

    /// A parameter is about to be written.
    pub(super) fn write(&mut self, number: ParameterNumber) -> Result<(), Refused> {
        match self.what.filter(|(own, _)| *own == number) {
            Some((_, Hindrance::Refused)) => return Err(Refused::State),
            Some((_, Hindrance::CutOff)) => self.is_cut_off = true,
            None => {}
        }
        Ok(())
    }
}
