//! Tests with frames of turning, stationary and disturbed shafts, which were generated from known layouts, and with
//! independent recordings.

#[path = "../../../../../tests/tools/ssi_recordings.rs"]
mod recordings;

use fastrand::Rng;

use super::*;
use crate::devices::ssi::protocol::{Flags, FrameDescriptor, Range};

fn layout(text: &str) -> Layout {
    let (key, settings) = Settings::parse(text).unwrap();
    settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
}

/// Returns 2000 frames of a shaft that turns slowly and not quite evenly, starting at a quarter of the range.
fn turning(layout: &Layout, steps_per_frame: f64) -> Vec<u64> {
    let mut rng = Rng::with_seed(7);
    let last = layout.position_code().last_position();
    let round = u128::from(last) + 1;
    let start = last / 4;
    let frames = (0..2000).map(|index| {
        let trembling = rng.f64() * 1.2 - 0.6;
        let moved = (f64::from(index) * steps_per_frame + trembling).round() as i128;
        let position = (i128::from(start) + moved).rem_euclid(round as i128) as u64;
        layout.encode(position, Flags::NONE).unwrap()
    });
    frames.collect()
}

/// Returns whether two layouts describe the same frame, apart from names.
fn is_same_frame(one: &Layout, other: &Layout) -> bool {
    let shape =
        |layout: &Layout| (layout.clock_roles().len(), layout.position_code().code(), layout.descriptor().coded);
    one.clock_roles() == other.clock_roles() && shape(one) == shape(other)
}

#[test]
fn every_family_class_ranks_first() {
    let families = Families::built_in();
    for (family, speed) in families.iter().zip([0.3, -1.7, 13.2].into_iter().cycle()) {
        for (code, speed) in [("binary", speed), ("gray", -speed)] {
            let text = format!("{},code={code}", family.key);
            let truth = layout(&text);
            let search = find(&turning(&truth, speed), truth.clock_count(), &families);
            // If the shaft does not pass the end of the range, it is unknown whether higher bits belong to the
            // position.
            assert!(
                matches!(search.uncertainty, None | Some(UncertaintyReason::Open)),
                "{text} at {speed}: {:?}",
                search.uncertainty
            );
            let first = &search.classes[0];
            let named =
                first.members.iter().filter(|member| member.family.as_ref().is_some_and(|(key, _)| *key == family.key));
            assert!(named.clone().any(|member| is_same_frame(&member.layout, &truth)), "{text} at {speed}");
            // A bit that changes only in the first frames is counted as disturbed.
            assert!(first.evidence.misfits <= 2, "{text} at {speed}");
        }
    }
}

#[test]
fn finds_settings() {
    let families = Families::built_in();
    let settings = [
        "ahs36,st=12,code=gray",
        "ahs36,st=12,err=following",
        "ahm36,st=12,mt=8,align=tree12_13",
        "atm60,mt=8,st=8,code=gray",
        "atm60,mt=8,st=8,align=right24,shift=1",
        "atm60,shift=1",
        "atm60,mt=8,st=8,code=gray,over=padded",
        "ttk70,clocks=31",
        "ars60,st=13,code=gray",
    ];
    for text in settings {
        let truth = layout(text);
        let search = find(&turning(&truth, 1.3), truth.clock_count(), &families);
        assert_eq!(search.uncertainty, Some(UncertaintyReason::Open), "{text}");
        let first = &search.classes[0];
        assert!(first.members.iter().any(|member| is_same_frame(&member.layout, &truth)), "{text}");
    }
}

/// Contiguous frames reveal neither the boundary between turns and steps nor whether the encoder is a safety encoder.
#[test]
fn indistinguishable_layouts_form_one_class() {
    let families = Families::built_in();
    let atm60 = layout("atm60,code=gray");
    let first = find(&turning(&atm60, 3.1), 25, &families).classes.remove(0);
    for align in ["mt=12,st=13,align=tree12_13", "mt=13,st=12,align=tree13_12"] {
        let split = layout(&format!("atm60,code=gray,{align}"));
        assert!(first.members.iter().any(|member| is_same_frame(&member.layout, &split)), "{align}");
    }
    assert!(first.open.contains(&OpenQuestion::TurnOnce));
    let afm60 = layout("afm60");
    let first = find(&turning(&afm60, 3.1), 33, &families).classes.remove(0);
    let keys: Vec<&str> =
        first.members.iter().filter_map(|member| member.family.as_ref()).map(|(key, _)| key.as_str()).collect();
    assert!(keys.contains(&"afm60") && keys.contains(&"afm60s"), "{keys:?}");
    assert!(first.open.contains(&OpenQuestion::TypeLabel));
}

