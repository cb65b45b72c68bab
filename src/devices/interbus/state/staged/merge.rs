//! Merges edits with new base values.

use super::EditedValues;
use crate::devices::interbus::profile::Image;
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber};

/// Returns the values just read, completed with known values for those that were not read.
pub(super) fn merge_known(known: &Image, read: Image) -> Image {
    let mut programs = read.programs;
    for (own, known) in programs.iter_mut().zip(&known.programs) {
        *own = own.or(*known);
    }
    Image { parameters: read.parameters, shift: read.shift.or(known.shift), programs }
}

/// Applies edits made to the previous base values to the new ones.
pub(super) fn rebase_edits(own: &mut EditedValues, before: &EditedValues, now: &EditedValues) {
    let (parameters, was, is) = (&mut own.image.parameters, &before.image.parameters, &now.image.parameters);
    update_if_unedited(&mut parameters.steps, &was.steps, &is.steps);
    update_if_unedited(&mut parameters.revolutions, &was.revolutions, &is.revolutions);
    update_if_unedited(&mut parameters.direction, &was.direction, &is.direction);
    update_if_unedited(&mut parameters.preset, &was.preset, &is.preset);
    update_if_unedited(&mut parameters.zero_shift, &was.zero_shift, &is.zero_shift);
    update_if_unedited(&mut own.image.shift, &before.image.shift, &now.image.shift);
    let programs = own.image.programs.iter_mut().zip(&before.image.programs).zip(&now.image.programs);
    for ((program, was), is) in programs {
        match (program.as_mut(), was, is) {
            (Some(program), Some(was), Some(is)) => rebase_program(program, was, is),
            _ => update_if_unedited(program, was, is),
        }
    }
    for program in ProgramNumber::all() {
        if own.names.program(program) == before.names.program(program) {
            own.names.set_program(program, now.names.program(program).to_owned());
        }
        for cam in CamNumber::all() {
            if own.names.cam(program, cam) == before.names.cam(program, cam) {
                own.names.set_cam(program, cam, now.names.cam(program, cam).to_owned());
            }
        }
    }
}

fn rebase_program(program: &mut Program, was: &Program, is: &Program) {
    for ((cam, was), is) in program.cams.iter_mut().zip(&was.cams).zip(&is.cams) {
        match (cam.as_mut(), was, is) {
            (Some(Cam { start, stop }), Some(was), Some(is)) => {
                update_if_unedited(start, &was.start, &is.start);
                update_if_unedited(stop, &was.stop, &is.stop);
            }
            _ => update_if_unedited(cam, was, is),
        }
    }
    let edited = program.mask ^ was.mask;
    program.mask = program.mask & edited | is.mask & !edited;
}

/// Updates a value to the new base value, unless the user has edited it.
fn update_if_unedited<T: PartialEq + Clone>(own: &mut T, was: &T, is: &T) {
    if own == was {
        own.clone_from(is);
    }
}
