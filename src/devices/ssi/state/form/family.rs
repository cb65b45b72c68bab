//! Form rows for a family, one for each of its settings.

use super::{CODES, Field, FieldInput, GRAY_COVERAGES, Group, RangeKind, Row, byte, number_word, position_rows};
use crate::app::Text;
use crate::devices::ssi::protocol::{Alignment, Code, ErrorPlace, Family, Fraction, Frame, Range, Settings};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::design::LayoutDesigner;

pub(super) fn family_groups(designer: &LayoutDesigner, family: &Family, settings: &Settings) -> Vec<Group> {
    let descriptor = &designer.design().profile.descriptor;
    let kinds = possible_range_kinds(family);
    let position = position_rows(&kinds, family.multiturn.is_some(), descriptor);
    let mut frame = Vec::new();
    let resolved = settings.resolve(family).ok();
    if family.align.len() > 1 {
        let own = resolved.as_ref().map_or(Alignment::Left, |resolved| resolved.align);
        let all: Vec<(Alignment, Text)> = family.align.iter().map(|align| (*align, alignment_text(*align))).collect();
        frame.push(Row::with_choice(Field::Align, "ssi_form.align", &all, &own).with_hint("ssi_form.align_hint"));
    }
    if family.shift {
        frame.push(Row::with_switch(Field::Shift, "ssi_form.shift", settings.shift).with_hint("ssi_form.shift_hint"));
    }
    let places = possible_error_places(designer, family);
    if places.len() > 1 {
        let own = resolved.as_ref().map_or(ErrorPlace::None, |resolved| resolved.errors);
        let all: Vec<(ErrorPlace, Text)> = places.iter().map(|place| (*place, error_place_text(*place))).collect();
        frame.push(Row::with_choice(Field::Errors, "ssi_form.errors", &all, &own));
    }
    frame.push(Row::with_number(Field::Clocks, "ssi_form.clocks", descriptor.clocks, ""));
    vec![Group { title: "ssi_form.position", rows: position }, Group { title: "ssi_form.frame", rows: frame }]
}

/// Returns the family settings after a field was changed, or `None` if the field is not a family setting.
pub(super) fn settings_from_input(
    designer: &LayoutDesigner,
    family: &Family,
    settings: &Settings,
    field: Field,
    input: &FieldInput,
) -> Option<Settings> {
    let mut next = settings.clone();
    let range = designer.design().profile.descriptor.range;
    match (field, input) {
        (Field::Range, FieldInput::Choice(kind)) => {
            let others = Settings {
                multiturn: None,
                singleturn: None,
                steps: None,
                turns: None,
                revolutions: None,
                // An alignment for a range of bits may not be possible for a range of steps.
                align: None,
                clocks: None,
                ..next
            };
            next = match possible_range_kinds(family).get(*kind)? {
                RangeKind::Steps => Settings { steps: Some(360), ..others },
                RangeKind::RoundAxis => {
                    let revolutions = Some(Fraction { numerator: 1, denominator: 1 });
                    Settings { steps: Some(360), revolutions, ..others }
                }
                RangeKind::Bits | RangeKind::Length => others,
            };
            if next.code == Some(Code::GrayExcess) && next.steps.is_none() {
                next.code = None;
            }
        }
        (Field::Multiturn, FieldInput::Number(bits)) => next.multiturn = Some(byte(*bits)?),
        (Field::Singleturn | Field::Bits, FieldInput::Number(bits)) => next.singleturn = Some(byte(*bits)?),
        (Field::Steps, FieldInput::Number(steps)) => next.steps = Some(number_word(*steps)?),
        (Field::Turns, FieldInput::Number(turns)) => next.turns = Some(number_word(*turns)?),
        (Field::RevolutionsAbove | Field::RevolutionsBelow, FieldInput::Number(number)) => {
            let Range::RoundAxis { revolutions, .. } = range else { return None };
            let number = number_word(*number)?;
            next.revolutions = Some(match field {
                Field::RevolutionsAbove => Fraction { numerator: number, ..revolutions },
                _ => Fraction { denominator: number, ..revolutions },
            });
        }
        (Field::StepLength, FieldInput::Number(length)) => next.step_nanometres = Some(number_word(*length)?),
        (Field::Code, FieldInput::Choice(code)) => {
            next.code = Some(*CODES.get(*code)?);
            if next.code != Some(Code::Gray) {
                next.coded = None;
            }
        }
        (Field::Over, FieldInput::Choice(over)) => next.coded = Some(*GRAY_COVERAGES.get(*over)?),
        (Field::Align, FieldInput::Choice(align)) => next.align = Some(*family.align.get(*align)?),
        (Field::Shift, FieldInput::Switch(is_on)) => next.shift = *is_on,
        (Field::Errors, FieldInput::Choice(place)) => {
            next.errors = Some(*possible_error_places(designer, family).get(*place)?);
            // The length of the frame now depends on the error bits again.
            next.clocks = None;
        }
        (Field::Clocks, FieldInput::Number(clocks)) => next.clocks = Some(byte(*clocks)?),
        _ => return None,
    }
    // The number of clocks is adapted to the resolution, unless the user has set it.
    if matches!(field, Field::Multiturn | Field::Singleturn | Field::Bits | Field::Steps | Field::Turns)
        && settings.clocks.is_none()
    {
        next.clocks = None;
    }
    Some(next)
}

fn possible_range_kinds(family: &Family) -> Vec<RangeKind> {
    if family.step_nanometres.is_some() {
        return vec![RangeKind::Length];
    }
    let steps = family.steps.is_some().then_some(RangeKind::Steps);
    let round = family.steps.is_some_and(|limits| limits.revolutions.is_some()).then_some(RangeKind::RoundAxis);
    std::iter::once(RangeKind::Bits).chain(steps).chain(round).collect()
}

fn possible_error_places(designer: &LayoutDesigner, family: &Family) -> Vec<ErrorPlace> {
    let bits = designer.layout().position_code().bits();
    let frame: Option<&Frame> = family.frames.iter().find(|frame| bits <= frame.up_to).or(family.frames.last());
    frame.map(|frame| frame.place.clone()).unwrap_or_default()
}

fn alignment_text(align: Alignment) -> Text {
    TEXTS.text(match align {
        Alignment::Left => "ssi_form.left",
        Alignment::Right24 => "ssi_form.right24",
        Alignment::Right25 => "ssi_form.right25",
        Alignment::Tree12 => "ssi_form.tree12",
        Alignment::Tree13 => "ssi_form.tree13",
    })
}

fn error_place_text(place: ErrorPlace) -> Text {
    TEXTS.text(match place {
        ErrorPlace::None => "ssi_form.errors_none",
        ErrorPlace::Fix => "ssi_form.errors_fix",
        ErrorPlace::Following => "ssi_form.errors_following",
    })
}
