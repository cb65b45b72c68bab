//! Changes made by an operation, as text for the logbook. The text uses the terms of the manual, regardless of the
//! display language.

use super::{CamChange, Direction, Op, ParameterChange};
use crate::devices::interbus::protocol::Parameter;
use crate::profile::ChangedItem;

/// A single change within an operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValueChange {
    /// Name of the changed item, or of the changed edge of a cam.
    pub name: String,
    /// Old value.
    pub from: String,
    /// New value.
    pub to: String,
}

impl Op {
    /// Returns the changed items with their old and new values.
    pub fn changed_items(&self) -> Vec<ChangedItem> {
        match self {
            Op::FirePreset { value } => vec![ChangedItem::new_value("position", value)],
            Op::Default => vec![ChangedItem::new_value("default", "all parameters as delivered")],
            op => {
                let steps = op.value_changes().into_iter();
                steps.map(|step| ChangedItem::new(step.name, Some(step.from), Some(step.to))).collect()
            }
        }
    }

    /// Returns the individual changes of parameters, masks and cam edges. Returns an empty list for other operations.
    pub fn value_changes(&self) -> Vec<ValueChange> {
        let step = |name: String, from: &dyn ToString, to: &dyn ToString| ValueChange {
            name,
            from: from.to_string(),
            to: to.to_string(),
        };
        match self {
            Op::Parameterise(changes) => {
                let number = |parameter: Parameter, number: u32| match Direction::from_code(number) {
                    Some(direction) if parameter == Parameter::Direction => direction.to_string(),
                    _ => number.to_string(),
                };
                let one = |change: &ParameterChange| {
                    let (parameter, from, to) = (change.parameter, change.from, change.to);
                    step(parameter.name().to_owned(), &number(parameter, from), &number(parameter, to))
                };
                changes.iter().map(one).collect()
            }
            Op::Program(change) => {
                let number = change.program.get();
                let edge = |change: &CamChange| {
                    let name = format!("cam:{number}:{} {}", change.cam.get(), change.edge);
                    step(name, &change.from.get(), &change.to.get())
                };
                let hex = |mask: u8| format!("0x{mask:02X}");
                let mask = change.mask.map(|(from, to)| step(format!("cam-mask:{number}"), &hex(from), &hex(to)));
                let shift = change.shift.map(|(from, to)| step("shift".to_owned(), &from.get(), &to.get()));
                change.cams.iter().map(edge).chain(mask).chain(shift).collect()
            }
            Op::FirePreset { .. } | Op::Default => Vec::new(),
        }
    }
}
