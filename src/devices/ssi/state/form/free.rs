//! Form rows for a frame that belongs to no family, or that its family cannot send.

use super::{CODES, Field, FieldInput, GRAY_COVERAGES, Group, RangeKind, Row, byte, number_word, position_rows};
use crate::devices::ssi::protocol::{BitMeaning, ErrorBit, Fraction, FrameDescriptor, Parity, Range, Repeat};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::design::{Edit, LayoutDesigner};

const KINDS: [RangeKind; 4] = [RangeKind::Bits, RangeKind::Steps, RangeKind::RoundAxis, RangeKind::Length];
const MAX_ERRORS: usize = 8;

pub(super) fn custom_frame_groups(designer: &LayoutDesigner) -> Vec<Group> {
    let descriptor = &designer.design().profile.descriptor;
    let position = position_rows(&KINDS, true, descriptor);
    let mut groups = vec![
        Group { title: "ssi_form.position", rows: position },
        Group { title: "ssi_form.frame", rows: frame_rows(descriptor) },
    ];
    groups.extend(descriptor.errors.iter().enumerate().map(|(index, bit)| error(index, bit)));
    groups
}

fn frame_rows(descriptor: &FrameDescriptor) -> Vec<Row> {
    let mut rows = vec![
        Row::with_number(Field::Clocks, "ssi_form.clocks", descriptor.clocks, ""),
        Row::with_number(Field::Lead, "ssi_form.lead", descriptor.lead, "bit"),
    ];
    if descriptor.range.multiturn_bits() > 0 {
        rows.push(Row::with_number(Field::Between, "ssi_form.between", descriptor.between, "bit"));
    }
    rows.push(Row::with_number(Field::Area, "ssi_form.area", descriptor.area, "").with_hint("ssi_form.area_hint"));
    rows.push(
        Row::with_switch(Field::Shift, "ssi_form.shift", descriptor.shift_right).with_hint("ssi_form.shift_hint"),
    );
    rows.push(
        Row::with_switch(Field::Inverted, "ssi_form.inverted", descriptor.inverted).with_hint("ssi_form.inverted_hint"),
    );
    let own = descriptor.parity.map(|parity| parity.even);
    let all = [
        (None, TEXTS.text("ssi_form.parity_none")),
        (Some(true), TEXTS.text("ssi_form.parity_even")),
        (Some(false), TEXTS.text("ssi_form.parity_odd")),
    ];
    rows.push(Row::with_choice(Field::Parity, "ssi_form.parity", &all, &own));
    if let Some(parity) = descriptor.parity {
        rows.push(Row::with_number(Field::ParityClock, "ssi_form.parity_clock", parity.clock, ""));
    }
    rows.push(
        Row::with_switch(Field::Repeat, "ssi_form.repeat", descriptor.repeat.is_some())
            .with_hint("ssi_form.repeat_hint"),
    );
    if let Some(repeat) = descriptor.repeat {
        rows.push(Row::with_number(Field::Gap, "ssi_form.gap", repeat.gap, "bit"));
    }
    rows
}

fn error(index: usize, bit: &ErrorBit) -> Group {
    let all =
        [(BitMeaning::Invalid, TEXTS.text("ssi_form.invalid")), (BitMeaning::Warning, TEXTS.text("ssi_form.warning"))];
    let name = super::Entry::Words(bit.name.clone());
    Group {
        title: "ssi_form.error_bit",
        rows: vec![
            Row { field: Field::ErrorName(index), name: TEXTS.text("ssi_form.error_name"), entry: name, hint: None },
            Row::with_number(Field::ErrorClock(index), "ssi_form.error_clock", bit.clock, ""),
            Row::with_choice(Field::ErrorMeaning(index), "ssi_form.error_meaning", &all, &bit.meaning),
            Row::with_switch(Field::ErrorLow(index), "ssi_form.error_low", bit.active_low),
            Row::with_switch(Field::ErrorCleared(index), "ssi_form.error_cleared", bit.cleared_by_transfer),
        ],
    }
}

