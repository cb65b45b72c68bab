//! Cams, programs and their outputs at a position (reference 5).

use super::value::Value;

/// Number of a cam within its program, 0 to 7. The words have room for 16 cams, but the manual mentions only 8
/// (reference 6.9).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CamNumber(u8);

/// Number of a program, 1 to 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ProgramNumber(u8);

/// A cam, which is on from one position to another, both included (`U`: not documented). If the start is after the
/// stop, the cam wraps around the end of the measuring range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Cam {
    /// First position at which the cam is on.
    pub start: Value,
    /// Last position at which the cam is on.
    pub stop: Value,
}

/// A program of eight cams. Only the cams in the activation mask are active.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Program {
    /// Cams by number, or `None` where undefined.
    pub cams: [Option<Cam>; Program::CAMS],
    /// Activation mask, in which bit i activates cam i.
    pub mask: u8,
}

impl CamNumber {
    /// All cam numbers in ascending order.
    pub const ALL: [CamNumber; Program::CAMS] = [
        CamNumber(0),
        CamNumber(1),
        CamNumber(2),
        CamNumber(3),
        CamNumber(4),
        CamNumber(5),
        CamNumber(6),
        CamNumber(7),
    ];

    /// Returns all cam numbers in ascending order.
    pub fn all() -> impl Iterator<Item = CamNumber> {
        CamNumber::ALL.into_iter()
    }

    /// Creates a cam number, or returns `None` if the number is above 7.
    pub const fn new(number: u8) -> Option<Self> {
        if (number as usize) < Program::CAMS { Some(CamNumber(number)) } else { None }
    }

    /// Returns the number, 0 to 7.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl ProgramNumber {
    /// Number of programs.
    pub const COUNT: usize = 8;
    /// Program 1.
    pub const FIRST: ProgramNumber = ProgramNumber(1);

    /// Returns all program numbers in ascending order.
    pub fn all() -> impl Iterator<Item = ProgramNumber> {
        (1..=8).map(ProgramNumber)
    }

    /// Creates a program number, or returns `None` if the number is outside 1 to 8.
    pub const fn new(number: u8) -> Option<Self> {
        if number >= 1 && number as usize <= ProgramNumber::COUNT { Some(ProgramNumber(number)) } else { None }
    }

    /// Returns the number, 1 to 8.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl Cam {
    /// Returns whether the cam wraps around the end of the measuring range.
    pub fn wraps_around(self) -> bool {
        self.start > self.stop
    }

    /// Returns whether the cam is on at a position.
    pub fn is_on(self, position: Value) -> bool {
        if self.wraps_around() {
            position >= self.start || position <= self.stop
        } else {
            position >= self.start && position <= self.stop
        }
    }
}

impl Program {
    /// Number of cams in a program.
    pub const CAMS: usize = 8;

    /// Returns whether a cam is active, that is, whether its bit in the mask is set.
    pub const fn is_on(&self, cam: CamNumber) -> bool {
        self.mask >> cam.0 & 1 == 1
    }

    /// Activates or deactivates a cam.
    pub const fn set_cam_enabled(&mut self, cam: CamNumber, on: bool) {
        self.mask = self.mask & !(1 << cam.0) | (on as u8) << cam.0;
    }

    /// Returns a cam, or `None` if it is undefined.
    pub fn cam(&self, number: CamNumber) -> Option<Cam> {
        self.cams.get(usize::from(number.0)).copied().flatten()
    }

    /// Sets or removes a cam. The activation mask is left unchanged.
    pub fn set_cam(&mut self, number: CamNumber, cam: Option<Cam>) {
        if let Some(place) = self.cams.get_mut(usize::from(number.0)) {
            *place = cam;
        }
    }

    /// Returns the outputs at a position, with bit i for cam i.
    pub fn outputs(&self, position: Value) -> u8 {
        let on = |cam: &Option<Cam>| cam.is_some_and(|cam| cam.is_on(position));
        let all = self.cams.iter().rev().fold(0, |bits, cam| bits << 1 | u8::from(on(cam)));
        all & self.mask
    }
}
