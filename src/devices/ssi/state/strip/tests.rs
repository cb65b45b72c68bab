//! Tests of frame cells, and of moves that must yield frames of the reference (section 8).

use proptest::prelude::*;

use super::*;
use crate::app::Language;
use crate::devices::ssi::protocol::{Code, ErrorBit, Families, Fraction, FrameDescriptor, Parity, Repeat, Settings};

fn bit(name: &str, clock: u8) -> ErrorBit {
    ErrorBit {
        name: name.to_owned(),
        clock,
        meaning: BitMeaning::Invalid,
        active_low: false,
        cleared_by_transfer: false,
    }
}

fn family(key: &str, settings: &Settings) -> Strip {
    let families = Families::built_in();
    Strip::from_layout(&settings.resolve(families.find_by_key(key).unwrap()).unwrap().layout)
}

fn frame(strip: &Strip, position: u64, errors: &[usize]) -> u64 {
    let flags = errors.iter().fold(Flags::NONE, |all, index| all.union(Flags::error(*index)));
    strip.layout().encode(position, flags).unwrap()
}

fn kinds(strip: &Strip) -> Vec<(Kind, u8, u8)> {
    strip.fields().iter().map(|field| (field.kind, field.first, field.last)).collect()
}

/// Generates valid layouts with error and parity bits anywhere.
fn layouts() -> impl Strategy<Value = Layout> {
    let range = prop_oneof![
        (0..=32_u8, 0..=32_u8).prop_map(|(multiturn, singleturn)| Range::Bits { multiturn, singleturn }),
        (1..10_u8, 1..10_u8).prop_map(|(multiturn, singleturn)| Range::Bits { multiturn, singleturn }),
        (2..5000_u32, 1..500_u32).prop_map(|(per_turn, turns)| Range::Steps { per_turn, turns }),
        (2..100_000_u32, 1..50_u32, 1..50_u32).prop_map(|(steps, numerator, denominator)| Range::RoundAxis {
            steps,
            revolutions: Fraction { numerator, denominator },
        }),
        (1..=40_u8).prop_map(|bits| Range::Length { bits, step_nanometres: 1000 }),
    ];
    let code =
        prop_oneof![3 => Just(Code::Binary), 3 => Just(Code::Gray), 1 => Just(Code::GrayExcess), 1 => Just(Code::Bcd)];
    let coded = prop_oneof![3 => Just(GrayCoverage::Position), 1 => Just(GrayCoverage::Area), 1 => Just(GrayCoverage::AreaAndErrors)];
    let zeros = (0..6_u8, 0..4_u8, 0..6_u8, 0..4_u8);
    let bits = (prop::collection::vec(0..20_u8, 0..4), prop::option::of((0..20_u8, any::<bool>())));
    let rest = (any::<bool>(), any::<bool>(), prop::option::of((0..3_u8, 0..3_u8)));
    (range, code, coded, zeros, bits, rest).prop_filter_map(
        "cannot work",
        |(range, code, coded, (lead, between, tail, late), (errors, parity), (shift_right, inverted, twice))| {
            let bits = crate::devices::ssi::protocol::PositionCode::new(code, range.last_position().ok()?).ok()?.bits();
            let between = if matches!(range, Range::Bits { multiturn: 1.., singleturn: 1.. }) { between } else { 0 };
            let needed = lead + between + bits;
            let area = needed + tail;
            let word = area + late + errors.len() as u8 + 3;
            let errors: Vec<_> =
                errors.iter().enumerate().map(|(i, at)| bit(&format!("E{i}"), needed + 1 + at)).collect();
            let repeat = twice.map(|(gap, _)| Repeat { word, gap });
            Layout::new(FrameDescriptor {
                clocks: twice.map_or(Some(word), |(gap, behind)| word.checked_mul(2)?.checked_add(gap + behind))?,
                range,
                code,
                coded,
                area,
                lead,
                between,
                shift_right,
                errors,
                parity: parity.map(|(at, even)| Parity { clock: needed + 1 + at, even }),
                repeat,
                inverted,
                patterns: Vec::new(),
            })
            .ok()
        },
    )
}

