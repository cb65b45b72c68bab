//! Frames of turning, standing and disturbed shafts, made by the layouts that are to be found.

use fastrand::Rng;

use super::*;
use crate::protocol::ssi::{Descriptor, Flags, Range};

fn layout(text: &str) -> Layout {
    let (key, settings) = Settings::parse(text).unwrap();
    settings.resolve(Families::built_in().named(&key).unwrap()).unwrap().layout
}

/// 2000 frames of a shaft that turns slowly and not quite evenly, from a quarter of the range on.
fn turning(layout: &Layout, steps_a_frame: f64) -> Vec<u64> {
    let mut rng = Rng::with_seed(7);
    let last = layout.coding().last();
    let round = u128::from(last) + 1;
    let start = last / 4;
    let frames = (0..2000).map(|index| {
        let trembling = rng.f64() * 1.2 - 0.6;
        let moved = (f64::from(index) * steps_a_frame + trembling).round() as i128;
        let position = (i128::from(start) + moved).rem_euclid(round as i128) as u64;
        layout.encode(position, Flags::NONE).unwrap()
    });
    frames.collect()
}

/// What an encoder sends counts, not what its settings are called.
fn same_frame(one: &Layout, other: &Layout) -> bool {
    let shape = |layout: &Layout| (layout.roles().len(), layout.coding().code(), layout.descriptor().coded);
    one.roles() == other.roles() && shape(one) == shape(other)
}

#[test]
fn the_class_of_every_family_comes_first() {
    let families = Families::built_in();
    for (family, speed) in families.iter().zip([0.3, -1.7, 13.2].into_iter().cycle()) {
        for (code, speed) in [("binary", speed), ("gray", -speed)] {
            let text = format!("{},code={code}", family.key);
            let truth = layout(&text);
            let search = find(&turning(&truth, speed), truth.clocks(), &families);
            assert_eq!(search.doubt, None, "{text} at {speed}");
            let first = &search.classes[0];
            let named =
                first.members.iter().filter(|member| member.family.as_ref().is_some_and(|(key, _)| *key == family.key));
            assert!(named.clone().any(|member| same_frame(&member.layout, &truth)), "{text} at {speed}");
            assert_eq!(first.evidence.misfits, 0, "{text} at {speed}");
        }
    }
}

#[test]
fn settings_are_found_too() {
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
        let search = find(&turning(&truth, 1.3), truth.clocks(), &families);
        assert_eq!(search.doubt, None, "{text}");
        assert!(search.classes[0].members.iter().any(|member| same_frame(&member.layout, &truth)), "{text}");
    }
}

/// Contiguous frames do not tell where turns end, nor a safety encoder from the other.
#[test]
fn what_cannot_be_told_apart_is_one_class() {
    let families = Families::built_in();
    let atm60 = layout("atm60,code=gray");
    let first = find(&turning(&atm60, 3.1), 25, &families).classes.remove(0);
    for align in ["mt=12,st=13,align=tree12_13", "mt=13,st=12,align=tree13_12"] {
        let split = layout(&format!("atm60,code=gray,{align}"));
        assert!(first.members.iter().any(|member| same_frame(&member.layout, &split)), "{align}");
    }
    assert!(first.open.contains(&Open::TurnOnce));
    let afm60 = layout("afm60");
    let first = find(&turning(&afm60, 3.1), 33, &families).classes.remove(0);
    let keys: Vec<&str> =
        first.members.iter().filter_map(|member| member.family.as_ref()).map(|(key, _)| key.as_str()).collect();
    assert!(keys.contains(&"afm60") && keys.contains(&"afm60s"), "{keys:?}");
    assert!(first.open.contains(&Open::TypeLabel));
}

#[test]
fn a_standing_shaft_says_nothing() {
    let families = Families::built_in();
    for family in families.iter() {
        let truth = layout(&family.key);
        let search = find(&turning(&truth, 0.0), truth.clocks(), &families);
        assert_eq!(search.doubt, Some(Doubt::Standing), "{}", family.key);
        assert_eq!(search.classes, []);
    }
}

#[test]
fn noise_and_stuck_lines_are_no_layout() {
    let families = Families::built_in();
    let mut rng = Rng::with_seed(3);
    let noise: Vec<u64> = (0..2000).map(|_| rng.u64(..)).collect();
    assert_eq!(find(&noise, 25, &families).doubt, Some(Doubt::Nothing));
    assert_eq!(find(&[0; 100], 25, &families).doubt, Some(Doubt::Stuck { high: false }));
    assert_eq!(find(&[0x1FF_FFFF; 100], 25, &families).doubt, Some(Doubt::Stuck { high: true }));
    assert_eq!(find(&[], 25, &families).doubt, Some(Doubt::Standing));
}

/// Frames of an encoder that no family is: gray excess whose end was passed, and a parity bit.
#[test]
fn other_encoders() {
    let families = Families::built_in();
    let excess = Layout::new(Descriptor {
        clocks: 12,
        range: Range::Steps { per_turn: 360, turns: 1 },
        code: crate::protocol::ssi::Code::GrayExcess,
        area: 12,
        lead: 3,
        ..Descriptor::plain(0, 0)
    })
    .unwrap();
    let search = find(&turning(&excess, 0.7), 12, &families);
    assert_eq!((search.doubt, search.classes[0].members[0].layout.coding().last()), (None, 359));

    let parity = crate::protocol::ssi::Parity { clock: 21, even: true };
    let with_parity = Layout::new(Descriptor { clocks: 21, parity: Some(parity), ..Descriptor::plain(0, 20) }).unwrap();
    let search = find(&turning(&with_parity, 2.7), 21, &families);
    assert_eq!(search.doubt, None);
    assert_eq!(search.classes[0].members[0].layout.descriptor().parity, Some(parity));
}

/// Some frames disturbed, some with errors: the layout is found all the same, and both are counted.
#[test]
fn disturbed_frames_do_not_hide_the_layout() {
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
    assert_eq!((search.doubt, first.evidence.misfits, first.evidence.errors), (None, 0, 20));
    assert!(first.evidence.jumps >= 40);
    assert!(first.members.iter().any(|member| same_frame(&member.layout, &truth)));
}