/// Returns the edit for a changed field of a frame without a family, or `None` if such a frame does not have the field.
pub(super) fn edit_from_input(designer: &LayoutDesigner, field: Field, input: &FieldInput) -> Option<Edit> {
    let before = &designer.design().profile.descriptor;
    if let Some(range) = apply_range_input(&before.range, field, input) {
        return Some(Edit::Position(range, before.code));
    }
    if let (Field::Code, FieldInput::Choice(code)) = (field, input) {
        return Some(Edit::Position(before.range, *CODES.get(*code)?));
    }
    let mut next = before.clone();
    match (field, input) {
        (Field::Over, FieldInput::Choice(over)) => next.coded = *GRAY_COVERAGES.get(*over)?,
        (Field::Clocks, FieldInput::Number(clocks)) => next.clocks = byte(*clocks)?,
        // Parts after the position move with it.
        (Field::Lead, FieldInput::Number(lead)) => {
            return Some(Edit::Frame(Box::new(with_padding(before, byte(*lead)?, before.between)?)));
        }
        (Field::Between, FieldInput::Number(between)) => {
            return Some(Edit::Frame(Box::new(with_padding(before, before.lead, byte(*between)?)?)));
        }
        (Field::Area, FieldInput::Number(area)) => next.area = byte(*area)?,
        (Field::Shift, FieldInput::Switch(is_on)) => next.shift_right = *is_on,
        (Field::Inverted, FieldInput::Switch(is_on)) => next.inverted = *is_on,
        (Field::Parity, FieldInput::Choice(choice)) => next = with_parity(next, *choice)?,
        (Field::ParityClock, FieldInput::Number(clock)) => next.parity.as_mut()?.clock = byte(*clock)?,
        (Field::Repeat, FieldInput::Switch(true)) if before.repeat.is_none() => {
            next.repeat = Some(Repeat { word: before.clocks, gap: 1 });
            next.clocks = before.clocks.checked_mul(2)?.checked_add(1)?;
        }
        (Field::Repeat, FieldInput::Switch(false)) => {
            next.clocks = before.clocks_per_word();
            next.repeat = None;
        }
        (Field::Gap, FieldInput::Number(gap)) => {
            let repeat = next.repeat.as_mut()?;
            repeat.gap = byte(*gap)?;
            next.clocks = repeat.word.checked_mul(2)?.checked_add(repeat.gap)?;
        }
        (Field::ErrorName(index), FieldInput::Words(name)) => {
            name.trim().clone_into(&mut next.errors.get_mut(index)?.name)
        }
        (Field::ErrorClock(index), FieldInput::Number(clock)) => next.errors.get_mut(index)?.clock = byte(*clock)?,
        (Field::ErrorMeaning(index), FieldInput::Choice(choice)) => {
            next.errors.get_mut(index)?.meaning = if *choice == 0 { BitMeaning::Invalid } else { BitMeaning::Warning };
        }
        (Field::ErrorLow(index), FieldInput::Switch(is_on)) => next.errors.get_mut(index)?.active_low = *is_on,
        (Field::ErrorCleared(index), FieldInput::Switch(is_on)) => {
            next.errors.get_mut(index)?.cleared_by_transfer = *is_on
        }
        _ => return None,
    }
    Some(Edit::Frame(Box::new(next)))
}

fn apply_range_input(range: &Range, field: Field, input: &FieldInput) -> Option<Range> {
    if let (Field::Range, FieldInput::Choice(kind)) = (field, input) {
        let bits = range.bits().unwrap_or(12);
        return Some(match KINDS.get(*kind)? {
            RangeKind::Bits => Range::Bits { multiturn: bits.saturating_sub(13), singleturn: bits.min(13) },
            RangeKind::Steps => Range::Steps { per_turn: 360, turns: 1 },
            RangeKind::RoundAxis => {
                Range::RoundAxis { steps: 360, revolutions: Fraction { numerator: 1, denominator: 1 } }
            }
            RangeKind::Length => Range::Length { bits, step_nanometres: 1_000 },
        });
    }
    let FieldInput::Number(number) = input else { return None };
    Some(match (*range, field) {
        (Range::Bits { singleturn, .. }, Field::Multiturn) => Range::Bits { multiturn: byte(*number)?, singleturn },
        (Range::Bits { multiturn, .. }, Field::Singleturn) => Range::Bits { multiturn, singleturn: byte(*number)? },
        (Range::Steps { turns, .. }, Field::Steps) => Range::Steps { per_turn: number_word(*number)?, turns },
        (Range::Steps { per_turn, .. }, Field::Turns) => Range::Steps { per_turn, turns: number_word(*number)? },
        (Range::RoundAxis { revolutions, .. }, Field::Steps) => {
            Range::RoundAxis { steps: number_word(*number)?, revolutions }
        }
        (Range::RoundAxis { steps, revolutions }, Field::RevolutionsAbove) => {
            Range::RoundAxis { steps, revolutions: Fraction { numerator: number_word(*number)?, ..revolutions } }
        }
        (Range::RoundAxis { steps, revolutions }, Field::RevolutionsBelow) => {
            Range::RoundAxis { steps, revolutions: Fraction { denominator: number_word(*number)?, ..revolutions } }
        }
        (Range::Length { step_nanometres, .. }, Field::Bits) => Range::Length { bits: byte(*number)?, step_nanometres },
        (Range::Length { bits, .. }, Field::StepLength) => {
            Range::Length { bits, step_nanometres: number_word(*number)? }
        }
        _ => return None,
    })
}