/// Returns the frame with its area extended to the whole word if the area has no effect.
fn without_area(layout: &Layout) -> FrameDescriptor {
    let mut descriptor = layout.descriptor().clone();
    if !descriptor.shift_right && descriptor.coded == GrayCoverage::Position {
        descriptor.area = descriptor.clocks_per_word();
    }
    descriptor
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 200_000, ..ProptestConfig::default() })]

    #[test]
    fn moves_are_reversible(layout in layouts(), which in any::<prop::sample::Index>(), to in 0..=70_u8, following: bool) {
        let strip = Strip::from_layout(&layout);
        let handle = strip.strip_handles()[which.index(strip.strip_handles().len())];
        let at = strip.clock(handle).unwrap();
        let there = strip.with_moved_part(handle, to, following);
        let reached = there.clock(handle).unwrap();
        prop_assert!((at.min(to)..=at.max(to)).contains(&reached), "{handle:?}: {at} to {to}, at {reached}");
        // A bit that is moved directly after other bits follows the position from then on.
        prop_assume!(moving::bits_after_position(there.layout()).len() == moving::bits_after_position(&layout).len() || !following);
        // The end of an area that the position now fills also follows the position.
        let fills = |layout: &Layout| moving::position_end(layout) == layout.descriptor().area;
        prop_assume!(fills(there.layout()) == fills(&layout) || !following);
        let back = there.with_moved_part(handle, at, following);
        prop_assert_eq!(back.clock(handle), Some(at), "{:?} at {}", handle, reached);
        prop_assert_eq!(without_area(back.layout()), without_area(&layout), "{:?}: {} to {}", handle, at, reached);
    }

    #[test]
    fn moves_stop_at_limits(layout in layouts(), which in any::<prop::sample::Index>(), to in 0..=70_u8) {
        let strip = Strip::from_layout(&layout);
        let handle = strip.strip_handles()[which.index(strip.strip_handles().len())];
        let (least, most) = strip.limits(handle, false);
        for end in [least, most] {
            prop_assert_eq!(strip.with_moved_part(handle, end, false).clock(handle), Some(end));
        }
        let reached = strip.with_moved_part(handle, to, false).clock(handle).unwrap();
        prop_assert!((least..=most).contains(&reached));
    }

    #[test]
    fn every_clock_has_field_and_label(layout in layouts()) {
        let strip = Strip::from_layout(&layout);
        let mut next = 1;
        for field in strip.fields() {
            prop_assert_eq!(field.first, next);
            next = field.last + 1;
        }
        prop_assert_eq!(next, layout.clock_count() + 1);
        prop_assert_eq!(strip.cells().len(), usize::from(layout.clock_count()));
        for clock in 1..=layout.clock_count() {
            let words = cell_text(&strip, clock).to_string_in(Language::English);
            prop_assert!(words.starts_with(&format!("Clock {clock}: ")) && !words.contains('{'), "{}", words);
        }
        for own in strip.strip_handles() {
            for text in [handle_text(&strip, *own), value(&strip, *own), handle_hint(*own)] {
                let words = text.to_string_in(Language::German);
                prop_assert!(words != text.id() && !words.contains('{'), "{}", words);
            }
        }
    }
}

#[test]
fn divides_frames_into_fields() {
    let tree = family("atm60", &Settings { multiturn: Some(8), singleturn: Some(8), ..Settings::default() });
    let position = [(Kind::Before, 1, 4), (Kind::Turns, 5, 12), (Kind::Steps, 13, 20), (Kind::Behind, 21, 25)];
    assert_eq!(kinds(&tree), position);
    let handles = [Handle::LeadEnd, Handle::Position, Handle::Split, Handle::BetweenEnd, Handle::StepsEnd];
    assert_eq!(tree.strip_handles()[..5], handles);
    assert_eq!(tree.strip_handles()[5..], [Handle::FrameEnd]);
    assert_eq!(tree.position(), Some((5, 20)));
    // The turn bits are on clocks 5 to 12, so MT3 is on clock 9.
    assert_eq!(cell_text(&tree, 9).to_string_in(Language::English), "Clock 9: turn bit MT3 (number of turn bits: 8)");
    assert_eq!(short_label(&tree, &tree.fields()[2]).to_string_in(Language::German), "ST 8");

    let twice = Layout::new(FrameDescriptor {
        clocks: 20,
        parity: Some(Parity { clock: 9, even: false }),
        repeat: Some(Repeat { word: 9, gap: 1 }),
        ..FrameDescriptor::binary(0, 8)
    });
    let twice = Strip::from_layout(&twice.unwrap());
    let fields =
        [(Kind::Steps, 1, 8), (Kind::Parity, 9, 9), (Kind::Gap, 10, 10), (Kind::Again, 11, 19), (Kind::After, 20, 20)];
    assert_eq!(kinds(&twice), fields);
    assert_eq!(cell_text(&twice, 9).to_string_in(Language::German), "Takt 9: ungerade Parität über die Takte 1 bis 8");
    assert_eq!(cell_text(&twice, 13).to_string_in(Language::English), "Clock 13: repeats the bit of clock 3");
}

/// An AHS36 has 14 position bits and the error bit on clock 15. The position is then shortened to 12 bits.
#[test]
fn error_bits_can_follow_step_end() {
    let strip = family("ahs36", &Settings::default());
    assert!(bits_follow_position(strip.layout()));
    let fixed = strip.with_moved_part(Handle::StepsEnd, 12, false);
    assert_eq!(frame(&fixed, 0xABC, &[0]), 0x55E1);
    let following = strip.with_moved_part(Handle::StepsEnd, 12, true);
    assert_eq!(frame(&following, 0xABC, &[0]), 0x55E4);
    assert_eq!((bits_follow_position(fixed.layout()), bits_follow_position(following.layout())), (false, true));
    // The error bit blocks the move. If the bit follows the position, the end of the frame is the limit.
    assert_eq!(strip.limits(Handle::StepsEnd, false), (1, 14));
    assert_eq!(strip.limits(Handle::StepsEnd, true), (1, 14));
    assert_eq!(fixed.limits(Handle::StepsEnd, true), (1, 14));
}

