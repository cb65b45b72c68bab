//! Operations that change an encoder, their cost, and the values on which they are based.

use std::fmt;

use super::{Item, Parameters};
use crate::devices::interbus::protocol::{CamNumber, Parameter, Program, ProgramNumber, Value, WindowShift};
use crate::profile::{Operation, Plan};

/// A planned write to an INTERBUS encoder.
pub type InterbusPlan = Plan<Base, Op>;

/// The values on which a plan is based: everything that its operations change, and the range of its cams. Unchanged
/// programs are excluded, since reading a program switches the outputs of the encoder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Parameters, or `None` if the plan is empty.
    pub parameters: Option<Parameters>,
    /// Window shift, or `None` if the plan does not change it.
    pub shift: Option<WindowShift>,
    /// Present content of the affected programs.
    pub programs: Vec<(ProgramNumber, Program)>,
}

/// An operation, from entering a mode to leaving it. Each operation costs one EEPROM store cycle, except firing the
/// preset.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Sets parameters in a single parameterisation, in the given order; `80000000` stores them (reference 4).
    Parameterise(Vec<ParameterChange>),
    /// Selects and changes a cam program. Leaving the program stores the changes (reference 5).
    Program(ProgramChange),
    /// `40000000`: sets the position at the present shaft angle to the preset value, which must have been programmed
    /// before (reference 4).
    FirePreset {
        /// Preset value.
        value: u32,
    },
    /// `0E000000`: restores the factory settings. Experimental, since only the appendix of the manual mentions it
    /// (reference 6.10).
    Default,
}

/// A parameter with a new value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParameterChange {
    /// Parameter to change.
    pub parameter: Parameter,
    /// Present value.
    pub from: u32,
    /// New value, which equals the present one if a preset is programmed again in order to be fired.
    pub to: u32,
}

/// Changes within a program.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ProgramChange {
    /// Program number.
    pub program: ProgramNumber,
    /// Changed cam edges, ordered by cam, with the start first.
    pub cams: Vec<CamChange>,
    /// Present and new activation mask.
    pub mask: Option<(u8, u8)>,
    /// Present and new window shift. The shift is common to all programs and set together with a program.
    pub shift: Option<(WindowShift, WindowShift)>,
}

/// A cam edge with a new position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CamChange {
    /// Cam number.
    pub cam: CamNumber,
    /// Edge to change.
    pub edge: Edge,
    /// Old position.
    pub from: Value,
    /// New position.
    pub to: Value,
}

/// An edge of a cam. The positions of both edges are part of the cam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Edge {
    /// First position of the cam.
    Start,
    /// Last position of the cam.
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
    /// Returns the changed items. A cam is listed once even if both of its edges change. The items changed by restoring
    /// the factory settings are unknown.
    pub fn items(&self) -> Vec<Item> {
        match self {
            Op::Parameterise(changes) => {
                changes.iter().filter_map(|change| Item::from_parameter(change.parameter)).collect()
            }
            Op::Program(change) => change.items(),
            Op::FirePreset { .. } | Op::Default => Vec::new(),
        }
    }

    /// Returns the names of the changed items, as accepted by `read` if they are readable.
    pub fn item(&self) -> String {
        match self {
            Op::FirePreset { .. } => "position".to_owned(),
            Op::Default => "default".to_owned(),
            op => op.items().iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        }
    }

    /// Returns the number of changes, counted in the same way as in a comparison.
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
