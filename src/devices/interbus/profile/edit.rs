//! Plans changes. Each change is checked against the rules of the encoder before anything is sent. A plan uses one
//! EEPROM write cycle for all parameters and one for each changed program.

use super::{
    Base, CamChange, Edge, Image, InterbusPlan, Item, Op, ParameterChange, Parameters, PlanError, ProgramChange,
};
use crate::devices::interbus::protocol::{Cam, CamNumber, Gear, Parameter, Program, ProgramNumber, Value};

/// Plans the changes that turn the values of `device` into the wanted ones. Values missing in `wanted` are left
/// unchanged, and all others must be known in `device`.
///
/// Parameters are written first, in a single parameterisation. Their order keeps each value valid when it is sent, and
/// the cams are within the new range afterwards. The window shift is set together with the first changed program. If no
/// program changes, it is set with the first program that was read, which uses an EEPROM write cycle.
///
/// # Errors
/// Returns a [`PlanError`] if the plan would violate a rule of the encoder.
pub fn plan_edits(device: &Image, wanted: &Image) -> Result<InterbusPlan, PlanError> {
    let mut plan = InterbusPlan { base: Base::default(), ops: Vec::new() };
    let changes = parameter_changes(&device.parameters, &wanted.parameters)?;
    if !changes.is_empty() {
        plan.ops.push(Op::Parameterise(changes));
    }
    check_unchanged_cams_in_range(device, wanted)?;
    let mut programs = Vec::new();
    for (number, to) in wanted.known_programs() {
        let item = Item::CamMask(number);
        let from = device.program(number).ok_or(PlanError::NotRead { item })?;
        let change = ProgramChange {
            program: number,
            cams: cam_changes(number, from, to, wanted.parameters.steps)?,
            mask: (from.mask != to.mask).then_some((from.mask, to.mask)),
            shift: None,
        };
        if !change.is_empty() {
            plan.base.programs.push((number, *from));
            programs.push(change);
        }
    }
    if let Some(to) = wanted.shift.filter(|to| device.shift != Some(*to)) {
        let not_read = || PlanError::NotRead { item: Item::Shift };
        let from = device.shift.ok_or_else(not_read)?;
        plan.base.shift = Some(from);
        match programs.first_mut() {
            Some(change) => change.shift = Some((from, to)),
            None => {
                let (program, own) = device.known_programs().next().ok_or_else(not_read)?;
                plan.base.programs.push((program, *own));
                programs.push(ProgramChange { program, cams: Vec::new(), mask: None, shift: Some((from, to)) });
            }
        }
    }
    plan.ops.extend(programs.into_iter().map(Op::Program));
    plan.base.parameters = (!plan.is_empty()).then_some(device.parameters);
    Ok(plan)
}

/// Plans to set the current position to a preset value. The preset is always programmed before it is executed, because
/// it can be executed only once each time it is programmed (reference 4).
///
/// # Errors
/// Returns an error if the value exceeds the measuring range.
pub fn plan_preset(device: &Parameters, value: u32) -> Result<InterbusPlan, PlanError> {
    Parameter::Preset.check_value(value, device.gear()?)?;
    let change = ParameterChange { parameter: Parameter::Preset, from: device.preset, to: value };
    let base = Base { parameters: Some(*device), ..Base::default() };
    Ok(InterbusPlan { base, ops: vec![Op::Parameterise(vec![change]), Op::FirePreset { value }] })
}

/// Plans to restore the factory settings. The resulting values are not known in advance. This is experimental (see
/// reference 6.10).
pub fn plan_default(device: &Parameters) -> InterbusPlan {
    InterbusPlan { base: Base { parameters: Some(*device), ..Base::default() }, ops: vec![Op::Default] }
}

/// Returns the parameter changes in an order that keeps each value within its limits when it is sent.
fn parameter_changes(device: &Parameters, wanted: &Parameters) -> Result<Vec<ParameterChange>, PlanError> {
    if device == wanted {
        return Ok(Vec::new());
    }
    let gear = wanted.gear()?;
    // This is the order of the manual. It is only changed where the limits of the values require it.
    let mut order = vec![Parameter::Steps, Parameter::Turns, Parameter::Direction, Parameter::ZeroShift];
    let now_has_room = Gear::new(wanted.steps, device.revolutions).is_ok();
    if !now_has_room {
        order.swap(0, 1);
    }
    order.insert(3, Parameter::Preset);
    // A value beyond the new range must be changed before the range.
    let is_beyond = |parameter: &Parameter| {
        let places = matches!(parameter, Parameter::Preset | Parameter::ZeroShift);
        places && device.value(*parameter).is_some_and(|place| place >= wanted.steps)
    };
    order.sort_by_key(|parameter| !is_beyond(parameter));
    let mut changes = Vec::new();
    for parameter in order {
        let (Some(from), Some(to)) = (device.value(parameter), wanted.value(parameter)) else { continue };
        // Unchanged values are checked as well, since another gear may have other limits.
        parameter.check_value(to, gear)?;
        if from != to {
            changes.push(ParameterChange { parameter, from, to });
        }
    }
    Ok(changes)
}

fn cam_changes(number: ProgramNumber, from: &Program, to: &Program, steps: u32) -> Result<Vec<CamChange>, PlanError> {
    let mut changes = Vec::new();
    for cam in CamNumber::all() {
        let Some(to) = to.cam(cam) else { continue };
        let item = Item::Cam(number, cam);
        let from = from.cam(cam).ok_or(PlanError::NotRead { item })?;
        for edge in Edge::BOTH {
            let (from, to) = (edge.position_in(from), edge.position_in(to));
            if from != to {
                check_edge(item, edge, to, steps)?;
                changes.push(CamChange { cam, edge, from, to });
            }
        }
    }
    Ok(changes)
}

/// Checks that no active cam would be left beyond a shortened range.
fn check_unchanged_cams_in_range(device: &Image, wanted: &Image) -> Result<(), PlanError> {
    if wanted.parameters.steps >= device.parameters.steps {
        return Ok(());
    }
    for number in ProgramNumber::all() {
        let (Some(now), own) = (device.program(number), wanted.program(number)) else { continue };
        let mask = own.map_or(now.mask, |own| own.mask);
        for cam in CamNumber::all().filter(|cam| mask >> cam.get() & 1 != 0) {
            let Some(will_be) = own.and_then(|own| own.cam(cam)).or_else(|| now.cam(cam)) else { continue };
            for edge in Edge::BOTH {
                check_edge(Item::Cam(number, cam), edge, edge.position_in(will_be), wanted.parameters.steps)?;
            }
        }
    }
    Ok(())
}

fn check_edge(item: Item, edge: Edge, position: Value, steps: u32) -> Result<(), PlanError> {
    let (position, last) = (position.get(), steps.saturating_sub(1));
    if position <= last { Ok(()) } else { Err(PlanError::CamBeyondRange { item, edge, position, last }) }
}

impl Edge {
    /// Both edges, in the order in which they are set.
    pub const BOTH: [Edge; 2] = [Edge::Start, Edge::Stop];

    /// Returns the position of this edge of a cam.
    pub const fn position_in(self, cam: Cam) -> Value {
        match self {
            Edge::Start => cam.start,
            Edge::Stop => cam.stop,
        }
    }
}

#[cfg(test)]
mod tests;
