//! Comparison of two SSI profiles, entry by entry. Entries are named as in the profile file.

use super::SsiProfile;
use crate::devices::ssi::protocol::{Range, Word};
use crate::profile::Comparison;

/// Compares frame, direction, preset and reading settings. Missing entries have their default values.
pub(super) fn compare(left: &SsiProfile, right: &SsiProfile) -> Comparison {
    let (left, right) = (compared_items(left), compared_items(right));
    let mut comparison = Comparison::default();
    let value = |side: &[(String, String)], item: &str| {
        side.iter().find(|(own, _)| own == item).map(|(_, value)| value.clone())
    };
    let is_new = |item: &&(String, String)| value(&left, &item.0).is_none();
    for (item, _) in left.iter().chain(right.iter().filter(is_new)) {
        comparison.compare_item(item.clone(), value(&left, item), value(&right, item));
    }
    comparison
}

/// Returns the names and values of all compared entries, in the order of the file.
fn compared_items(profile: &SsiProfile) -> Vec<(String, String)> {
    let frame = &profile.descriptor;
    let mut items: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, value: &dyn ToString| items.push((name.to_owned(), value.to_string()));
    if let Some(family) = &profile.family {
        add("family", family);
    }
    add("clocks", &frame.clocks);
    match frame.range {
        Range::Bits { multiturn, singleturn } => {
            add("multiturn", &multiturn);
            add("singleturn", &singleturn);
        }
        Range::Steps { per_turn, turns } => {
            add("steps", &per_turn);
            add("turns", &turns);
        }
        Range::RoundAxis { steps, revolutions } => {
            add("steps", &steps);
            add("revolutions", &revolutions);
        }
        Range::Length { bits, step_nanometres } => {
            add("bits", &bits);
            add("step_nanometres", &step_nanometres);
        }
    }
    add("code", &frame.code);
    add("over", &frame.coded);
    add("area", &frame.area);
    add("lead", &frame.lead);
    add("between", &frame.between);
    add("shift", &frame.shift_right);
    add("inverted", &frame.inverted);
    for (at, bit) in frame.errors.iter().enumerate() {
        add(&format!("errors[{at}].name"), &bit.name);
        add(&format!("errors[{at}].clock"), &bit.clock);
        add(&format!("errors[{at}].meaning"), &bit.meaning);
        add(&format!("errors[{at}].active_low"), &bit.active_low);
        add(&format!("errors[{at}].cleared_by_transfer"), &bit.cleared_by_transfer);
    }
    if let Some(parity) = frame.parity {
        add("parity.clock", &parity.clock);
        add("parity.even", &parity.even);
    }
    if let Some(repeat) = frame.repeat {
        add("repeat.word", &repeat.word);
        add("repeat.gap", &repeat.gap);
    }
    for (at, pattern) in frame.patterns.iter().enumerate() {
        let word = match pattern.word {
            Word::Ones => "ones".to_owned(),
            Word::Bits(bits) => format!("0x{bits:X}"),
        };
        add(&format!("patterns[{at}].name"), &pattern.name);
        add(&format!("patterns[{at}].word"), &word);
        add(&format!("patterns[{at}].meaning"), &pattern.meaning);
    }
    add("direction", &profile.direction);
    add("preset", &profile.preset);
    add("reading.clock_hz", &profile.reading.clock_hz);
    add("reading.pause_us", &profile.reading.pause_us);
    let metres = profile.reading.cable_metres;
    add("reading.cable_metres", &metres.map_or_else(|| "none".to_owned(), |metres| metres.to_string()));
    add("reading.synchronous", &profile.reading.synchronous);
    items
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::{Families, Settings};

    fn profile(text: &str) -> SsiProfile {
        let (key, settings) = Settings::parse(text).unwrap();
        let families = Families::built_in();
        let family = families.find_by_key(&key).unwrap();
        SsiProfile::from_family(family, &settings.resolve(family).unwrap())
    }

    fn listed(comparison: &Comparison) -> Vec<(String, String, String)> {
        comparison.differences().into_iter().map(|own| (own.item, own.left, own.right)).collect()
    }

    #[test]
    fn lists_only_differences() {
        let left = profile("ahm36");
        let mut right = profile("ahm36,code=gray,st=12,err=following,direction=ccw,preset=7");
        right.reading.clock_hz = 1_000_000;
        right.reading.cable_metres = Some(30);
        right.name = "another name".to_owned();
        let comparison = compare(&left, &right);
        let expected = [
            ("singleturn", "14", "12"),
            ("code", "binary", "gray"),
            ("errors[0].clock", "27", "25"),
            ("direction", "cw", "ccw"),
            ("preset", "0", "7"),
            ("reading.clock_hz", "400000", "1000000"),
            ("reading.cable_metres", "none", "30"),
        ];
        let expected = expected.map(|(item, left, right)| (item.to_owned(), left.to_owned(), right.to_owned()));
        assert_eq!(listed(&comparison), expected);
        // Family, clocks, turns and steps, seven of the frame, five of its error bit, two, four of the reading.
        assert_eq!(comparison.compared, 1 + 1 + 2 + 7 + 5 + 2 + 4);
        assert_eq!(comparison.one_sided_items(), Vec::<String>::new());
        assert_eq!(compare(&right, &right).differences(), []);
    }

    #[test]
    fn lists_values_present_in_one_profile() {
        let comparison = compare(&profile("afs60s"), &SsiProfile { family: None, ..profile("afs60,err=none") });
        let bit = |at: usize| {
            ["name", "clock", "meaning", "active_low", "cleared_by_transfer"].map(|part| format!("errors[{at}].{part}"))
        };
        let pattern = ["name", "word", "meaning"].map(|part| format!("patterns[0].{part}"));
        let expected =
            [vec!["family".to_owned()], bit(0).into(), bit(1).into(), bit(2).into(), pattern.into()].concat();
        assert_eq!(comparison.only_left(), expected);
        assert_eq!(comparison.only_right(), Vec::<String>::new());
        assert_eq!(listed(&comparison), [("clocks".to_owned(), "21".to_owned(), "18".to_owned())]);
        let range = compare(&profile("ahs36"), &profile("ahs36,steps=360"));
        assert_eq!(
            (range.only_left(), range.only_right()),
            (vec!["multiturn".into(), "singleturn".into()], vec!["steps".into(), "turns".into()])
        );
    }
}
