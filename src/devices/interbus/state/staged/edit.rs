//! Edits, how they change the values, and why an edit may be rejected.

use super::{BaseSource, EditedValues};
use crate::devices::interbus::profile::{Direction, Edge, ImportedProgram, Item, ItemValue, LONGEST_NAME};
use crate::devices::interbus::protocol::{
    Cam, CamNumber, Gear, GearError, OutOfRange, Parameter, Program, ProgramNumber, Value, WindowShift,
};

/// A change to the values. Each edit is one undo step, even if it changes several of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Edit {
    Steps(u32),
    /// Sets the number of turns after which the position repeats.
    Revolutions(u32),
    /// Sets steps and turns together, because changing only one of them may give an invalid combination.
    Gear {
        steps: u32,
        revolutions: u32,
    },
    Direction(Direction),
    /// Sets the preset in steps. The preset is not executed.
    Preset(u32),
    /// Sets the zero shift in steps.
    ZeroShift(u32),
    Shift(WindowShift),
    Edge {
        program: ProgramNumber,
        cam: CamNumber,
        edge: Edge,
        to: u32,
    },
    /// Sets both edges of a cam.
    Cam {
        program: ProgramNumber,
        cam: CamNumber,
        start: u32,
        /// Last position of the cam. If it is before the start, the cam wraps around the end of the measuring range.
        stop: u32,
        /// Whether to activate the cam if it is inactive.
        on: bool,
    },
    Switch {
        program: ProgramNumber,
        cam: CamNumber,
        /// Whether the cam is active.
        on: bool,
    },
    /// Sets which cams of a program are active.
    Mask {
        program: ProgramNumber,
        /// Mask with bit i for cam i.
        mask: u8,
    },
    /// Sets the name of a cam, or removes it if it is empty.
    Name {
        program: ProgramNumber,
        cam: CamNumber,
        /// Name with at most [`LONGEST_NAME`] characters.
        name: String,
    },
    /// Sets the name of a program, or removes it if it is empty.
    ProgramName {
        program: ProgramNumber,
        /// Name with at most [`LONGEST_NAME`] characters.
        name: String,
    },
    /// Copies a program over another one, including the names of its cams.
    Copy {
        from: ProgramNumber,
        to: ProgramNumber,
    },
    /// Mirrors a program within the measuring range, including inactive cams unless they are beyond the range.
    Mirror(ProgramNumber),
    /// Shifts a program by a number of steps. What leaves the range at one end reappears at the other. Inactive cams
    /// are also shifted, unless they are beyond the range.
    Rotate {
        program: ProgramNumber,
        /// Number of steps. Positive numbers shift to later positions.
        by: i64,
    },
    /// Sets the programs of an imported table.
    Table(Vec<ImportedProgram>),
}

