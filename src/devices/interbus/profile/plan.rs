//! Operations that change an encoder, and the values on which they are based.

use std::fmt;

use super::{Item, Parameters};
use crate::devices::interbus::protocol::{CamNumber, Parameter, Program, ProgramNumber, Value, WindowShift};
use crate::profile::{Operation, Plan};

/// A planned write to an INTERBUS encoder.
pub type InterbusPlan = Plan<Base, Op>;

/// The encoder values on which a plan is based: those that the plan changes, and the measuring range for its cams.
/// Unchanged programs are left out, since reading a program switches the outputs of the encoder.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Base {
    /// Parameters, or `None` if the plan is empty.
    pub parameters: Option<Parameters>,
    /// Window shift, or `None` if the plan does not change it.
    pub shift: Option<WindowShift>,
    /// Current content of the affected programs.
    pub programs: Vec<(ProgramNumber, Program)>,
}

/// An operation, from entering a mode to leaving it. Every operation except executing the preset uses one EEPROM write
/// cycle.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Sets parameters in the given order in a single parameterisation, then stores them with 80000000h (reference 4).
    Parameterise(Vec<ParameterChange>),
    /// Selects and changes a cam program. Leaving the program stores the changes (reference 5).
    Program(ProgramChange),
    /// Sets the current position to the preset value (word 40000000h). The preset must have been programmed before
    /// (reference 4).
    FirePreset {
        /// Preset value.
        value: u32,
    },
    /// Restores the factory settings (word 0E000000h). This is experimental, since only the appendix of the manual
    /// mentions it (reference 6.10).
    Default,
}

/// A parameter with a new value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParameterChange {
    /// Parameter to change.
    pub parameter: Parameter,
    /// Current value.
    pub from: u32,
    /// New value, or the current one again if a preset must be reprogrammed before it can be executed.
    pub to: u32,
}

/// Changes within a program.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ProgramChange {
    /// Program number.
    pub program: ProgramNumber,
    /// Changed cam edges, ordered by cam, with the start of a cam before its stop.
    pub cams: Vec<CamChange>,
    /// Current and new activation mask, or `None` if the mask does not change.
    pub mask: Option<(u8, u8)>,
    /// Current and new window shift, or `None` if it does not change. All programs share the shift, but it can only be
    /// set together with a program.
    pub shift: Option<(WindowShift, WindowShift)>,
}

/// A new position of a cam edge.
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

/// An edge of a cam. The cam is on at both of its edges.
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
    /// Returns the changed items, listing a cam once even if both edges change. Executing the preset and restoring the
    /// factory settings change no items.
    pub fn affected_items(&self) -> Vec<Item> {
        match self {
            Op::Parameterise(changes) => {
                changes.iter().filter_map(|change| Item::from_parameter(change.parameter)).collect()
            }
            Op::Program(change) => change.affected_items(),
            Op::FirePreset { .. } | Op::Default => Vec::new(),
        }
    }

    /// Returns the names of the changed items. The command `read` accepts the names of readable items.
    pub fn item_names(&self) -> String {
        match self {
            Op::FirePreset { .. } => "position".to_owned(),
            Op::Default => "default".to_owned(),
            op => op.affected_items().iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        }
    }

    /// Returns the number of changes, counted as in a comparison.
    pub fn change_count(&self) -> u64 {
        match self {
            Op::FirePreset { .. } | Op::Default => 1,
            op => op.affected_items().len() as u64,
        }
    }
}

impl ProgramChange {
    /// Returns whether the operation changes nothing.
    pub fn is_empty(&self) -> bool {
        self.cams.is_empty() && self.mask.is_none() && self.shift.is_none()
    }

    fn affected_items(&self) -> Vec<Item> {
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
