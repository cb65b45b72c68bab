//! Which layouts are tried: all that the families can be set to and that end where the frames end, and any other.

use super::cost::Seen;
use crate::protocol::ssi::code::{Code, ungray};
use crate::protocol::ssi::descriptor::{Coded, Descriptor, Parity};
use crate::protocol::ssi::family::{Advice, Align, ErrorPlace, Families, Family, Settings};
use crate::protocol::ssi::layout::Layout;
use crate::protocol::ssi::range::Range;

/// A layout to be tried.
pub(super) struct Candidate {
    pub(super) family: Option<(String, Settings)>,
    pub(super) layout: Layout,
    /// How improbable it is beside others that read the same: settings that differ from those as delivered, then the
    /// family's place in the list; any other encoder last.
    pub(super) rank: (usize, usize),
}

/// Bits within a revolution.
pub(super) fn singleturn(candidate: &Candidate) -> u8 {
    match candidate.layout.descriptor().range {
        Range::Bits { singleturn, .. } => singleturn,
        _ => candidate.layout.coding().bits(),
    }
}

pub(super) fn candidates(families: &Families, seen: &Seen<'_>) -> Vec<Candidate> {
    let Some(last) = seen.last_moving() else { return Vec::new() };
    let mut all = Vec::new();
    for (place, family) in families.iter().enumerate() {
        of_family(&mut all, family, place, seen.clocks, last);
    }
    all.extend(any_other(seen, last));
    all
}

fn of_family(all: &mut Vec<Candidate>, family: &Family, place: usize, clocks: u8, last: u8) {
    let delivered = Settings { clocks: Some(clocks), ..Settings::default() };
    let turns: Vec<Option<u8>> = match family.multiturn {
        None => vec![None],
        Some((least, _, most)) => (least..=most).map(Some).collect(),
    };
    let shifts: &[bool] = if family.shift { &[false, true] } else { &[false] };
    let places = [ErrorPlace::None, ErrorPlace::Fix, ErrorPlace::Following];
    for multiturn in turns {
        for (at, align) in family.align.iter().enumerate() {
            for shift in shifts {
                for (code, coded) in CODES {
                    let end = end(last, coded);
                    for singleturn in steps_that_end(end, *align, multiturn.unwrap_or(0), *shift, family) {
                        for errors in places {
                            let settings = Settings {
                                multiturn,
                                singleturn: Some(singleturn),
                                align: Some(*align),
                                errors: Some(errors),
                                code: Some(code),
                                coded: Some(coded),
                                shift: *shift,
                                ..delivered.clone()
                            };
                            let Ok(resolved) = settings.resolve(family) else { continue };
                            if resolved.advice.iter().any(|advice| matches!(advice, Advice::Clocks { .. })) {
                                continue;
                            }
                            let set = [
                                multiturn != family.multiturn.map(|(_, delivered, _)| delivered),
                                singleturn != family.singleturn.1,
                                at > 0,
                                *shift,
                                coded != Coded::Position,
                                family.frames.iter().all(|frame| frame.place.first().unwrap_or(&places[0]) != &errors),
                            ];
                            let set = set.into_iter().filter(|set| *set).count();
                            let (family, layout) = (Some((family.key.clone(), settings)), resolved.layout);
                            all.push(Candidate { family, layout, rank: (set, place) });
                        }
                    }
                }
            }
        }
    }
}

const CODES: [(Code, Coded); 3] =
    [(Code::Binary, Coded::Position), (Code::Gray, Coded::Position), (Code::Gray, Coded::Area)];

/// Where the position ends. In a Gray code that goes over the zeros behind it, one more bit moves.
fn end(last_moving: u8, coded: Coded) -> u8 {
    if coded == Coded::Area { last_moving.saturating_sub(1) } else { last_moving }
}

/// Numbers of bits within a revolution with which the position ends on clock `last`.
fn steps_that_end(last: u8, align: Align, multiturn: u8, shift: bool, family: &Family) -> Vec<u8> {
    let (least, _, most) = family.singleturn;
    let late = u8::from(shift);
    let ends = |behind: u8| last.checked_sub(behind + late).into_iter().collect::<Vec<u8>>();
    let any = |clock: u8| if clock + late == last { (least..=most).collect() } else { Vec::new() };
    let mut steps = match align {
        Align::Left => ends(multiturn),
        Align::Tree12 => ends(12),
        Align::Tree13 => ends(13),
        Align::Right24 => any(24),
        Align::Right25 => any(25),
    };
    if shift && last == 25 {
        // The whole width is used, and the lowest bit pushed out.
        steps.push(most);
        steps.push(most - 1);
    }
    steps.retain(|steps| (least..=most).contains(steps));
    steps
}

/// A position of all bits up to the last that moves, alone or with a parity bit there; with an odd end of its range if
/// the frames went over it.
fn any_other(seen: &Seen<'_>, last: u8) -> Vec<Candidate> {
    let mut descriptors = Vec::new();
    for (code, coded) in CODES {
        let of = |bits: u8| {
            let area = if coded == Coded::Area { seen.clocks } else { bits };
            Descriptor { clocks: seen.clocks, code, coded, area, ..Descriptor::plain(0, bits.min(32)) }
        };
        let wide = |bits: u8| match bits {
            0..=32 => Range::Bits { multiturn: 0, singleturn: bits },
            _ => Range::Bits { multiturn: bits - 32, singleturn: 32 },
        };
        let end = end(last, coded);
        descriptors.push(Descriptor { range: wide(end), ..of(end) });
        if coded == Coded::Position && last > 1 {
            let parity = |even| Some(Parity { clock: last, even });
            for even in [false, true] {
                descriptors.push(Descriptor { range: wide(last - 1), parity: parity(even), ..of(last - 1) });
            }
        }
    }
    if last.is_multiple_of(4) && last <= 32 {
        let digits = 10_u32.saturating_pow(u32::from(last) / 4);
        let range = Range::Steps { per_turn: digits, turns: 1 };
        descriptors.push(Descriptor {
            range,
            code: Code::Bcd,
            area: last,
            clocks: seen.clocks,
            ..Descriptor::plain(0, 0)
        });
    }
    descriptors.extend(seen.excess(last).map(|(lead, steps)| Descriptor {
        range: Range::Steps { per_turn: steps, turns: 1 },
        code: Code::GrayExcess,
        area: last,
        lead,
        clocks: seen.clocks,
        ..Descriptor::plain(0, 0)
    }));
    let layouts = descriptors.into_iter().filter_map(|descriptor| Layout::new(descriptor).ok());
    layouts.map(|layout| Candidate { family: None, layout, rank: (usize::MAX, 0) }).collect()
}

impl Seen<'_> {
    /// Zeros before the position, and its steps, of a gray excess code whose end the frames went over: the lowest and
    /// the highest number are as far from the ends of the whole code, and follow one another.
    fn excess(&self, last: u8) -> Option<(u8, u32)> {
        let numbers = || self.words().map(|word| ungray(word >> (self.clocks - last)));
        let (lowest, highest) = (numbers().min()?, numbers().max()?);
        let bits = u8::try_from(64 - highest.leading_zeros()).ok()?;
        let whole = 1_u64.checked_shl(bits.into())?;
        let ends = |(a, b): (u64, u64)| a.min(b) == lowest && a.max(b) == highest;
        let met = numbers().zip(numbers().skip(1)).any(ends);
        let steps = u32::try_from(highest - lowest + 1).ok()?;
        (met && lowest > 0 && lowest + highest + 1 == whole && bits <= last).then(|| (last - bits, steps))
    }
}
