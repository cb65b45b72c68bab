//! The operations that change an encoder, their cost, and their base.

use std::fmt;

use super::{Item, Parameters};
use crate::devices::interbus::protocol::{CamNumber, Parameter, Program, ProgramNumber, Value, WindowShift};
use crate::profile::{Operation, Plan};

/// A planned write to an INTERBUS encoder.
pub type InterbusPlan = Plan<Base, Op>;

/// Values that a plan is based on: everything that its operations change, and the range of its cams. Programs that it does
/// not change are not included, since reading one switches the encoder's outputs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// The parameters; `None` if the plan is empty.
    pub parameters: Option<Parameters>,
    /// The shift of the window; `None` if the plan does not change it.
    pub shift: Option<WindowShift>,
    /// The programs that the plan touches, as they are.
    pub programs: Vec<(ProgramNumber, Program)>,
}

/// Operation, from entering a mode to leaving it. Each stores once in the EEPROM, except firing the preset.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Sets parameters in one parameterisation, in this order; `80000000` stores them (reference 4).
    Parameterise(Vec<ParameterChange>),
    /// A cam program is selected, changed, and left, which stores it (reference 5).
    Program(ProgramChange),
    /// `40000000`: sets the position at the shaft's place to this preset, which is programmed before (reference 4).
    FirePreset {
        /// The value.
        value: u32,
    },
    /// `0E000000`: restores the factory settings. Experimental: only the manual's appendix mentions it (reference 6.10).
    Default,
}

/// A parameter with another number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParameterChange {
    /// The parameter.
    pub parameter: Parameter,
    /// Present number.
    pub from: u32,
    /// New number; the same if a preset is programmed again so that it can be fired.
    pub to: u32,
}

/// The changes in a program.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ProgramChange {
    /// The program.
    pub program: ProgramNumber,
    /// Edges of cams, by cam and the start first.
    pub cams: Vec<CamChange>,
    /// The activation mask, now and from then on.
    pub mask: Option<(u8, u8)>,
    /// The present and the new shift of the window: there is one for the encoder, which is set with a program.
    pub shift: Option<(WindowShift, WindowShift)>,
}

/// An edge of a cam with another position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CamChange {
    /// The cam.
    pub cam: CamNumber,
    /// The edge.
    pub edge: Edge,
    /// Old place.
    pub from: Value,
    /// New place.
    pub to: Value,
}

/// Edge of a cam. Both belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Edge {
    /// Its first position.
    Start,
    /// Its last one.
    Stop,
}

impl Operation for Op {
    fn write_cycles(&self) -> u64 {
        match self {
            Op::Parameterise(_) | Op::Program(_) | Op::Default => 1,
            Op::FirePreset { .. } => 0,
        }
    }
}

impl Op {
    /// Returns the changed items, named as in `read`; a cam once, whether one of its edges changes or both. Those of
    /// the default are not known.
    pub fn items(&self) -> Vec<Item> {
        match self {
            Op::Parameterise(changes) => {
                changes.iter().filter_map(|change| Item::of_parameter(change.parameter)).collect()
            }
            Op::Program(change) => change.items(),
            Op::FirePreset { .. } | Op::Default => Vec::new(),
        }
    }

    /// Returns the names of the changed items, as `read` takes them if they can be read.
    pub fn item(&self) -> String {
        match self {
            Op::FirePreset { .. } => "position".to_owned(),
            Op::Default => "default".to_owned(),
            op => op.items().iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        }
    }

    /// Returns the number of changes as a comparison counts them.
    pub fn weight(&self) -> u64 {
        match self {
            Op::FirePreset { .. } | Op::Default => 1,
            op => op.items().len() as u64,
        }
    }
}

impl ProgramChange {
    /// Returns whether nothing changes.
    pub fn is_empty(&self) -> bool {
        self.cams.is_empty() && self.mask.is_none() && self.shift.is_none()
    }

    fn items(&self) -> Vec<Item> {
        let mut items: Vec<Item> = self.mask.iter().map(|_| Item::CamMask(self.program)).collect();
        items.extend(self.cams.iter().map(|change| Item::Cam(self.program, change.cam)));
        items.extend(self.shift.iter().map(|_| Item::Shift));
        items.dedup();
        items
    }
}

impl fmt::Display for Edge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Edge::Start => "start",
            Edge::Stop => "stop",
        })
    }
}