#[test]
fn resting_shaft_yields_no_layout() {
    let families = Families::built_in();
    for family in families.iter() {
        let truth = layout(&family.key);
        let search = find(&turning(&truth, 0.0), truth.clock_count(), &families);
        assert_eq!(search.uncertainty, Some(UncertaintyReason::Standing), "{}", family.key);
        assert_eq!(search.classes, []);
    }
}

#[test]
fn noise_and_stuck_lines_yield_no_layout() {
    let families = Families::built_in();
    let mut rng = Rng::with_seed(3);
    let noise: Vec<u64> = (0..2000).map(|_| rng.u64(..)).collect();
    assert_eq!(find(&noise, 25, &families).uncertainty, Some(UncertaintyReason::Nothing));
    assert_eq!(find(&[0; 100], 25, &families).uncertainty, Some(UncertaintyReason::Stuck { high: false }));
    assert_eq!(find(&[0x1FF_FFFF; 100], 25, &families).uncertainty, Some(UncertaintyReason::Stuck { high: true }));
    assert_eq!(find(&[], 25, &families).uncertainty, Some(UncertaintyReason::Standing));
}

/// Frames without a family are recognised, both Gray excess that passes the end of the range and a frame with a parity
/// bit.
#[test]
fn finds_encoders_without_family() {
    let families = Families::built_in();
    let excess = Layout::new(FrameDescriptor {
        clocks: 12,
        range: Range::Steps { per_turn: 360, turns: 1 },
        code: crate::devices::ssi::protocol::Code::GrayExcess,
        area: 12,
        lead: 3,
        ..FrameDescriptor::binary(0, 0)
    })
    .unwrap();
    let search = find(&turning(&excess, 0.7), 12, &families);
    assert_eq!(
        (search.uncertainty, search.classes[0].members[0].layout.position_code().last_position()),
        (None, 359),
        "{search:?}"
    );

    let parity = crate::devices::ssi::protocol::Parity { clock: 21, even: true };
    let with_parity =
        Layout::new(FrameDescriptor { clocks: 21, parity: Some(parity), ..FrameDescriptor::binary(0, 20) }).unwrap();
    let search = find(&turning(&with_parity, 2.7), 21, &families);
    assert_eq!(search.uncertainty, Some(UncertaintyReason::Open));
    assert_eq!(search.classes[0].members[0].layout.descriptor().parity, Some(parity));
}

/// The layout is found even if some frames are disturbed and others contain errors. Both kinds are counted.
#[test]
fn disturbed_frames_do_not_hide_layout() {
    let truth = layout("ahm36,st=12,code=gray");
    let mut frames = turning(&truth, 1.9);
    for frame in frames.iter_mut().step_by(50) {
        *frame ^= 1 << 20;
    }
    for frame in frames.iter_mut().skip(7).step_by(100) {
        *frame |= 1;
    }
    let search = find(&frames, 27, &Families::built_in());
    let first = &search.classes[0];
    // The disturbed bit is a turn bit that otherwise never changes.
    assert_eq!((search.uncertainty, first.evidence.misfits), (Some(UncertaintyReason::Open), 40));
    assert!(first.members.iter().any(|member| is_same_frame(&member.layout, &truth)));
}

/// Returns the frames of a file in `tests/vectors/ssi_find` and their true positions, which are `None` for disturbed
/// frames.
fn recording(text: &str) -> (u8, Vec<u64>, Vec<Option<u64>>) {
    let lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split_once(' ').unwrap());
    let rows: Vec<(&str, &str)> = lines.collect();
    let frames = rows.iter().map(|(bits, _)| u64::from_str_radix(bits, 2).unwrap()).collect();
    let meant = rows.iter().map(|(_, position)| position.parse().ok()).collect();
    (rows[0].0.len() as u8, frames, meant)
}

/// Returns whether a layout decodes every undisturbed frame correctly.
fn reads(proposal: &LayoutProposal, frames: &[u64], meant: &[Option<u64>]) -> bool {
    let read =
        |(frame, meant): (&u64, &Option<u64>)| meant.is_none_or(|own| proposal.layout.decode(*frame).position == own);
    frames.iter().zip(meant).all(read)
}

