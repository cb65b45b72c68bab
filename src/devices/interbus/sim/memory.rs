//! The settings of an encoder, and the EEPROM that stores them. The EEPROM is designed for about 200 write cycles, and
//! 500 at most (reference 3).

use crate::devices::interbus::protocol::{
    Cam, CamNumber, GUARANTEED_WRITE_CYCLES, Gear, Program, ProgramNumber, STEPS_PER_TURN, TURNS, Value, WindowShift,
};

/// The settings of an encoder, all of which can be stored in its EEPROM.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Memory {
    pub(super) gear: Gear,
    pub(super) counterclockwise: bool,
    pub(super) preset: u32,
    /// Whether a preset has been programmed but not yet executed.
    pub(super) armed: bool,
    pub(super) zero_shift: u32,
    pub(super) shift: WindowShift,
    pub(super) programs: [Program; ProgramNumber::COUNT],
}

impl Memory {
    /// Returns the factory settings: the largest gear and no active cams.
    pub(super) fn factory_default() -> Self {
        Memory {
            gear: FULL,
            counterclockwise: false,
            preset: 0,
            armed: false,
            zero_shift: 0,
            shift: WindowShift::default(),
            programs: [NONE; ProgramNumber::COUNT],
        }
    }

    pub const fn gear(&self) -> Gear {
        self.gear
    }

    /// Returns the direction parameter: 3 for clockwise, 4 for counterclockwise.
    pub const fn direction(&self) -> u32 {
        if self.counterclockwise { 4 } else { 3 }
    }

    pub const fn preset(&self) -> u32 {
        self.preset
    }

    /// Returns whether a preset has been programmed but not yet executed.
    pub const fn is_preset_armed(&self) -> bool {
        self.armed
    }

    pub const fn zero_shift(&self) -> u32 {
        self.zero_shift
    }

    pub const fn shift(&self) -> WindowShift {
        self.shift
    }

    /// Returns a cam program with all of its cams, including inactive ones.
    pub fn program(&self, number: ProgramNumber) -> &Program {
        let [first, ..] = &self.programs;
        self.programs.get(usize::from(number.get()) - 1).unwrap_or(first)
    }

    pub(super) fn program_mut(&mut self, number: ProgramNumber) -> Option<&mut Program> {
        self.programs.get_mut(usize::from(number.get()) - 1)
    }

    /// Adds cam programs for demonstration: a staircase, nested cams, and cams that wrap around the end of the range.
    /// If the range allows it, the example from the manual is added, with cam 3 on from 15 to 213.
    pub(super) fn with_demonstration_programs(mut self) -> Self {
        let steps = self.gear.total_steps();
        let place = |sixteenths: u32| (u64::from(steps) * u64::from(sixteenths) / 16) as u32;
        let cam = |start: u32, stop: u32| {
            Some(Cam { start: Value::from_word(start), stop: Value::from_word(stop.min(steps - 1)) })
        };
        let all = |edges: &dyn Fn(u32) -> Option<Cam>| {
            let mut program = Program { mask: 0xFF, ..NONE };
            program.cams.iter_mut().zip(0..).for_each(|(cam, number)| *cam = edges(number));
            program
        };
        let staircase = all(&|number| cam(place(2 * number), place(2 * number + 2).saturating_sub(1)));
        let within = all(&|number| cam(place(number), (steps - 1).saturating_sub(place(number))));
        let over_the_end = all(&|number| cam(place(15 - number), place(number)));
        let mut example = NONE;
        if let (true, Some(third)) = (steps > 213, example.cams.get_mut(3)) {
            (*third, example.mask) = (cam(15, 213), 1 << 3);
        }
        let [first, second, third, .., last] = &mut self.programs;
        (*first, *second, *third, *last) = (staircase, within, over_the_end, example);
        self
    }
}

/// A program without active cams.
const NONE: Program = {
    const ZERO: Cam = Cam { start: Value::from_word(0), stop: Value::from_word(0) };
    Program { cams: [Some(ZERO); Program::CAMS], mask: 0 }
};

/// The largest gear: all turns, with the maximum number of steps that fits into 25 bits.
const FULL: Gear = match Gear::new(Value::MAX.get(), TURNS) {
    Ok(gear) => gear,
    Err(_) => unreachable!(),
};

/// Non-volatile memory that stores a [`Memory`].
#[derive(Clone, Debug)]
pub(super) struct Eeprom {
    pub(super) kept: Memory,
    /// Whether the content was lost. If so, the encoder sends 86000000h until values are stored again.
    pub(super) lost: bool,
    stores: u32,
    /// Number of EEPROM write cycles in this simulation. The configured fault occurs when a given number is reached.
    begun: u32,
    die_in_store: Option<u32>,
}

/// The group of settings to be stored together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StoredSettings {
    Parameters,
    Program(ProgramNumber),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StoreOutcome {
    Kept,
    /// The EEPROM is worn out and its content is lost. The manual guarantees 500 write cycles and does not say what
    /// happens after that (`U`).
    Worn,
    /// The power was lost while the settings were being stored.
    Died,
}

impl Eeprom {
    pub(super) const fn new(kept: Memory, stores: u32, die_in_store: Option<u32>) -> Self {
        Eeprom { kept, lost: false, stores, begun: 0, die_in_store }
    }

    pub(super) const fn store_count(&self) -> u32 {
        self.stores
    }

    pub(super) const fn set_store_failure(&mut self, number: Option<u32>) {
        self.die_in_store = number;
    }

    /// Stores the settings. If this fails, the settings that were to be stored return to the factory settings (`U`: not
    /// documented).
    pub(super) fn store(&mut self, memory: &Memory, what: StoredSettings) -> StoreOutcome {
        self.stores = self.stores.saturating_add(1);
        self.begun = self.begun.saturating_add(1);
        let died = self.die_in_store == Some(self.begun);
        if !died && self.stores <= GUARANTEED_WRITE_CYCLES {
            (self.kept, self.lost) = (memory.clone(), false);
            return StoreOutcome::Kept;
        }
        self.lost = true;
        let delivered = Memory::factory_default();
        match what {
            StoredSettings::Parameters => {
                let Memory { shift, programs, .. } = self.kept.clone();
                self.kept = Memory { shift, programs, ..delivered };
            }
            StoredSettings::Program(number) => {
                if let Some(program) = self.kept.program_mut(number) {
                    *program = NONE;
                }
            }
        }
        if died { StoreOutcome::Died } else { StoreOutcome::Worn }
    }
}

pub(super) fn cam_mut(program: &mut Program, number: CamNumber) -> Option<&mut Cam> {
    program.cams.get_mut(usize::from(number.get())).and_then(Option::as_mut)
}

/// Number of shaft positions that an encoder can distinguish: its disc steps over all turns.
pub(super) const DISC_POSITIONS: u32 = STEPS_PER_TURN * TURNS;
