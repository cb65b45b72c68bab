//! What is remembered of a device's drives beside what they keep themselves: the spindles behind them, what their positions
//! are shown in, and limits that nobody has looked at since their scaling was changed.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::ruler::Measure;
use super::unit::Unit;
use crate::protocol::hiperdrive::{DriveNumber, Length};

/// Of one adapter or hub.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Remembered {
    /// Nanometres a turn, by the numbers of the drives.
    pitches: BTreeMap<u8, u64>,
    /// What positions are shown in.
    measure: Measure,
    /// Drives whose limits nobody has confirmed.
    unconfirmed: Vec<u8>,
}

impl Unit {
    /// Under what name it is remembered; `None` before it was read.
    pub(in crate::app) fn remembered_as(&self) -> Option<String> {
        let own = self.identity()?;
        let kind = if self.session.is_virtual() { "virtual " } else { "" };
        Some(format!("{kind}{} {}", own.category, own.serial_number))
    }

    /// What is to be remembered.
    pub(in crate::app) fn remembered(&self) -> Remembered {
        Remembered {
            pitches: self.pitches.iter().map(|(drive, pitch)| (drive.get(), pitch.nanometres)).collect(),
            measure: self.measure,
            unconfirmed: self.moves.unconfirmed().iter().map(|drive| drive.get()).collect(),
        }
    }

    /// Takes what was remembered, once for a device; true where there is something new to remember since.
    pub(in crate::app) fn take_remembered(&mut self, found: Option<&Remembered>) -> bool {
        if std::mem::replace(&mut self.is_remembered, true) {
            return found.cloned().unwrap_or_default() != self.remembered();
        }
        if let Some(found) = found {
            for (drive, nanometres) in &found.pitches {
                if let Some(drive) = DriveNumber::new(*drive) {
                    self.pitches.entry(drive).or_insert(Length { nanometres: *nanometres });
                }
            }
            self.measure = found.measure;
            found.unconfirmed.iter().copied().filter_map(DriveNumber::new).for_each(|own| self.moves.unconfirm(own));
        }
        false
    }
}
