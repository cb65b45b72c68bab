//! Moves parts of a frame. The result is always a valid frame. If the requested clock is not possible, the part moves
//! towards it as far as possible.

use super::{Handle, PositionParts, has_explicit_bit_patterns};
use crate::devices::ssi::protocol::{FrameDescriptor, GrayCoverage, Layout, Parity, Pattern, Range, Repeat, Word};

/// Returns the frame after a part was moved to a clock, or as close to it as possible.
///
/// Other parts remain in place. However, error and parity bits directly after the position move with its end if
/// `following` is set. A bit that is moved onto another one swaps places with it.
#[must_use]
pub fn move_part(layout: &Layout, handle: Handle, to: u8, following: bool) -> Layout {
    let Some(at) = clock(layout, handle) else { return layout.clone() };
    let to = to.min(64);
    let between = to.abs_diff(at);
    let tried = (0..between).map(|back| if to > at { to - back } else { to + back });
    let mut tried = tried.filter_map(|to| Layout::new(try_move(layout, handle, (at, to), following)?).ok());
    tried.next().unwrap_or_else(|| layout.clone())
}

/// Returns the movable parts of a frame, in clock order.
pub(super) fn strip_handles(layout: &Layout) -> Vec<Handle> {
    let descriptor = layout.descriptor();
    let mut handles = vec![Handle::Position];
    match PositionParts::from_layout(layout) {
        PositionParts::Both(..) if descriptor.between == 0 => {
            handles.extend([Handle::LeadEnd, Handle::Split, Handle::BetweenEnd, Handle::StepsEnd]);
        }
        PositionParts::Both(..) => {
            handles.extend([Handle::LeadEnd, Handle::TurnsEnd, Handle::BetweenEnd, Handle::StepsEnd])
        }
        PositionParts::One(_) => handles.extend([Handle::LeadEnd, Handle::StepsEnd]),
        PositionParts::Whole(_) => {}
    }
    if depends_on_area_end(descriptor) {
        handles.push(Handle::AreaEnd);
    }
    handles.extend((0..descriptor.errors.len()).map(Handle::Error));
    handles.extend(descriptor.parity.map(|_| Handle::Parity));
    if descriptor.repeat.is_some() && !has_explicit_bit_patterns(layout) {
        handles.extend([Handle::WordEnd, Handle::GapEnd]);
    }
    handles.push(Handle::FrameEnd);
    handles.sort_by_key(|handle| clock(layout, *handle));
    handles
}

