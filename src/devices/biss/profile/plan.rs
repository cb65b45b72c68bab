//! The operations that change an encoder, their cost, and their base.

use super::{Bank, BissProfile, RegisterRange};
use crate::devices::biss::protocol::{Area, Filter, PresetCommand, PresetValue, RegisterAddress};
use crate::profile::{Operation, Plan};

/// A planned write to a BiSS encoder.
pub type BissPlan = Plan<Base, Op>;

/// Values that a plan is based on: everything that its operations change and that can be read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// The banks of plain data that the plan touches.
    pub banks: Vec<Bank>,
    /// The filter in force.
    pub filter: Option<Filter>,
    /// The stored preset value.
    pub preset: Option<PresetValue>,
    /// Single registers that the plan touches.
    pub registers: Vec<(RegisterAddress, u8)>,
}

/// Operation, from entering its device mode to leaving it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Manual 6.5: registers of one area are written and saved together.
    StoreData {
        /// The area; its `open` is the command that opens it.
        area: Area,
        /// The changes, by ascending address.
        registers: Vec<RegisterChange>,
    },
    /// Manual 6.7: stores another preset value; the position is not preset yet.
    StorePreset {
        /// Stored now.
        from: PresetValue,
        /// Stored from then on.
        to: PresetValue,
    },
    /// Manual 6.7: sets the position at the shaft's present place to the stored preset value.
    FirePreset {
        /// Parts of the position.
        parts: PresetParts,
        /// The value that is stored by then.
        value: PresetValue,
    },
    /// Manual 6.6.
    SelectFilter {
        /// The present filter.
        from: Filter,
        /// The new filter.
        to: Filter,
    },
    /// Manual 6.4, guided.
    Calibrate,
    /// Manual 6.3, guided.
    WiegandTest {
        /// Keep the result in the encoder.
        save: bool,
    },
    /// A register outside of the procedures, written directly.
    WriteRegister {
        /// The register.
        address: RegisterAddress,
        /// The old value; `None` if it cannot be read.
        old: Option<u8>,
        /// The new value.
        new: u8,
        /// Persistent writes that it costs.
        cycles: u8,
    },
}

/// A register with another value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RegisterChange {
    /// The register.
    pub address: RegisterAddress,
    /// The old value.
    pub old: u8,
    /// The new value.
    pub new: u8,
}

/// The part of the position that a preset sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PresetParts {
    /// Both parts.
    Both,
    /// The place within the revolution.
    Singleturn,
    /// The revolutions.
    Multiturn,
}

impl PresetParts {
    /// Returns the command that carries it out.
    pub const fn command(self) -> PresetCommand {
        match self {
            PresetParts::Both => PresetCommand::Both,
            PresetParts::Singleturn => PresetCommand::Singleturn,
            PresetParts::Multiturn => PresetCommand::Multiturn,
        }
    }

    /// Returns whether it sets the position within the revolution.
    pub const fn sets_singleturn(self) -> bool {
        matches!(self, PresetParts::Both | PresetParts::Singleturn)
    }

    /// Returns whether it sets the number of revolutions.
    pub const fn sets_multiturn(self) -> bool {
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
    /// Returns whether a motor turns the shaft for it.
    pub fn turns(&self) -> bool {
        matches!(self, Op::Calibrate | Op::WiegandTest { .. })
    }

    /// Returns the register ranges that it changes, as `read` takes them; empty if it changes no readable register.
    pub fn ranges(&self) -> Vec<RegisterRange> {
        let known = |text: &str| text.parse().into_iter().collect();
        match self {
            Op::StoreData { registers, .. } => RegisterRange::runs(registers.iter().map(|change| change.address)),
            Op::StorePreset { .. } => known(BissProfile::PRESET),
            Op::SelectFilter { .. } => known(BissProfile::FILTER),
            Op::WriteRegister { address, .. } => vec![RegisterRange::one(*address)],
            Op::FirePreset { .. } | Op::Calibrate | Op::WiegandTest { .. } => Vec::new(),
        }
    }

    /// Returns the names of the changed items, as `read` takes them if they can be read.
    pub fn item(&self) -> String {
        match self {
            Op::FirePreset { .. } => "position".to_owned(),
            Op::Calibrate => "calibration".to_owned(),
            Op::WiegandTest { .. } => "Wiegand test".to_owned(),
            op => op.ranges().iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        }
    }

    /// Returns the number of changes as a comparison counts them: registers of an area, or one.
    pub fn weight(&self) -> u64 {
        match self {
            Op::StoreData { registers, .. } => registers.len() as u64,
            Op::WiegandTest { save: false } => 0,
            _ => 1,
        }
    }
}
