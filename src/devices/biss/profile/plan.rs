//! The operations that change an encoder, their cost in write cycles, and the values on which a plan is based.

use super::{Bank, BissProfile, RegisterRange};
use crate::devices::biss::protocol::{Area, PositionFilter, PresetCommand, PresetValue, RegisterAddress};
use crate::profile::{Operation, Plan};

/// A plan of writes to a BiSS encoder.
pub type BissPlan = Plan<Base, Op>;

/// The current values on which a plan is based, which include all readable values that it changes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Data banks that the plan changes.
    pub banks: Vec<Bank>,
    /// Active filter.
    pub filter: Option<PositionFilter>,
    /// Preset value stored in the encoder.
    pub preset: Option<PresetValue>,
    /// Individual registers that the plan changes, with their current values.
    pub registers: Vec<(RegisterAddress, u8)>,
}

/// An operation in a plan. It enters the device mode that it needs, and leaves it at the end.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Writes registers of one area and saves them together (manual 6.5).
    StoreData {
        /// Area to which the registers belong. Its `open` command gives write access.
        area: Area,
        /// Register changes in ascending order of address.
        registers: Vec<RegisterChange>,
    },
    /// Stores another preset value without setting the position yet (manual 6.7).
    StorePreset {
        /// Preset value stored before the operation.
        from: PresetValue,
        /// Preset value stored by the operation.
        to: PresetValue,
    },
    /// Sets the current shaft position to the stored preset value (manual 6.7).
    FirePreset {
        /// Parts of the position that are set.
        parts: PresetParts,
        /// Stored preset value to which the position is set.
        value: PresetValue,
    },
    /// Selects the position filter (manual 6.6).
    SelectFilter {
        /// Filter that is active before the operation.
        from: PositionFilter,
        /// Filter to select.
        to: PositionFilter,
    },
    /// Calibrates the encoder in guided steps (manual 6.4).
    Calibrate,
    /// Tests the Wiegand sensor in guided steps (manual 6.3).
    WiegandTest {
        /// Whether to save the result in the encoder.
        save: bool,
    },
    /// Writes a register directly, outside the procedures.
    WriteRegister {
        /// Address of the register.
        address: RegisterAddress,
        /// Old value, or `None` if the register cannot be read.
        old: Option<u8>,
        /// Value to write.
        new: u8,
        /// Number of persistent writes that the operation needs.
        cycles: u8,
    },
}

/// A register whose value changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RegisterChange {
    /// Address of the register.
    pub address: RegisterAddress,
    /// Old value.
    pub old: u8,
    /// New value.
    pub new: u8,
}

/// The parts of the position that a preset sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PresetParts {
    /// Singleturn and multiturn position.
    Both,
    /// Position within the revolution only.
    Singleturn,
    /// Number of revolutions only.
    Multiturn,
}

impl PresetParts {
    /// Returns the command that presets the selected parts.
    pub const fn command(self) -> PresetCommand {
        match self {
            PresetParts::Both => PresetCommand::Both,
            PresetParts::Singleturn => PresetCommand::Singleturn,
            PresetParts::Multiturn => PresetCommand::Multiturn,
        }
    }

    /// Returns whether the position within the revolution is set.
    pub const fn includes_singleturn(self) -> bool {
        matches!(self, PresetParts::Both | PresetParts::Singleturn)
    }

    /// Returns whether the number of revolutions is set.
    pub const fn includes_multiturn(self) -> bool {
        matches!(self, PresetParts::Both | PresetParts::Multiturn)
    }
}

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        match self {
            Op::StoreData { .. }
            | Op::StorePreset { .. }
            | Op::FirePreset { .. }
            | Op::SelectFilter { .. }
            | Op::Calibrate => 1,
            Op::WiegandTest { save } => u64::from(*save),
            Op::WriteRegister { cycles, .. } => u64::from(*cycles),
        }
    }
}

impl Op {
    /// Returns whether the operation needs a motor that turns the shaft.
    pub fn needs_motor(&self) -> bool {
        matches!(self, Op::Calibrate | Op::WiegandTest { .. })
    }

    /// Returns the register ranges that the operation changes, in the notation of the `read` command. Empty if no
    /// readable register changes.
    pub fn register_ranges(&self) -> Vec<RegisterRange> {
        let known = |text: &str| text.parse().into_iter().collect();
        match self {
            Op::StoreData { registers, .. } => {
                RegisterRange::from_addresses(registers.iter().map(|change| change.address))
            }
            Op::StorePreset { .. } => known(BissProfile::PRESET),
            Op::SelectFilter { .. } => known(BissProfile::FILTER),
            Op::WriteRegister { address, .. } => vec![RegisterRange::single(*address)],
            Op::FirePreset { .. } | Op::Calibrate | Op::WiegandTest { .. } => Vec::new(),
        }
    }

    /// Returns the name of what the operation changes. For readable registers, the `read` command accepts this name.
    pub fn item_name(&self) -> String {
        match self {
            Op::FirePreset { .. } => "position".to_owned(),
            Op::Calibrate => "calibration".to_owned(),
            Op::WiegandTest { .. } => "Wiegand test".to_owned(),
            op => op.register_ranges().iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        }
    }

    /// Returns how many items of a comparison the operation changes. For a data area, this is the number of changed
    /// registers, and for any other operation one.
    pub fn compared_items(&self) -> u64 {
        match self {
            Op::StoreData { registers, .. } => registers.len() as u64,
            Op::WiegandTest { save: false } => 0,
            _ => 1,
        }
    }
}
