//! The operations that change an encoder, what they cost, and what they rest upon.

use std::fmt;

use super::{Item, Parameters};
use crate::devices::interbus::protocol::{CamNumber, Parameter, Program, ProgramNumber, Value, WindowShift};
use crate::profile::{Operation, Plan};

/// A planned write to an INTERBUS encoder.
pub type InterbusPlan = Plan<Base, Op>;

/// The values that a plan is based on: everything that its operations change, and the range of its cams. Programs that
/// it does not touch are not included, since reading one switches the encoder's outputs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// The parameters; `None` where there is nothing to do.
    pub parameters: Option<Parameters>,
    /// The shift of the window; `None` where the plan does not touch it.
    pub shift: Option<WindowShift>,
    /// The programs that the plan touches, as they are.
    pub programs: Vec<(ProgramNumber, Program)>,
}

/// One thing that is done, from entering a mode to leaving it. Each stores once in the EEPROM, but for the preset's firing.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Parameters are set in one parameterisation, in this order; `80000000` stores them (reference 4).
    Parameterise(Vec<ParameterChange>),
    /// A cam program is selected, changed, and left, which stores it (reference 5).
    Program(ProgramChange),
    /// `40000000`: the shaft's place becomes this preset, which is programmed by then (reference 4).
    FirePreset {
        /// The value.
        value: u32,
    },
    /// `0E000000`: back to what was delivered. Experimental: only the manual's appendix has it (reference 6.10).
    Default,
}

/// A parameter with another number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParameterChange {
    /// The parameter.
    pub parameter: Parameter,
    /// Its number now.
    pub from: u32,
    /// Its number from then on; the same where a preset is programmed again, so that it can be fired.
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
    /// The shift of the window, now and from then on: it is one for the encoder and is set along with a program.
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

/// An edge of a cam. Both belong to it.
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

    /// Names of what it changes, as `read` takes them where they can be read.
    pub fn item(&self) -> String {
        match self {
            Op::FirePreset { .. } => "position".to_owned(),
            Op::Default => "default".to_owned(),
            op => op.items().iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        }
    }

    /// Things it changes, counted as a comparison counts them.
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
