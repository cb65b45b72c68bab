//! The settings and measured values of an encoder. The command `read` accepts their names, such as `steps`, `cam:2:5`
//! and `cam-mask:2`.

use std::fmt;
use std::str::FromStr;

use super::{Direction, Image, Parameters};
use crate::devices::interbus::protocol::{Cam, CamNumber, Parameter, Program, ProgramNumber, WindowShift};

/// A setting or measured value of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Item {
    /// Steps over all programmed turns.
    Steps,
    /// Number of turns after which the position repeats.
    Revolutions,
    /// Counting direction.
    Direction,
    /// Preset value of the position.
    Preset,
    /// Shift of the zero point.
    ZeroShift,
    /// Window shift in cam mode, shared by all programs.
    Shift,
    /// Mask of active cams in a program.
    CamMask(ProgramNumber),
    /// Both edges of a cam.
    Cam(ProgramNumber, CamNumber),
    /// Temperature of the encoder.
    Temperature,
    /// Operating time.
    OperatingTime,
}

/// The value of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ItemValue {
    /// Steps, turns, a position or the window shift.
    Number(u32),
    /// Counting direction.
    Direction(Direction),
    /// Mask with bit i for cam i.
    Mask(u8),
    /// Both edges of a cam.
    Cam(Cam),
    /// Temperature in tenths of a degree Celsius.
    TenthsOfDegree(i32),
    /// Operating time in minutes, with a resolution of ten minutes.
    Minutes(u32),
}

/// The reason why a string is not an item name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ItemError {
    /// The string matches none of the item names.
    #[error("{0:?} is not an item; items are {ITEMS}")]
    Unknown(String),
    /// The program does not exist.
    #[error("program {number} is outside the range 1 to {}", ProgramNumber::COUNT)]
    Program {
        /// Given program number.
        number: u64,
    },
    /// The cam does not exist.
    #[error("cam {number} is outside the range 0 to {}", Program::CAMS - 1)]
    Cam {
        /// Given cam number.
        number: u64,
    },
}

const ITEMS: &str = "steps, revolutions, direction, preset, zero-shift, shift, cam:P:C (program 1 to 8, cam 0 to 7), \
                     cam-mask:P, temperature and operating-time";

impl Item {
    /// Items without a program or cam number, in comparison order.
    const UNNUMBERED_ITEMS: [Item; 8] = [
        Item::Steps,
        Item::Revolutions,
        Item::Direction,
        Item::Preset,
        Item::ZeroShift,
        Item::Shift,
        Item::Temperature,
        Item::OperatingTime,
    ];

    /// Returns all writable items in comparison order. The parameters and the shift come first, then the mask and cams
    /// of each program.
    pub fn writable_items() -> impl Iterator<Item = Item> {
        let plain = Item::UNNUMBERED_ITEMS.into_iter().filter(|item| item.is_writable());
        plain.chain(ProgramNumber::all().flat_map(Item::program_items))
    }

    /// Returns the mask and the cams of a program.
    pub fn program_items(program: ProgramNumber) -> impl Iterator<Item = Item> {
        std::iter::once(Item::CamMask(program)).chain(CamNumber::all().map(move |cam| Item::Cam(program, cam)))
    }

    /// Returns whether the item is a setting. Measured values cannot be written.
    pub const fn is_writable(self) -> bool {
        !matches!(self, Item::Temperature | Item::OperatingTime)
    }

    /// Returns the corresponding parameter, or `None` for cam items and measured values.
    pub const fn parameter(self) -> Option<Parameter> {
        match self {
            Item::Steps => Some(Parameter::Steps),
            Item::Revolutions => Some(Parameter::Turns),
            Item::Direction => Some(Parameter::Direction),
            Item::Preset => Some(Parameter::Preset),
            Item::ZeroShift => Some(Parameter::ZeroShift),
            Item::Shift | Item::CamMask(_) | Item::Cam(..) | Item::Temperature | Item::OperatingTime => None,
        }
    }