/// Returns the frame with the given numbers of zeros before and within the position. The parts after the position are
/// moved accordingly.
fn with_padding(before: &FrameDescriptor, lead: u8, between: u8) -> Option<FrameDescriptor> {
    let by = i16::from(lead) + i16::from(between) - i16::from(before.lead) - i16::from(before.between);
    let moved = |clock: u8| u8::try_from(i16::from(clock) + by).ok();
    let mut next =
        FrameDescriptor { lead, between, area: moved(before.area)?, clocks: moved(before.clocks)?, ..before.clone() };
    for error in next.errors.iter_mut().filter(|error| error.clock > before.area) {
        error.clock = moved(error.clock)?;
    }
    if let Some(parity) = &mut next.parity {
        parity.clock = moved(parity.clock)?;
    }
    if let Some(repeat) = &mut next.repeat {
        repeat.word = moved(repeat.word)?;
        next.clocks = moved(next.clocks)?;
    }
    Some(next)
}

/// Returns the frame with another parity. A new parity bit is added as a clock at the end.
fn with_parity(mut next: FrameDescriptor, choice: usize) -> Option<FrameDescriptor> {
    match (choice, next.parity) {
        (0, Some(parity)) => {
            next.parity = None;
            // If the parity bit has the last clock, the clock is removed as well.
            if next.repeat.is_none() && parity.clock == next.clocks {
                next.clocks -= 1;
            }
        }
        (0, None) => {}
        (choice, Some(parity)) => next.parity = Some(Parity { even: choice == 1, ..parity }),
        (choice, None) => {
            let clock = next.clocks_per_word().checked_add(1)?;
            next.parity = Some(Parity { clock, even: choice == 1 });
            match &mut next.repeat {
                Some(repeat) => {
                    repeat.word = clock;
                    next.clocks = next.clocks.checked_add(2)?;
                }
                None => next.clocks = clock,
            }
        }
    }
    Some(next)
}

impl LayoutDesigner {
    /// Returns the frame with an additional error bit, or `None` if the frame already has the maximum number.
    pub fn with_error_bit(&self) -> Option<FrameDescriptor> {
        let mut next = self.design().profile.descriptor.clone();
        if next.errors.len() >= MAX_ERRORS || next.repeat.is_some() || next.clocks >= 64 {
            return None;
        }
        next.clocks += 1;
        let name =
            (1..).map(|number| format!("ERR{number}")).find(|name| next.errors.iter().all(|own| own.name != *name))?;
        next.errors.push(ErrorBit {
            name,
            clock: next.clocks,
            meaning: BitMeaning::Invalid,
            active_low: false,
            cleared_by_transfer: false,
        });
        Some(next)
    }

    /// Returns the frame without an error bit. Its clock becomes a zero, unless it is the last one.
    pub fn without_error_bit(&self, index: usize) -> FrameDescriptor {
        let mut next = self.design().profile.descriptor.clone();
        if index < next.errors.len() {
            let removed = next.errors.remove(index);
            // If the error bit is the only bit on the last clock, the clock is removed as well.
            if next.repeat.is_none() && next.parity.is_none() && removed.clock == next.clocks {
                next.clocks -= 1;
            }
        }
        next
    }
}