/// The recordings of fifteen encoders were generated in Python, with noise and disturbed frames. The flag specifies
/// whether the result may be certain, which requires that every bit is explained. Until the end of the range is passed,
/// a 1 before the position looks like its highest bit. A decreasing binary position looks like swapped wires, and 3600
/// steps look like 3598 as long as the shaft skips the first and the last one (issue 22.22).
#[test]
fn recognizes_independent_recordings() {
    let vectors = [
        ("AHM36 in Gray", false, include_str!("../../../../../tests/vectors/ssi_find/ahm36_gray.txt")),
        ("8 and 8 bits in a tree", false, include_str!("../../../../../tests/vectors/ssi_find/tree_8_8_gray.txt")),
        ("error, active low", false, include_str!("../../../../../tests/vectors/ssi_find/error_active_low.txt")),
        ("start bit", false, include_str!("../../../../../tests/vectors/ssi_find/start_bit.txt")),
        ("power good first", false, include_str!("../../../../../tests/vectors/ssi_find/power_good_first.txt")),
        ("wires, Gray", false, include_str!("../../../../../tests/vectors/ssi_find/wires_exchanged_gray.txt")),
        ("wires, binary", false, include_str!("../../../../../tests/vectors/ssi_find/wires_exchanged_binary.txt")),
        ("twice with a gap", false, include_str!("../../../../../tests/vectors/ssi_find/twice_with_gap.txt")),
        ("twice, binary", false, include_str!("../../../../../tests/vectors/ssi_find/twice_binary.txt")),
        ("excess of 360, fast", true, include_str!("../../../../../tests/vectors/ssi_find/excess_360_fast.txt")),
        ("excess of 3600", false, include_str!("../../../../../tests/vectors/ssi_find/excess_3600_right.txt")),
        ("Gray, even parity", false, include_str!("../../../../../tests/vectors/ssi_find/gray_even_parity.txt")),
        ("binary, odd parity", false, include_str!("../../../../../tests/vectors/ssi_find/binary_odd_parity.txt")),
        ("counts down", false, include_str!("../../../../../tests/vectors/ssi_find/reversed_linear.txt")),
        (
            "3600 steps in BCD",
            false,
            include_str!("../../../../../tests/vectors/ssi_find/three_thousand_six_hundred_steps.txt"),
        ),
    ];
    let families = Families::built_in();
    let (mut first, mut foremost) = (0, 0);
    for (name, tick, text) in vectors {
        let (clocks, frames, meant) = recording(text);
        let search = find(&frames, clocks, &families);
        let class = &search.classes[0];
        assert_eq!(search.uncertainty.is_none(), tick, "{name}: {:?}", search.uncertainty);
        let in_class = class.members.iter().any(|member| reads(member, &frames, &meant));
        println!("{name}: in the first class: {in_class}, {:?}", class.open);
        first += usize::from(in_class);
        foremost += usize::from(reads(&class.members[0], &frames, &meant));
        assert!(search.classes.windows(2).all(|pair| pair[0].evidence.score >= pair[1].evidence.score), "{name}");
        assert!(tick || !class.open.is_empty(), "{name}: it says what would decide");
    }
    assert_eq!((first, foremost), (15, 14), "the truth in the first class, and as its first member");
}

/// A layout that decodes a frame incorrectly is never reported as certain. `cargo bench --bench ssi` tests all thousand
/// recordings (issue 22.22).
#[test]
fn confirmed_layouts_are_correct() {
    let families = Families::built_in();
    let mut ticks = 0;
    for seed in 0..40 {
        let recording = recordings::Recording::of(seed);
        let search = find(&recording.frames, recording.clocks, &families);
        if search.uncertainty.is_none() {
            ticks += 1;
            let member = &search.classes[0].members[0];
            assert!(reads(member, &recording.frames, &recording.meant), "{}", recording.what);
        }
    }
    assert!(ticks >= 1, "a tick is given where it may be");
}

/// Every layout found can be passed to `--layout` as printed (issue 22.22).
#[test]
fn proposals_round_trip_as_text() {
    let families = Families::built_in();
    let mut texts = Vec::new();
    for seed in 0..12 {
        let recording = recordings::Recording::of(seed);
        let search = find(&recording.frames, recording.clocks, &families);
        for proposal in search.classes.iter().flat_map(|class| &class.members) {
            let text = proposal.spec_text(&families);
            let descriptor = FrameDescriptor::parse(&text).unwrap_or_else(|| {
                let (key, settings) = Settings::parse(&text).unwrap();
                Ok(settings.resolve(families.find_by_key(&key).unwrap()).unwrap().layout.descriptor().clone())
            });
            let layout = Layout::new(descriptor.unwrap()).unwrap();
            for frame in recording.frames.iter().step_by(50) {
                assert_eq!(layout.decode(*frame).position, proposal.layout.decode(*frame).position, "{text}");
            }
            texts.push(text);
        }
    }
    assert!(
        texts.iter().any(|text| text.starts_with("frame,")) && texts.iter().any(|text| !text.starts_with("frame,"))
    );
}