    /// Returns the item of a parameter, or `None` if the parameter is not a setting.
    pub const fn from_parameter(parameter: Parameter) -> Option<Self> {
        match parameter {
            Parameter::Steps => Some(Item::Steps),
            Parameter::Turns => Some(Item::Revolutions),
            Parameter::Direction => Some(Item::Direction),
            Parameter::Preset => Some(Item::Preset),
            Parameter::ZeroShift => Some(Item::ZeroShift),
            Parameter::Default => None,
        }
    }

    /// Returns the program to which the item belongs, or `None` if it belongs to no program.
    pub const fn program(self) -> Option<ProgramNumber> {
        match self {
            Item::CamMask(program) | Item::Cam(program, _) => Some(program),
            _ => None,
        }
    }

    /// Returns the unit of the value, or an empty string if there is none.
    pub const fn unit(self) -> &'static str {
        match self {
            Item::Steps | Item::Preset | Item::ZeroShift | Item::Cam(..) => "steps",
            Item::Revolutions => "turns",
            Item::Shift => "bits",
            Item::Temperature => "°C",
            Item::OperatingTime => "min",
            Item::Direction | Item::CamMask(_) => "",
        }
    }
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Item::Steps => f.write_str("steps"),
            Item::Revolutions => f.write_str("revolutions"),
            Item::Direction => f.write_str("direction"),
            Item::Preset => f.write_str("preset"),
            Item::ZeroShift => f.write_str("zero-shift"),
            Item::Shift => f.write_str("shift"),
            Item::CamMask(program) => write!(f, "cam-mask:{}", program.get()),
            Item::Cam(program, cam) => write!(f, "cam:{}:{}", program.get(), cam.get()),
            Item::Temperature => f.write_str("temperature"),
            Item::OperatingTime => f.write_str("operating-time"),
        }
    }
}

impl FromStr for Item {
    type Err = ItemError;

    fn from_str(text: &str) -> Result<Self, ItemError> {
        if let Some(plain) = Item::UNNUMBERED_ITEMS.into_iter().find(|item| item.to_string() == text) {
            return Ok(plain);
        }
        let unknown = || ItemError::Unknown(text.to_owned());
        let number = |text: &str| match text.bytes().all(|c| c.is_ascii_digit()) {
            true => text.parse::<u64>().map_err(|_| unknown()),
            false => Err(unknown()),
        };
        let program = |text: &str| {
            let number = number(text)?;
            u8::try_from(number).ok().and_then(ProgramNumber::new).ok_or(ItemError::Program { number })
        };
        let cam = |text: &str| {
            let number = number(text)?;
            u8::try_from(number).ok().and_then(CamNumber::new).ok_or(ItemError::Cam { number })
        };
        match text.split(':').collect::<Vec<_>>().as_slice() {
            ["cam-mask", of] => Ok(Item::CamMask(program(of)?)),
            ["cam", of, which] => Ok(Item::Cam(program(of)?, cam(which)?)),
            _ => Err(unknown()),
        }
    }
}

impl fmt::Display for ItemValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ItemValue::Number(number) | ItemValue::Minutes(number) => write!(f, "{number}"),
            ItemValue::Direction(direction) => direction.fmt(f),
            ItemValue::Mask(mask) => write!(f, "0x{mask:02X}"),
            ItemValue::Cam(cam) => write!(f, "{}..{}", cam.start.get(), cam.stop.get()),
            ItemValue::TenthsOfDegree(tenths) => write!(f, "{:.1}", f64::from(*tenths) / 10.0),
        }
    }
}

impl Image {
    /// Returns the value of an item, or `None` if it is unknown or measured.
    pub fn get_value(&self, item: Item) -> Option<ItemValue> {
        let number = ItemValue::Number;
        let Parameters { steps, revolutions, direction, preset, zero_shift } = self.parameters;
        Some(match item {
            Item::Steps => number(steps),
            Item::Revolutions => number(revolutions),
            Item::Direction => ItemValue::Direction(direction),
            Item::Preset => number(preset),
            Item::ZeroShift => number(zero_shift),
            Item::Shift => number(self.shift?.get().into()),
            Item::CamMask(program) => ItemValue::Mask(self.program(program)?.mask),
            Item::Cam(program, cam) => ItemValue::Cam(self.program(program)?.cam(cam)?),
            Item::Temperature | Item::OperatingTime => return None,
        })
    }

