//! The form for editing a layout: its rows as data, and the effect of each entry. For a family, the form has a row for
//! each setting, and for any other frame it has all rows.

mod family;
mod free;

use super::design::{Edit, LayoutDesigner};
use crate::app::{Text, explain};
use crate::devices::ssi::protocol::{Code, Direction, Fraction, FrameDescriptor, GrayCoverage, Range};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain as words;

#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub field: Field,
    pub name: Text,
    pub entry: Entry,
    pub hint: Option<&'static str>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    Number {
        value: u64,
        unit: Option<Text>,
    },
    /// Frequency in hertz, which is displayed in a suitable unit.
    Frequency(u32),
    Choice {
        options: Vec<Text>,
        /// Index of the chosen option.
        chosen: usize,
    },
    Switch(bool),
    Words(String),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FieldInput {
    Number(u64),
    Choice(usize),
    Switch(bool),
    Words(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Field {
    /// Type of range: bits, steps, round axis or length.
    Range,
    /// Number of bits for turns.
    Multiturn,
    /// Number of bits for steps within a turn.
    Singleturn,
    /// Number of steps per turn or in total.
    Steps,
    /// Number of turns, if the number of steps per turn is fixed.
    Turns,
    RevolutionsAbove,
    RevolutionsBelow,
    /// Number of bits of a linear position.
    Bits,
    /// Step length of a linear encoder in nanometres.
    StepLength,
    Code,
    /// Bits that a Gray code covers.
    Over,
    Align,
    Shift,
    Errors,
    Clocks,
    Lead,
    Between,
    Area,
    Inverted,
    Parity,
    ParityClock,
    Repeat,
    /// Number of zeros between the two words of a repeated frame.
    Gap,
    Direction,
    Preset,
    ErrorName(usize),
    ErrorClock(usize),
    ErrorMeaning(usize),
    /// Whether the error bit with the given index is active low.
    ErrorLow(usize),
    ErrorCleared(usize),
    ClockRate,
    /// Pause between two bursts in microseconds.
    Pause,
    /// Cable length in metres, or 0 if the cable is not checked.
    Cable,
    /// Whether the encoder samples a position when the host starts a transfer.
    Synchronous,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Identifier of the group's heading in the message catalogue.
    pub title: &'static str,
    pub rows: Vec<Row>,
}

impl Group {
    /// Returns the index of the error bit if the group belongs to one.
    pub fn error(&self) -> Option<usize> {
        match self.rows.first()?.field {
            Field::ErrorName(index) => Some(index),
            _ => None,
        }
    }

    /// Returns whether error bits can be added, which requires a frame without a family.
    pub fn accepts_error_bits(&self) -> bool {
        self.rows.iter().any(|row| row.field == Field::Lead)
    }

    /// Returns whether the group can be collapsed in a low window. The position and the error bits always stay open.
    pub fn is_foldable(&self) -> bool {
        matches!(self.title, "ssi_form.frame" | "ssi_form.counting")
    }
}

impl Row {
    /// Creates a row with a number. `unit` is the symbol of its unit, or empty.
    fn with_number(field: Field, name: &'static str, value: impl Into<u64>, unit: &'static str) -> Self {
        let unit = match unit {
            "" => None,
            "bit" => Some(TEXTS.text("ssi_form.bit")),
            symbol => Some(explain::literal_text(symbol)),
        };
        Row { field, name: TEXTS.text(name), entry: Entry::Number { value: value.into(), unit }, hint: None }
    }

    fn with_switch(field: Field, name: &'static str, is_on: bool) -> Self {
        Row { field, name: TEXTS.text(name), entry: Entry::Switch(is_on), hint: None }
    }

    /// Creates a row with a choice. `all` lists the options with their labels.
    fn with_choice<T: PartialEq>(field: Field, name: &'static str, all: &[(T, Text)], own: &T) -> Self {
        let chosen = all.iter().position(|(one, _)| one == own).unwrap_or(usize::MAX);
        let options = all.iter().map(|(_, words)| words.clone()).collect();
        Row { field, name: TEXTS.text(name), entry: Entry::Choice { options, chosen }, hint: None }
    }

    fn with_hint(self, hint: &'static str) -> Self {
        Row { hint: Some(hint), ..self }
    }
}

impl LayoutDesigner {
    pub fn form_groups(&self) -> Vec<Group> {
        let mut groups = match (self.family(), &self.design().settings) {
            (Some(family), Some(settings)) => family::family_groups(self, family, settings),
            _ => free::custom_frame_groups(self),
        };
        groups.push(counting_group(self));
        groups
    }

    pub fn reading_form(&self) -> Vec<Row> {
        let reading = &self.design().profile.reading;
        let mut rows = vec![
            Row {
                field: Field::ClockRate,
                name: TEXTS.text("ssi_form.clock"),
                entry: Entry::Frequency(reading.clock_hz),
                hint: None,
            },
            Row::with_number(Field::Pause, "ssi_form.pause", reading.pause_us, "µs").with_hint("ssi_form.pause_hint"),
            Row::with_number(Field::Cable, "ssi_form.cable", reading.cable_metres.unwrap_or(0), "m")
                .with_hint("ssi_form.cable_hint"),
        ];
        if reading.synchronous || self.times().is_some_and(|times| times.synchronous.is_some()) {
            rows.push(
                Row::with_switch(Field::Synchronous, "ssi_form.synchronous", reading.synchronous)
                    .with_hint("ssi_form.synchronous_hint"),
            );
        }
        rows
    }

    /// Converts an entry to a change of the layout.
    ///
    /// # Errors
    /// Returns an error with the reason if the entry is invalid.
    pub(super) fn parse_entry(&self, field: Field, input: &FieldInput) -> Result<Edit, Text> {
        let wrong = || TEXTS.text("ssi_form.wrong");
        match (field, input) {
            (Field::Direction, FieldInput::Choice(0)) => return Ok(Edit::Direction(Direction::Clockwise)),
            (Field::Direction, FieldInput::Choice(_)) => return Ok(Edit::Direction(Direction::CounterClockwise)),
            (Field::Preset, FieldInput::Number(preset)) => return Ok(Edit::Preset(*preset)),
            (Field::ClockRate | Field::Pause | Field::Cable | Field::Synchronous, input) => {
                return self.apply_reading_input(field, input).ok_or_else(wrong);
            }
            _ => {}
        }
        match (self.family(), &self.design().settings) {
            (Some(family), Some(settings)) => {
                let entered = family::settings_from_input(self, family, settings, field, input);
                entered.map(|settings| Edit::Settings(Box::new(settings))).ok_or_else(wrong)
            }
            _ => free::edit_from_input(self, field, input).ok_or_else(wrong),
        }
    }

    fn apply_reading_input(&self, field: Field, input: &FieldInput) -> Option<Edit> {
        let mut reading = self.design().profile.reading;
        match (field, input) {
            (Field::ClockRate, FieldInput::Number(hz)) => {
                reading.clock_hz = u32::try_from(*hz).ok().filter(|hz| (1_000..=20_000_000).contains(hz))?;
            }
            (Field::Pause, FieldInput::Number(us)) => {
                reading.pause_us = u16::try_from(*us).ok().filter(|us| *us > 0)?
            }
            (Field::Cable, FieldInput::Number(metres)) => {
                reading.cable_metres = Some(u16::try_from(*metres).ok()?).filter(|metres| *metres > 0);
            }
            (Field::Synchronous, FieldInput::Switch(is_on)) => reading.synchronous = *is_on,
            _ => return None,
        }
        Some(Edit::Reading(reading))
    }
}

/// Returns the name of a counting direction, which differs between linear and rotary encoders.
pub(super) fn direction_text(direction: Direction, is_length: bool) -> Text {
    TEXTS.text(match (direction, is_length) {
        (Direction::Clockwise, false) => "ssi_form.cw",
        (Direction::CounterClockwise, false) => "ssi_form.ccw",
        (Direction::Clockwise, true) => "ssi_form.forwards",
        (Direction::CounterClockwise, true) => "ssi_form.backwards",
    })
}

/// Describes the bits that a Gray code covers.
pub(super) fn coverage_text(coded: GrayCoverage) -> Text {
    TEXTS.text(match coded {
        GrayCoverage::Position => "ssi_form.over_position",
        GrayCoverage::Area => "ssi_form.over_area",
        GrayCoverage::AreaAndErrors => "ssi_form.over_errors",
    })
}

fn counting_group(designer: &LayoutDesigner) -> Group {
    let profile = &designer.design().profile;
    let is_length = matches!(profile.descriptor.range, Range::Length { .. });
    let all = [Direction::Clockwise, Direction::CounterClockwise].map(|own| (own, direction_text(own, is_length)));
    Group {
        title: "ssi_form.counting",
        rows: vec![
            Row::with_choice(Field::Direction, "ssi_form.direction", &all, &profile.direction)
                .with_hint("ssi_form.direction_hint"),
            Row::with_number(Field::Preset, "ssi_form.preset", profile.preset, "").with_hint("ssi_form.preset_hint"),
        ],
    }
}

const CODES: [Code; 4] = [Code::Binary, Code::Gray, Code::GrayExcess, Code::Bcd];
const GRAY_COVERAGES: [GrayCoverage; 3] = [GrayCoverage::Position, GrayCoverage::Area, GrayCoverage::AreaAndErrors];

fn code_row(own: Code) -> Row {
    let all = CODES.map(|code| (code, words::code_text(code)));
    Row::with_choice(Field::Code, "ssi_form.code", &all, &own)
}

fn coded_range_row(own: GrayCoverage) -> Row {
    Row::with_choice(Field::Over, "ssi_form.over", &GRAY_COVERAGES.map(|coded| (coded, coverage_text(coded))), &own)
        .with_hint("ssi_form.over_hint")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RangeKind {
    Bits,
    Steps,
    RoundAxis,
    Length,
}

impl RangeKind {
    fn from_range(range: &Range) -> Self {
        match range {
            Range::Bits { .. } => RangeKind::Bits,
            Range::Steps { .. } => RangeKind::Steps,
            Range::RoundAxis { .. } => RangeKind::RoundAxis,
            Range::Length { .. } => RangeKind::Length,
        }
    }

    fn label(self) -> Text {
        TEXTS.text(match self {
            RangeKind::Bits => "ssi_form.range_bits",
            RangeKind::Steps => "ssi_form.range_steps",
            RangeKind::RoundAxis => "ssi_form.range_round",
            RangeKind::Length => "ssi_form.range_length",
        })
    }
}

/// Returns the form rows for the positions and the code of a frame. The user can select one of `kinds` as the type of
/// range.
fn position_rows(kinds: &[RangeKind], has_turns: bool, descriptor: &FrameDescriptor) -> Vec<Row> {
    let mut rows = Vec::new();
    if kinds.len() > 1 {
        rows.push(range_row(kinds, &descriptor.range));
    }
    match descriptor.range {
        Range::Bits { multiturn, singleturn } => {
            rows.extend(has_turns.then(|| Row::with_number(Field::Multiturn, "ssi_form.multiturn", multiturn, "bit")));
            rows.push(Row::with_number(Field::Singleturn, "ssi_form.singleturn", singleturn, "bit"));
        }
        Range::Steps { per_turn, turns } => {
            rows.push(Row::with_number(Field::Steps, "ssi_form.steps_per_turn", per_turn, ""));
            rows.extend(has_turns.then(|| Row::with_number(Field::Turns, "ssi_form.turns", turns, "")));
        }
        Range::RoundAxis { steps, revolutions: Fraction { numerator, denominator } } => {
            rows.push(Row::with_number(Field::Steps, "ssi_form.steps_around", steps, ""));
            rows.push(
                Row::with_number(Field::RevolutionsAbove, "ssi_form.revolutions", numerator, "")
                    .with_hint("ssi_form.revolutions_hint"),
            );
            rows.push(Row::with_number(Field::RevolutionsBelow, "ssi_form.revolutions_below", denominator, ""));
        }
        Range::Length { bits, step_nanometres } => {
            rows.push(Row::with_number(Field::Bits, "ssi_form.bits", bits, "bit"));
            rows.push(Row::with_number(Field::StepLength, "ssi_form.step", step_nanometres, "nm"));
        }
    }
    rows.push(code_row(descriptor.code));
    if descriptor.code == Code::Gray {
        rows.push(coded_range_row(descriptor.coded));
    }
    rows
}

fn range_row(kinds: &[RangeKind], range: &Range) -> Row {
    let all: Vec<(RangeKind, Text)> = kinds.iter().map(|kind| (*kind, kind.label())).collect();
    Row::with_choice(Field::Range, "ssi_form.range", &all, &RangeKind::from_range(range))
}

/// Parses a whole number in any common notation, such as 3600, 3 600 or 0x0E10.
///
/// # Errors
/// Returns an error with the reason if the entry is invalid.
pub fn parse_whole(text: &str) -> Result<u64, Text> {
    let plain: String = text.chars().filter(|c| !c.is_whitespace() && !matches!(c, '_' | '’' | '\'')).collect();
    let number = match plain.strip_prefix("0x").or_else(|| plain.strip_prefix("0X")) {
        Some(hex) => u64::from_str_radix(hex, 16),
        None => plain.parse(),
    };
    let signed = plain.contains(['+', '-']);
    number.ok().filter(|_| !signed).ok_or_else(|| TEXTS.text("ssi_form.whole").with("text", text.trim()))
}

fn byte(number: u64) -> Option<u8> {
    u8::try_from(number).ok()
}

fn number_word(number: u64) -> Option<u32> {
    u32::try_from(number).ok()
}
