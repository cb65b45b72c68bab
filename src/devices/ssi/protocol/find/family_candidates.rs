//! Candidate layouts of an encoder family. Only settings whose position ends at the clock found in the recorded frames
//! are tried.

use super::candidates::{GRAY_PADDING_WEIGHT, SWAPPED_WIRES_WEIGHT, TestCandidateFn, find_ambiguous_parity, sum};
use super::frame_set::FrameSet;
use super::plausible::width_penalty;
use super::reading::FrameNumbers;
use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::{FrameDescriptor, GrayCoverage};
use crate::devices::ssi::protocol::family::{Alignment, ErrorPlace, Family, SettingAdvice, Settings};
use crate::devices::ssi::protocol::layout::Layout;
use crate::devices::ssi::protocol::range::Range;

/// Weight of a setting that differs from the factory setting.
const CHANGED_SETTING_WEIGHT: f64 = 0.8;

/// Tries every frame that the family can send. Families earlier in the list are slightly preferred.
pub(super) fn try_families(
    take: &mut TestCandidateFn<'_>,
    read: &FrameNumbers,
    words: &FrameSet,
    (place, family): (usize, &Family),
    inverted: bool,
) {
    let reading = &read.reading;
    let turns: Vec<Option<u8>> = match family.multiturn {
        None => vec![None],
        Some((least, _, most)) => (least..=most).map(Some).collect(),
    };
    let shifts: &[bool] = if family.shift { &[false, true] } else { &[false] };
    let coded: &[GrayCoverage] = match reading.code {
        Code::Gray if find_ambiguous_parity(reading, inverted).is_some() => {
            &[GrayCoverage::Position, GrayCoverage::Area, GrayCoverage::AreaAndErrors]
        }
        _ => &[GrayCoverage::Position],
    };
    let places = [ErrorPlace::None, ErrorPlace::Fix, ErrorPlace::Following];
    for (at, align) in family.align.iter().enumerate() {
        for shift in shifts {
            for coded in coded {
                for errors in places {
                    let common = Settings {
                        clocks: Some(words.clocks),
                        align: Some(*align),
                        errors: Some(errors),
                        code: Some(reading.code),
                        coded: Some(*coded),
                        shift: *shift,
                        ..Settings::default()
                    };
                    let all = match reading.steps {
                        Some((steps, _)) => vec![Settings { steps: u32::try_from(steps).ok(), ..common }],
                        None => find_resolutions(&turns, family, &common, (reading.last, *align)),
                    };
                    for settings in all {
                        let Ok(resolved) = settings.resolve(family) else { continue };
                        if resolved.advice.iter().any(|advice| matches!(advice, SettingAdvice::Clocks { .. })) {
                            continue;
                        }
                        let descriptor = FrameDescriptor { inverted, ..resolved.layout.descriptor().clone() };
                        let Ok(layout) = Layout::new(descriptor) else { continue };
                        let delivered_place =
                            family.frames.iter().any(|frame| frame.place.first().unwrap_or(&places[0]) == &errors);
                        let changed = [
                            settings.multiturn.is_some()
                                && settings.multiturn != family.multiturn.map(|(_, delivered, _)| delivered),
                            settings.singleturn.is_some_and(|own| own != family.singleturn.1),
                            settings.steps.is_some(),
                            at > 0,
                            *shift,
                            !delivered_place,
                            reading.code != family.code() && !family.codes.contains(&reading.code),
                        ];
                        let changed = changed.iter().filter(|changed| **changed).count();
                        let unusual = match layout.descriptor().range {
                            Range::Bits { multiturn, singleturn } => width_penalty(multiturn, singleturn) / 2.0,
                            _ => 0.0,
                        };
                        let weights =
                            [(inverted, SWAPPED_WIRES_WEIGHT), (*coded != GrayCoverage::Position, GRAY_PADDING_WEIGHT)];
                        let weight =
                            CHANGED_SETTING_WEIGHT * changed as f64 + unusual + place as f64 * 0.01 + sum(&weights);
                        take(Some((family.key.clone(), settings)), layout, weight);
                    }
                }
            }
        }
    }
}

/// Returns the settings whose position ends at the last clock that was found, or one clock earlier.
fn find_resolutions(
    turns: &[Option<u8>],
    family: &Family,
    common: &Settings,
    (last, align): (u8, Alignment),
) -> Vec<Settings> {
    let (least, _, most) = family.singleturn;
    let late = u8::from(common.shift);
    let mut all = Vec::new();
    for multiturn in turns {
        let before = match align {
            Alignment::Left => multiturn.unwrap_or(0),
            Alignment::Tree12 => 12,
            Alignment::Tree13 => 13,
            // The position ends on a fixed clock.
            Alignment::Right24 | Alignment::Right25 => {
                let ends = if align == Alignment::Right24 { 24 } else { 25 };
                if (last..=last + 1).contains(&(ends + late)) {
                    all.extend((least..=most).map(|steps| (*multiturn, steps)));
                }
                continue;
            }
        };
        let ends = [last, last.saturating_sub(1)].into_iter().filter_map(|last| last.checked_sub(before + late));
        all.extend(ends.map(|steps| (*multiturn, steps)));
        if common.shift && last == 25 {
            // The position has its full width, and the shift removes the lowest bit.
            all.extend([(*multiturn, most), (*multiturn, most - 1)]);
        }
    }
    all.retain(|(_, steps)| (least..=most).contains(steps));
    all.into_iter()
        .map(|(multiturn, steps)| Settings { multiturn, singleturn: Some(steps), ..common.clone() })
        .collect()
}