    /// Sets the value of an item. Returns `false` if the value is not valid for the item. If the item belongs to a
    /// program that does not exist yet, the program is created with a mask of 0.
    pub fn set_value(&mut self, item: Item, value: ItemValue) -> bool {
        let parameters = &mut self.parameters;
        match (item, value) {
            (Item::Steps, ItemValue::Number(steps)) => parameters.steps = steps,
            (Item::Revolutions, ItemValue::Number(revolutions)) => parameters.revolutions = revolutions,
            (Item::Direction, ItemValue::Direction(direction)) => parameters.direction = direction,
            (Item::Preset, ItemValue::Number(preset)) => parameters.preset = preset,
            (Item::ZeroShift, ItemValue::Number(zero_shift)) => parameters.zero_shift = zero_shift,
            (Item::Shift, ItemValue::Number(shift)) => match u8::try_from(shift).ok().and_then(WindowShift::new) {
                Some(shift) => self.shift = Some(shift),
                None => return false,
            },
            (Item::CamMask(program), ItemValue::Mask(mask)) => self.modify_program(program, |own| own.mask = mask),
            (Item::Cam(program, number), ItemValue::Cam(cam)) => {
                self.modify_program(program, |own| own.set_cam(number, Some(cam)));
            }
            _ => return false,
        }
        true
    }

    fn modify_program(&mut self, number: ProgramNumber, change: impl FnOnce(&mut Program)) {
        if let Some(place) = self.program_mut(number) {
            change(place.get_or_insert_default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_profiles::{cam_between, image};
    use super::*;

    #[test]
    fn item_names_match_command_line() {
        for text in [
            "steps",
            "revolutions",
            "direction",
            "preset",
            "zero-shift",
            "shift",
            "cam:1:0",
            "cam:8:7",
            "cam-mask:1",
            "cam-mask:8",
            "temperature",
            "operating-time",
        ] {
            assert_eq!(text.parse::<Item>().map(|item| item.to_string()).as_deref(), Ok(text));
        }
        for text in ["", "Steps", "cam", "cam:1", "cam:1:0:0", "cam:+1:0", "cam:1:", "cam:x:0", "cam-mask", "mask:1"] {
            assert_eq!(text.parse::<Item>(), Err(ItemError::Unknown(text.to_owned())));
        }
        let said = |text: &str| text.parse::<Item>().unwrap_err().to_string();
        assert_eq!(said("cam:9:0"), "program 9 is outside the range 1 to 8");
        assert_eq!(said("cam-mask:0"), "program 0 is outside the range 1 to 8");
        assert_eq!(said("cam:1:8"), "cam 8 is outside the range 0 to 7");
    }

    #[test]
    fn items_round_trip_through_image() {
        // Five parameters, the shift, eight programs with a mask and eight cams.
        assert_eq!(Item::writable_items().count(), 5 + 1 + 8 * 9);
        let full = image();
        let mut copy = Image::from_parameters(Parameters {
            steps: 1,
            revolutions: 2,
            preset: 3,
            zero_shift: 4,
            ..full.parameters
        });
        for item in Item::writable_items() {
            assert!(copy.set_value(item, full.get_value(item).unwrap()), "{item}");
        }
        assert_eq!(copy, full);
        for (item, value) in [
            (Item::Steps, ItemValue::Mask(1)),
            (Item::Shift, ItemValue::Number(26)),
            (Item::Temperature, ItemValue::TenthsOfDegree(0)),
        ] {
            assert!(!copy.set_value(item, value), "{item}");
        }
        assert_eq!(copy, full);
    }

    #[test]
    fn values_print_as_typed() {
        let said = |value: ItemValue| value.to_string();
        assert_eq!(said(ItemValue::Cam(cam_between(3500, 40))), "3500..40");
        assert_eq!(said(ItemValue::Mask(0x0B)), "0x0B");
        assert_eq!(said(ItemValue::Direction(Direction::Counterclockwise)), "ccw");
        assert_eq!(said(ItemValue::TenthsOfDegree(-3)), "-0.3");
    }
}
