//! Tests that positions round-trip through valid layouts, and that invalid layouts are rejected with a reason.

use proptest::prelude::*;

use super::*;
use crate::devices::ssi::protocol::{BitMeaning, Code, ErrorBit, Fraction, Parity, Range, Repeat};

/// Generates valid layouts with error bits, zeros, repetition, parity, and any code.
pub(crate) fn layouts() -> impl Strategy<Value = Layout> {
    let range = prop_oneof![
        (0..=32_u8, 0..=32_u8).prop_map(|(multiturn, singleturn)| Range::Bits { multiturn, singleturn }),
        (2..100_000_u32, 1..5000_u32).prop_map(|(per_turn, turns)| Range::Steps { per_turn, turns }),
        (2..100_000_u32, 1..5000_u32, 1..5000_u32).prop_map(|(steps, numerator, denominator)| Range::RoundAxis {
            steps,
            revolutions: Fraction { numerator, denominator },
        }),
        (1..=64_u8).prop_map(|bits| Range::Length { bits, step_nanometres: 1000 }),
    ];
    let code = prop_oneof![Just(Code::Binary), Just(Code::Gray), Just(Code::GrayExcess), Just(Code::Bcd)];
    let coded = prop_oneof![Just(GrayCoverage::Position), Just(GrayCoverage::Area), Just(GrayCoverage::AreaAndErrors)];
    let zeros = (0..6_u8, 0..4_u8, 0..6_u8);
    let more = (0..3_u8, any::<bool>(), any::<bool>(), any::<bool>(), any::<Option<bool>>(), any::<bool>());
    (range, code, coded, zeros, more).prop_filter_map(
        "cannot work",
        |(range, code, coded, (lead, between, tail), (errors, shift_right, inverted, active_low, even, twice))| {
            let bits = PositionCode::new(code, range.last_position().ok()?).ok()?.bits();
            let area = lead + between + tail + bits;
            let parity = even.map(|even| Parity { clock: area + errors + 1, even });
            let word = area + errors + u8::from(parity.is_some());
            let repeat = twice.then_some(Repeat { word, gap: 1 });
            Layout::new(FrameDescriptor {
                clocks: if twice { word.checked_mul(2)?.checked_add(1)? } else { word },
                range,
                code,
                coded,
                area,
                lead,
                between,
                shift_right,
                errors: (0..errors)
                    .map(|index| ErrorBit {
                        name: format!("E{index}"),
                        clock: area + 1 + index,
                        meaning: BitMeaning::Invalid,
                        active_low,
                        cleared_by_transfer: false,
                    })
                    .collect(),
                parity,
                repeat,
                inverted,
                patterns: Vec::new(),
            })
            .ok()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 100_000, ..ProptestConfig::default() })]

    #[test]
    fn encoded_frames_decode(layout in layouts(), position in any::<u64>(), raised in 0..4_u32) {
        let last = layout.position_code().last_position();
        let position = last.checked_add(1).map_or(position, |count| position % count);
        let errors = layout.descriptor().errors.len();
        let flags = (0..errors).filter(|index| raised >> index & 1 == 1);
        let flags = flags.fold(Flags::NONE, |all, index| all.union(Flags::error(index)));
        let frame = layout.encode(position, flags).unwrap();
        let reading = layout.decode(frame);
        let seen = FrameReading { flags: Flags(reading.flags.0 & !(Flags::ALL_ONES.0 | Flags::ALL_ZEROS.0)), ..reading };
        let kept = if layout.loses_lowest_bit() { position & !1 } else { position };
        prop_assert_eq!(seen, FrameReading { position: kept, flags });
    }

    /// A parity bit detects every single inverted bit, and a repetition detects every inverted bit in either word.
    #[test]
    fn parity_and_repetition_detect_flipped_bits(layout in layouts(), position in any::<u64>(), at in 0..64_u8) {
        let last = layout.position_code().last_position();
        let position = last.checked_add(1).map_or(position, |count| position % count);
        let clocks = layout.clock_count();
        let frame = layout.encode(position, Flags::NONE).unwrap() ^ 1 << (at % clocks);
        let reading = layout.decode(frame);
        let descriptor = layout.descriptor();
        if descriptor.repeat.is_some() {
            prop_assert!(reading.flags.intersects(Flags::REPEAT.union(Flags::PADDING)));
        } else if descriptor.parity.is_some() {
            prop_assert!(reading.flags.contains(Flags::PARITY));
        }
    }

    #[test]
    fn arbitrary_bits_do_not_panic(layout in layouts(), frame in any::<u64>()) {
        let reading = layout.decode(frame);
        prop_assert!(reading.position <= layout.position_code().last_position());
        prop_assert_eq!(layout.to_cells(frame).len(), usize::from(layout.clock_count()));
        let _ = layout.to_findings(reading);
    }
}

fn plain() -> FrameDescriptor {
    FrameDescriptor::binary(12, 13)
}

fn bit(name: &str, clock: u8) -> ErrorBit {
    ErrorBit {
        name: name.to_owned(),
        clock,
        meaning: BitMeaning::Invalid,
        active_low: false,
        cleared_by_transfer: false,
    }
}