/// Returns the clock of a part, or `None` if the frame does not have the part.
pub(super) fn clock(layout: &Layout, handle: Handle) -> Option<u8> {
    let descriptor = layout.descriptor();
    let begins = descriptor.lead + u8::from(descriptor.shift_right);
    let parts = PositionParts::from_layout(layout);
    let is_bits = !matches!(parts, PositionParts::Whole(_));
    match (handle, parts) {
        (Handle::LeadEnd, _) => is_bits.then_some(begins),
        (Handle::Split | Handle::TurnsEnd, PositionParts::Both(turns, _)) => Some(begins + turns),
        (Handle::BetweenEnd, PositionParts::Both(turns, _)) => Some(begins + turns + descriptor.between),
        (Handle::StepsEnd, parts) => is_bits.then_some(begins + descriptor.between + parts.bits()),
        (Handle::AreaEnd, _) => depends_on_area_end(descriptor).then_some(descriptor.area),
        (Handle::WordEnd, _) => descriptor.repeat.map(|repeat| repeat.word),
        (Handle::GapEnd, _) => descriptor.repeat.map(|repeat| repeat.word + repeat.gap),
        (Handle::FrameEnd, _) => Some(descriptor.clocks),
        (Handle::Position, _) => Some(begins + 1),
        (Handle::Error(index), _) => descriptor.errors.get(index).map(|bit| bit.clock),
        (Handle::Parity, _) => descriptor.parity.map(|parity| parity.clock),
        _ => None,
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SingleBit {
    Error(usize),
    Parity,
}

/// Returns the error and parity bits that directly follow the position.
pub(super) fn bits_after_position(layout: &Layout) -> Vec<SingleBit> {
    let descriptor = layout.descriptor();
    let mut next = position_end(layout) + 1;
    let mut chain = Vec::new();
    while let Some(single) = single_bit_at(descriptor, next) {
        chain.push(single);
        next += 1;
    }
    chain
}

fn single_bit_at(descriptor: &FrameDescriptor, clock: u8) -> Option<SingleBit> {
    let error = descriptor.errors.iter().position(|bit| bit.clock == clock).map(SingleBit::Error);
    error.or_else(|| descriptor.parity.filter(|parity| parity.clock == clock).map(|_| SingleBit::Parity))
}

/// Returns the last clock of the position. Bits that are shifted out of the area do not have a clock.
pub(super) fn position_end(layout: &Layout) -> u8 {
    let descriptor = layout.descriptor();
    let late = u8::from(descriptor.shift_right);
    (descriptor.lead + descriptor.between + PositionParts::from_layout(layout).bits() + late).min(descriptor.area)
}

/// Returns whether the frame depends on the end of the area.
const fn depends_on_area_end(descriptor: &FrameDescriptor) -> bool {
    descriptor.shift_right || !matches!(descriptor.coded, GrayCoverage::Position)
}

/// Returns the frame with a part moved from one clock to another, or `None` if no descriptor can express it. The frame
/// may be invalid.
fn try_move(layout: &Layout, handle: Handle, (at, to): (u8, u8), following: bool) -> Option<FrameDescriptor> {
    let by = i16::from(to) - i16::from(at);
    let mut new = layout.descriptor().clone();
    let both = matches!(PositionParts::from_layout(layout), PositionParts::Both(..));
    match handle {
        Handle::LeadEnd => {
            new.lead = checked_offset(new.lead, by)?;
            new.range =
                if both { with_resized_range(new.range, -by, 0)? } else { resize_single_part_range(new.range, -by)? };
        }
        Handle::Split if new.between > 0 => return None,
        Handle::Split => new.range = with_resized_range(new.range, by, -by)?,
        Handle::TurnsEnd => {
            new.range = with_resized_range(new.range, by, 0)?;
            new.between = checked_offset(new.between, -by)?;
        }
        Handle::BetweenEnd => {
            new.range = with_resized_range(new.range, 0, -by)?;
            new.between = checked_offset(new.between, by)?;
        }
        Handle::StepsEnd => {
            new.range =
                if both { with_resized_range(new.range, 0, by)? } else { resize_single_part_range(new.range, by)? };
            move_following_parts(layout, &mut new, by, following)?;
        }
        Handle::Position => {
            new.lead = checked_offset(new.lead, by)?;
            move_following_parts(layout, &mut new, by, following)?;
        }
        Handle::AreaEnd => new.area = to,
        Handle::WordEnd => {
            new.repeat = new.repeat.map(|repeat| Repeat { word: to, ..repeat });
            new.clocks = checked_offset(new.clocks, 2 * by)?;
        }
        Handle::GapEnd => {
            let Repeat { word, gap } = new.repeat?;
            new.repeat = Some(Repeat { word, gap: checked_offset(gap, by)? });
            new.clocks = checked_offset(new.clocks, by)?;
        }
        Handle::FrameEnd => {
            new.clocks = to;
            new.patterns =
                new.patterns.into_iter().map(|pattern| with_longer_pattern(pattern, by)).collect::<Option<_>>()?;
        }
        Handle::Error(index) => move_bit(&mut new, SingleBit::Error(index), at, to),
        Handle::Parity => move_bit(&mut new, SingleBit::Parity, at, to),
    }
    if !depends_on_area_end(&new) {
        // The area has no effect on the frame, but it must provide enough room for the position.
        let needed = u16::from(new.lead) + u16::from(new.between) + u16::from(bits(&new, layout));
        new.area = new.area.max(u8::try_from(needed).ok()?).min(new.clocks_per_word());
    }
    Some(new)
}

/// Returns the width of the code word. The code does not change when parts are moved.
fn bits(new: &FrameDescriptor, old: &Layout) -> u8 {
    match PositionParts::from_layout(old) {
        PositionParts::Whole(bits) => bits,
        PositionParts::Both(..) | PositionParts::One(_) => new.range.bits().unwrap_or(u8::MAX),
    }
}

/// Moves the parts after the position together with its end.
fn move_following_parts(old: &Layout, new: &mut FrameDescriptor, by: i16, following: bool) -> Option<()> {
    let chain = bits_after_position(old);
    if !following || chain.is_empty() {
        return Some(());
    }
    if depends_on_area_end(new) && position_end(old) == new.area {
        new.area = checked_offset(new.area, by)?;
    }
    for single in chain {
        let clock = bit_clock(new, single)?;
        set_bit(new, single, checked_offset(clock, by)?);
    }
    Some(())
}

/// Moves a bit to another clock. If there is already a bit at that clock, the bits swap places.
fn move_bit(descriptor: &mut FrameDescriptor, single: SingleBit, at: u8, to: u8) {
    let other = single_bit_at(descriptor, to);
    set_bit(descriptor, single, to);
    if let Some(other) = other {
        set_bit(descriptor, other, at);
    }
}

fn bit_clock(descriptor: &FrameDescriptor, single: SingleBit) -> Option<u8> {
    match single {
        SingleBit::Error(index) => descriptor.errors.get(index).map(|bit| bit.clock),
        SingleBit::Parity => descriptor.parity.map(|parity| parity.clock),
    }
}

fn set_bit(descriptor: &mut FrameDescriptor, single: SingleBit, clock: u8) {
    match single {
        SingleBit::Error(index) => {
            if let Some(bit) = descriptor.errors.get_mut(index) {
                bit.clock = clock;
            }
        }
        SingleBit::Parity => descriptor.parity = descriptor.parity.map(|parity| Parity { clock, ..parity }),
    }
}

fn checked_offset(value: u8, by: i16) -> Option<u8> {
    u8::try_from(i16::from(value) + by).ok()
}

/// Returns the range with other numbers of turn bits and step bits, or `None` if either becomes 0.
fn with_resized_range(range: Range, turns: i16, steps: i16) -> Option<Range> {
    let Range::Bits { multiturn, singleturn } = range else { return None };
    let multiturn = checked_offset(multiturn, turns).filter(|bits| *bits > 0)?;
    let singleturn = checked_offset(singleturn, steps).filter(|bits| *bits > 0)?;
    Some(Range::Bits { multiturn, singleturn })
}

/// Returns the range with another number of bits, or `None` if the number becomes 0 or the range is not defined by
/// bits.
fn resize_single_part_range(range: Range, by: i16) -> Option<Range> {
    let more = |bits| checked_offset(bits, by).filter(|bits| *bits > 0);
    match range {
        Range::Bits { multiturn, singleturn: 0 } => Some(Range::Bits { multiturn: more(multiturn)?, singleturn: 0 }),
        Range::Bits { multiturn, singleturn } => Some(Range::Bits { multiturn, singleturn: more(singleturn)? }),
        Range::Length { bits, step_nanometres } => Some(Range::Length { bits: more(bits)?, step_nanometres }),
        Range::Steps { .. } | Range::RoundAxis { .. } => None,
    }
}

/// Returns the pattern for a longer or shorter frame. Zeros are added or removed at its end.
fn with_longer_pattern(pattern: Pattern, by: i16) -> Option<Pattern> {
    let Word::Bits(word) = pattern.word else { return Some(pattern) };
    let count = u32::from(by.unsigned_abs());
    let word = if by >= 0 {
        word.checked_shl(count).filter(|longer| longer >> count == word)?
    } else {
        word.checked_shr(count).filter(|shorter| shorter << count == word)?
    };
    Some(Pattern { word: Word::Bits(word), ..pattern })
}