impl Edit {
    /// Returns the edit that sets an item to a value, or `None` if the item cannot be edited or cannot have this value.
    pub fn of_item(item: Item, value: ItemValue) -> Option<Self> {
        Some(match (item, value) {
            (Item::Steps, ItemValue::Number(steps)) => Edit::Steps(steps),
            (Item::Revolutions, ItemValue::Number(revolutions)) => Edit::Revolutions(revolutions),
            (Item::Direction, ItemValue::Direction(direction)) => Edit::Direction(direction),
            (Item::Preset, ItemValue::Number(preset)) => Edit::Preset(preset),
            (Item::ZeroShift, ItemValue::Number(zero_shift)) => Edit::ZeroShift(zero_shift),
            (Item::Shift, ItemValue::Number(shift)) => Edit::Shift(WindowShift::new(u8::try_from(shift).ok()?)?),
            (Item::CamMask(program), ItemValue::Mask(mask)) => Edit::Mask { program, mask },
            (Item::Cam(program, cam), ItemValue::Cam(edges)) => {
                Edit::Cam { program, cam, start: edges.start.get(), stop: edges.stop.get(), on: false }
            }
            _ => return None,
        })
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EditError {
    /// No values have been read.
    #[error("nothing has been read yet")]
    NothingRead,
    #[error("cam program {} has not been read", .0.get())]
    NotRead(ProgramNumber),
    /// The window shift has not been read. It is only read together with a program.
    #[error("the window shift has not been read")]
    ShiftNotRead,
    /// The profile does not contain the cam.
    #[error("cam {} of program {} has no edges", cam.get(), program.get())]
    NoCam { program: ProgramNumber, cam: CamNumber },
    #[error(transparent)]
    Gear(#[from] GearError),
    #[error(transparent)]
    Parameter(#[from] OutOfRange),
    #[error("{to} is outside the measuring range, which ends at {last}")]
    Edge { edge: Edge, to: u32, last: u32 },
    /// An active cam is beyond the measuring range, so its program can be neither mirrored nor shifted.
    #[error("cam {} of program {} is outside the measuring range, which ends at {last}", cam.get(), program.get())]
    Beyond { program: ProgramNumber, cam: CamNumber, last: u32 },
    /// The name is too long or contains line breaks or other control characters.
    #[error("a name must be a single line of at most {LONGEST_NAME} characters")]
    Name,
}

pub(super) fn apply_edit(wanted: &EditedValues, edit: &Edit, ground: BaseSource) -> Result<EditedValues, EditError> {
    let mut after = wanted.clone();
    let parameters = &mut after.image.parameters;
    match *edit {
        Edit::Steps(steps) => set_gear(&mut after, steps, wanted.image.parameters.revolutions)?,
        Edit::Revolutions(revolutions) => set_gear(&mut after, wanted.step_count(), revolutions)?,
        Edit::Gear { steps, revolutions } => set_gear(&mut after, steps, revolutions)?,
        Edit::Direction(direction) => parameters.direction = direction,
        Edit::Preset(to) => parameters.preset = check_in_range(Parameter::Preset, to, last_step(wanted))?,
        Edit::ZeroShift(to) => parameters.zero_shift = check_in_range(Parameter::ZeroShift, to, last_step(wanted))?,
        Edit::Shift(shift) => {
            if ground == BaseSource::Encoder && wanted.image.shift.is_none() {
                return Err(EditError::ShiftNotRead);
            }
            after.image.shift = Some(shift);
        }
        Edit::Edge { program, cam, edge, to } => {
            let to = position(edge, to, wanted)?;
            let own = program_mut(&mut after, program, ground)?;
            let none = EditError::NoCam { program, cam };
            let own = own.cams.get_mut(usize::from(cam.get())).and_then(Option::as_mut).ok_or(none)?;
            match edge {
                Edge::Start => own.start = to,
                Edge::Stop => own.stop = to,
            }
        }
        Edit::Cam { program, cam, start, stop, on } => {
            let to = Cam { start: position(Edge::Start, start, wanted)?, stop: position(Edge::Stop, stop, wanted)? };
            let own = program_mut(&mut after, program, ground)?;
            if let Some(own) = own.cams.get_mut(usize::from(cam.get())) {
                *own = Some(to);
            }
            own.mask |= u8::from(on) << cam.get();
        }
        Edit::Switch { program, cam, on } => {
            let own = program_mut(&mut after, program, ground)?;
            if on && own.cams.get(usize::from(cam.get())).is_none_or(Option::is_none) {
                return Err(EditError::NoCam { program, cam });
            }
            own.set_cam_enabled(cam, on);
        }
        Edit::Mask { program, mask } => {
            let own = program_mut(&mut after, program, ground)?;
            let missing = CamNumber::all().find(|cam| mask >> cam.get() & 1 == 1 && own.cam(*cam).is_none());
            if let Some(cam) = missing {
                return Err(EditError::NoCam { program, cam });
            }
            own.mask = mask;
        }
        Edit::Name { program, cam, ref name } => after.names.set_cam(program, cam, validate_name(name)?),
        Edit::ProgramName { program, ref name } => after.names.set_program(program, validate_name(name)?),
        Edit::Copy { from, to } => {
            let copied = *wanted.image.program(from).ok_or(EditError::NotRead(from))?;
            *program_mut(&mut after, to, ground)? = copied;
            for cam in CamNumber::all() {
                after.names.set_cam(to, cam, wanted.names.cam(from, cam).to_owned());
            }
        }
        Edit::Mirror(program) => {
            let last = last_step(wanted);
            move_cams(&mut after, program, |cam| Cam {
                start: Value::from_word(last.saturating_sub(cam.stop.get())),
                stop: Value::from_word(last.saturating_sub(cam.start.get())),
            })?;
        }
        Edit::Rotate { program, by } => {
            let range = i64::from(wanted.step_count().max(1));
            // The numbers are below the range, which has at most 25 bits.
            let by = by.rem_euclid(range);
            let moved = |edge: Value| Value::from_word(((i64::from(edge.get()) + by) % range) as u32);
            move_cams(&mut after, program, |cam| Cam { start: moved(cam.start), stop: moved(cam.stop) })?;
        }
        Edit::Table(ref table) => {
            for filled in table {
                fill_program(&mut after, filled, ground)?;
            }
        }
    }
    Ok(after)
}

fn set_gear(after: &mut EditedValues, steps: u32, revolutions: u32) -> Result<(), EditError> {
    let gear = Gear::new(steps, revolutions)?;
    after.image.parameters.steps = gear.total_steps();
    after.image.parameters.revolutions = gear.turns();
    Ok(())
}

fn check_in_range(parameter: Parameter, value: u32, high: u32) -> Result<u32, EditError> {
    if value <= high { Ok(value) } else { Err(OutOfRange { parameter, value, low: 0, high }.into()) }
}

const fn last_step(wanted: &EditedValues) -> u32 {
    wanted.step_count().saturating_sub(1)
}

fn position(edge: Edge, to: u32, wanted: &EditedValues) -> Result<Value, EditError> {
    let last = last_step(wanted);
    Value::new(to).filter(|_| to <= last).ok_or(EditError::Edge { edge, to, last })
}

/// Returns a program for editing. If a profile does not contain the program, it is added.
pub(super) fn program_mut(
    after: &mut EditedValues,
    number: ProgramNumber,
    ground: BaseSource,
) -> Result<&mut Program, EditError> {
    let own = after.image.program_mut(number).ok_or(EditError::NotRead(number))?;
    match ground {
        BaseSource::Encoder => own.as_mut().ok_or(EditError::NotRead(number)),
        BaseSource::Profile => Ok(own.get_or_insert_default()),
    }
}

fn move_cams(after: &mut EditedValues, program: ProgramNumber, to: impl Fn(Cam) -> Cam) -> Result<(), EditError> {
    let last = last_step(after);
    let own = after.image.program_mut(program).and_then(Option::as_mut).ok_or(EditError::NotRead(program))?;
    let mask = own.mask;
    for (number, cam) in CamNumber::all().zip(&mut own.cams) {
        let Some(cam) = cam else { continue };
        if cam.start.get() <= last && cam.stop.get() <= last {
            *cam = to(*cam);
        } else if mask & 1 << number.get() != 0 {
            return Err(EditError::Beyond { program, cam: number, last });
        }
    }
    Ok(())
}

fn fill_program(after: &mut EditedValues, filled: &ImportedProgram, ground: BaseSource) -> Result<(), EditError> {
    for cam in filled.cams.iter().flatten() {
        position(Edge::Start, cam.start.get(), after)?;
        position(Edge::Stop, cam.stop.get(), after)?;
    }
    for (cam, name) in CamNumber::all().zip(&filled.names) {
        after.names.set_cam(filled.program, cam, validate_name(name)?);
    }
    let own = program_mut(after, filled.program, ground)?;
    own.mask = 0;
    for ((number, own_cam), cam) in CamNumber::all().zip(&mut own.cams).zip(&filled.cams) {
        if cam.is_some() {
            *own_cam = *cam;
            own.mask |= 1 << number.get();
        }
    }
    Ok(())
}

/// Checks a name and removes blanks from both ends.
pub(super) fn validate_name(name: &str) -> Result<String, EditError> {
    let name = name.trim();
    if name.chars().count() > LONGEST_NAME || name.chars().any(char::is_control) {
        return Err(EditError::Name);
    }
    Ok(name.to_owned())
}