#[test]
fn rejects_impossible_layouts() {
    let parity = |clock| Some(Parity { clock, even: true });
    let cases: [(&str, FrameDescriptor, &str); 11] = [
        ("no clocks", FrameDescriptor { clocks: 0, area: 0, ..plain() }, "a frame has 1 to 64 clocks, not 0"),
        ("many clocks", FrameDescriptor { clocks: 65, ..plain() }, "a frame has 1 to 64 clocks, not 65"),
        (
            "few clocks",
            FrameDescriptor { clocks: 24, ..plain() },
            "the position extends to clock 25, but the frame has only 24 clocks",
        ),
        (
            "odd gray excess",
            FrameDescriptor { code: Code::GrayExcess, range: Range::Steps { per_turn: 359, turns: 1 }, ..plain() },
            "Gray excess requires an even number of steps, because with 359 steps two bits would change at the end of \
             the range",
        ),
        (
            "error bit on the position",
            FrameDescriptor { errors: vec![bit("ERROR", 25)], ..plain() },
            "clock 25 is used by both the position and ERROR",
        ),
        (
            "two error bits on a clock",
            FrameDescriptor { clocks: 26, errors: vec![bit("A", 26), bit("B", 26)], ..plain() },
            "clock 26 is used by both A and B",
        ),
        (
            "error bit behind the frame",
            FrameDescriptor { errors: vec![bit("ERROR", 26)], ..plain() },
            "ERROR is on clock 26, but the frame has only 25 clocks",
        ),
        (
            "wide",
            FrameDescriptor { lead: 1, ..plain() },
            "25 position bits after 1 zeros need 26 clocks, but only 25 are available",
        ),
        (
            "repetition",
            FrameDescriptor { clocks: 50, repeat: Some(Repeat { word: 25, gap: 1 }), ..plain() },
            "the frame and the repeated frame need 51 clocks, but there are only 50",
        ),
        (
            "parity bit in the Gray code",
            FrameDescriptor {
                clocks: 27,
                area: 27,
                code: Code::Gray,
                coded: GrayCoverage::Area,
                parity: parity(27),
                ..plain()
            },
            "the parity bit cannot be on clock 27, because the first 27 clocks are coded together",
        ),
        (
            "parity bit in what is shifted",
            FrameDescriptor { clocks: 28, area: 28, shift_right: true, parity: parity(28), ..plain() },
            "the parity bit cannot be on clock 28, because the first 28 clocks are shifted together",
        ),
    ];
    for (what, descriptor, reason) in cases {
        assert_eq!(Layout::new(descriptor).unwrap_err().to_string(), reason, "{what}");
    }
}

/// The frames contain the position ABCDEFh in Gray code and an error bit of 1, which the Gray code may or may not cover
/// (reference section 8).
#[test]
fn gray_decodes_with_optional_error_bit() {
    let descriptor = |coded| FrameDescriptor {
        clocks: 25,
        code: Code::Gray,
        coded,
        errors: vec![bit("ERROR", 25)],
        ..FrameDescriptor::binary(0, 24)
    };
    let plain = Layout::new(descriptor(GrayCoverage::Position)).unwrap();
    let whole = Layout::new(descriptor(GrayCoverage::AreaAndErrors)).unwrap();
    assert_eq!(plain.encode(0xAB_CDEF, Flags::error(0)), Some(0x1FC_5631));
    assert_eq!(whole.encode(0xAB_CDEF, Flags::error(0)), Some(0x1FC_5630));
    let mistaken = whole.decode(0x1FC_5631);
    assert_eq!(mistaken, FrameReading { position: 0xAB_CDEF, flags: Flags::NONE }, "the error bit upside down");
    assert_eq!(gray_to_binary(0x1FC_5631), 0x157_9BDE);
}

/// If the lowest bit is 1, the frames depend on whether the Gray code covers the zeros around the position (reference
/// section 2).
#[test]
fn gray_code_may_cover_zeros() {
    let descriptor =
        |coded| FrameDescriptor { clocks: 14, area: 14, code: Code::Gray, coded, ..FrameDescriptor::binary(0, 12) };
    let position = Layout::new(descriptor(GrayCoverage::Position)).unwrap();
    let area = Layout::new(descriptor(GrayCoverage::Area)).unwrap();
    // 101 is 1100101 in binary and 1010111 in Gray code. With two zeros after it, the Gray code of 110010100 is
    // 101011110.
    assert_eq!(position.encode(101, Flags::NONE), Some(0b1_0101_1100));
    assert_eq!(area.encode(101, Flags::NONE), Some(0b1_0101_1110));
    assert_eq!(position.encode(100, Flags::NONE), area.encode(100, Flags::NONE));
    assert!(position.decode(0b1_0101_1110).flags.contains(Flags::PADDING));
    assert_eq!(area.decode(0b1_0101_1110).position, 101);
}

#[test]
fn smallest_frame_passes_checks() {
    assert_eq!(Ok(Layout::default()), Layout::new(FrameDescriptor::binary(0, 1)));
}
