//! Profiles for tests.

use super::{Direction, Image, InterbusProfile, Item, ItemValue, Op, Parameters, ProfileIdentity, RecordedValues};
use crate::devices::interbus::protocol::{
    Cam, CamNumber, Flags, Program, ProgramNumber, StartupMode, Value, WindowShift,
};

pub(super) fn value(number: u32) -> Value {
    Value::new(number).unwrap()
}

pub(super) fn program(number: u8) -> ProgramNumber {
    ProgramNumber::new(number).unwrap()
}

pub(super) fn cam(number: u8) -> CamNumber {
    CamNumber::new(number).unwrap()
}

pub(super) fn cam_between(start: u32, stop: u32) -> Cam {
    Cam { start: value(start), stop: value(stop) }
}

pub(super) fn parse_item(text: &str) -> Item {
    text.parse().unwrap()
}

pub(super) fn image_with(image: &Image, items: &[(&str, ItemValue)]) -> Image {
    let mut image = image.clone();
    for (name, value) in items {
        assert!(image.set_value(parse_item(name), *value), "{name}");
    }
    image
}

/// Returns EEPROM content with 3600 steps over one turn and 8 active cams in each program. Cam c of program p spans
/// 100·c + p to 100·c + p + 49.
pub(super) fn image() -> Image {
    let parameters =
        Parameters { steps: 3600, revolutions: 1, direction: Direction::Clockwise, preset: 500, zero_shift: 0 };
    let mut image = Image::from_parameters(parameters);
    image.shift = WindowShift::new(0);
    for number in ProgramNumber::all() {
        let mut own = Program { mask: 0xFF, ..Program::default() };
        for cam in CamNumber::all() {
            let start = 100 * u32::from(cam.get()) + u32::from(number.get());
            own.set_cam(cam, Some(cam_between(start, start + 49)));
        }
        *image.program_mut(number).unwrap() = Some(own);
    }
    image
}

pub(super) fn identity(serial_number: &str) -> ProfileIdentity {
    let flags = Some(Flags::new(value(2)));
    ProfileIdentity { serial_number: serial_number.to_owned(), flags, ..ProfileIdentity::default() }
}

pub(super) fn profile(serial_number: &str) -> InterbusProfile {
    let recorded = RecordedValues {
        software_version: Some(0x102),
        operating_minutes: Some(10_000),
        temperature_tenths: Some(-100),
        mode: Some(StartupMode::K3),
        preset_flag: Some(0),
        unknown: Default::default(),
    };
    InterbusProfile::new(identity(serial_number), image(), recorded)
}

/// Returns the logbook description of an operation's changes.
pub(super) fn logbook_note(op: &Op) -> String {
    op.changed_items().iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}