/// An ATM60 frame with 25 clocks, 8 turn bits and 8 step bits, in both tree formats and right-aligned.
#[test]
fn moved_boundaries_reproduce_documented_formats() {
    let position = 0xA5 << 8 | 0x3C;
    let whole = Strip::from_layout(&Layout::new(FrameDescriptor::binary(12, 13)).unwrap());
    let tree = whole.with_moved_part(Handle::LeadEnd, 4, true).with_moved_part(Handle::StepsEnd, 20, true);
    assert_eq!(frame(&tree, position, &[]), 0x014_A780);
    let other = whole.with_moved_part(Handle::Split, 13, true).with_moved_part(Handle::LeadEnd, 5, true);
    assert_eq!(frame(&other.with_moved_part(Handle::StepsEnd, 21, true), position, &[]), 0x00A_53C0);
    let right = tree.with_moved_part(Handle::Position, 9, true);
    assert_eq!(frame(&right, position, &[]), 0x001_4A78);
    // With two zeros between turns and steps, the turns can be extended over these zeros.
    let apart = tree.with_moved_part(Handle::BetweenEnd, 14, true);
    assert_eq!(kinds(&apart)[1..4], [(Kind::Turns, 5, 12), (Kind::Between, 13, 14), (Kind::Steps, 15, 20)]);
    assert_eq!(apart.with_moved_part(Handle::TurnsEnd, 20, true).clock(Handle::TurnsEnd), Some(14));
    assert!(apart.strip_handles().contains(&Handle::TurnsEnd) && !apart.strip_handles().contains(&Handle::Split));
}

/// A TTK70 is extended to 31 clocks. The pattern of a KH53 becomes longer together with its frame.
#[test]
fn extending_frame_adds_zeros() {
    let ttk = family("ttk70", &Settings::default());
    let longer = ttk.with_moved_part(Handle::FrameEnd, 31, true);
    assert_eq!(frame(&longer, 0x12_3456, &[0]), 0x091A_2B40);
    assert_eq!(ttk.limits(Handle::FrameEnd, true), (26, 64));
    let kh53 = family("kh53", &Settings::default());
    let longer = kh53.with_moved_part(Handle::FrameEnd, 26, true);
    assert!(longer.layout().decode(0x3FF_FFF8).flags.contains(Flags::pattern_flag(0)));
    assert!(!longer.layout().decode(0xFF_FFFE).flags.contains(Flags::pattern_flag(0)));
    assert_eq!(longer.with_moved_part(Handle::FrameEnd, 0, true).layout(), kh53.layout());
}

#[test]
fn error_bits_swap_positions() {
    let strip = family("afs60", &Settings::default());
    let names = |strip: &Strip| [19, 20, 21].map(|clock| strip.layout().role_name(strip.cells()[clock - 1].role));
    assert_eq!(names(&strip), ["ERRDIG", "ERRSI", "ERRSYNC"]);
    let moved = strip.with_moved_part(Handle::Error(0), 21, true);
    assert_eq!(names(&moved), ["ERRSYNC", "ERRSI", "ERRDIG"]);
    // A bit cannot be moved into the position or beyond the end of the frame.
    assert_eq!(strip.with_moved_part(Handle::Error(2), 5, true).clock(Handle::Error(2)), Some(19));
    assert_eq!(strip.with_moved_part(Handle::Error(0), 64, true).clock(Handle::Error(0)), Some(21));
}

#[test]
fn step_positions_move_as_one_field() {
    let settings = Settings { steps: Some(3600), ..Settings::default() };
    let strip = family("ahs36", &settings);
    let inside = [Handle::LeadEnd, Handle::Split, Handle::TurnsEnd, Handle::BetweenEnd, Handle::StepsEnd];
    assert!(inside.iter().all(|handle| !strip.strip_handles().contains(handle) && strip.clock(*handle).is_none()));
    // The position has 12 bits on clocks 1 to 12, followed by two zeros and the error bit on clock 15.
    assert_eq!(strip.limits(Handle::Position, true), (1, 3));
    assert_eq!(
        kinds(&strip.with_moved_part(Handle::Position, 9, true))[..2],
        [(Kind::Before, 1, 2), (Kind::Position, 3, 14)]
    );
}

#[test]
fn cells_show_decoded_values() {
    let strip = family("afs60", &Settings { singleturn: Some(13), clocks: Some(18), ..Settings::default() });
    // The position is 1234h, ERRSI is active, and clock 18 carries a 1 although it should always be 0.
    let shown = strip.cell_states(0x91A2 << 2 | 1);
    let meaning: Vec<_> =
        (1..).zip(&shown).filter_map(|(clock, cell)| cell.meaning.map(|meaning| (clock, meaning))).collect();
    assert_eq!(meaning, [(15, BitMeaning::Invalid), (18, BitMeaning::Warning)]);
    let bits: String = shown.iter().map(|cell| if cell.bit { '1' } else { '0' }).collect();
    assert_eq!(bits, "100100011010001001");
}
