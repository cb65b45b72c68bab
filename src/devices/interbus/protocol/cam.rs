//! Cams and programs: the outputs at a position (reference 5).

use super::value::Value;

/// The number of a program's cam: 0 to 7. Words have room for 16, and the manual names 8 (reference 6.9).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CamNumber(u8);

/// The number of a program: 1 to 8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ProgramNumber(u8);

/// A range of positions. Both edges belong to it (`U`); if the start is beyond the stop, it passes the end of the measuring
/// range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Cam {
    /// The first position at which it is on.
    pub start: Value,
    /// The last one.
    pub stop: Value,
}

/// Eight cams, and their activation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Program {
    /// The cams by number; `None` if there is none.
    pub cams: [Option<Cam>; Program::CAMS],
    /// The activation mask: bit i for cam i.
    pub mask: u8,
}

impl CamNumber {
    /// All numbers, in ascending order.
    pub const EACH: [CamNumber; Program::CAMS] = [
        CamNumber(0),
        CamNumber(1),
        CamNumber(2),
        CamNumber(3),
        CamNumber(4),
        CamNumber(5),
        CamNumber(6),
        CamNumber(7),
    ];

    /// Returns all numbers, in ascending order.
    pub fn all() -> impl Iterator<Item = CamNumber> {
        CamNumber::EACH.into_iter()
    }

    /// Creates it from a number; `None` beyond 7.
    pub const fn new(number: u8) -> Option<Self> {
        if (number as usize) < Program::CAMS { Some(CamNumber(number)) } else { None }
    }

    /// Returns 0 to 7.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl ProgramNumber {
    /// Number of programs.
    pub const COUNT: usize = 8;
    /// 1.
    pub const FIRST: ProgramNumber = ProgramNumber(1);

    /// Returns all numbers, in ascending order.
    pub fn all() -> impl Iterator<Item = ProgramNumber> {
        (1..=8).map(ProgramNumber)
    }

    /// Creates a number from 1 to 8; `None` for others.
    pub const fn new(number: u8) -> Option<Self> {
        if number >= 1 && number as usize <= ProgramNumber::COUNT { Some(ProgramNumber(number)) } else { None }
    }

    /// Returns 1 to 8.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl Cam {
    /// Returns whether the cam passes the end of the measuring range.
    pub fn wraps(self) -> bool {
        self.start > self.stop
    }

    /// Returns whether it is on at a position.
    pub fn is_on(self, position: Value) -> bool {
        if self.wraps() {
            position >= self.start || position <= self.stop
        } else {
            position >= self.start && position <= self.stop
        }
    }
}

impl Program {
    /// Cams of a program.
    pub const CAMS: usize = 8;

    /// Returns whether a cam is active.
    pub const fn is_on(&self, cam: CamNumber) -> bool {
        self.mask >> cam.0 & 1 == 1
    }

    /// Lets a cam work, or not.
    pub const fn set_on(&mut self, cam: CamNumber, on: bool) {
        self.mask = self.mask & !(1 << cam.0) | (on as u8) << cam.0;
    }

    /// Returns a cam; `None` if there is none.
    pub fn cam(&self, number: CamNumber) -> Option<Cam> {
        self.cams.get(usize::from(number.0)).copied().flatten()
    }

    /// Sets or removes a cam. The mask is unchanged.
    pub fn set_cam(&mut self, number: CamNumber, cam: Option<Cam>) {
        if let Some(place) = self.cams.get_mut(usize::from(number.0)) {
            *place = cam;
        }
    }

    /// Returns the outputs at a position: bit i for cam i.
    pub fn outputs(&self, position: Value) -> u8 {
        let on = |cam: &Option<Cam>| cam.is_some_and(|cam| cam.is_on(position));
        let all = self.cams.iter().rev().fold(0, |bits, cam| bits << 1 | u8::from(on(cam)));
        all & self.mask
    }
}
