//! Copying of single entries from one profile to another.

use super::SsiProfile;
use crate::devices::ssi::protocol::{ErrorBit, Pattern, Range};

impl SsiProfile {
    /// Returns the profile with one entry copied from another profile. Entries are named as in a comparison. Entries
    /// that make sense only together, such as those of an error bit that this profile lacks, are copied together. The
    /// resulting frame may be invalid.
    #[must_use]
    pub fn with_item(mut self, item: &str, from: &SsiProfile) -> Self {
        let (own, other) = (&mut self.descriptor, &from.descriptor);
        match item {
            "family" => self.family.clone_from(&from.family),
            "clocks" => own.clocks = other.clocks,
            "code" => own.code = other.code,
            "over" => own.coded = other.coded,
            "area" => own.area = other.area,
            "lead" => own.lead = other.lead,
            "between" => own.between = other.between,
            "shift" => own.shift_right = other.shift_right,
            "inverted" => own.inverted = other.inverted,
            "parity.clock" | "parity.even" => own.parity = other.parity,
            "repeat.word" | "repeat.gap" => own.repeat = other.repeat,
            "direction" => self.direction = from.direction,
            "preset" => self.preset = from.preset,
            "reading.clock_hz" => self.reading.clock_hz = from.reading.clock_hz,
            "reading.pause_us" => self.reading.pause_us = from.reading.pause_us,
            "reading.cable_metres" => self.reading.cable_metres = from.reading.cable_metres,
            "reading.synchronous" => self.reading.synchronous = from.reading.synchronous,
            item => match (numbered(item, "errors"), numbered(item, "patterns")) {
                (Some((index, part)), _) => adopt_error_bit_property(&mut own.errors, &other.errors, index, part),
                (_, Some((index, part))) => adopt_pattern_property(&mut own.patterns, &other.patterns, index, part),
                (None, None) => own.range = with_range_property(own.range, other.range, item),
            },
        }
        self
    }
}

/// Splits a name such as `errors[0].clock` into its index and the part after it.
fn numbered<'i>(item: &'i str, list: &str) -> Option<(usize, &'i str)> {
    let (index, part) = item.strip_prefix(list)?.strip_prefix('[')?.split_once("].")?;
    Some((index.parse().ok()?, part))
}

fn adopt_error_bit_property(own: &mut Vec<ErrorBit>, other: &[ErrorBit], index: usize, part: &str) {
    let Some((bit, from)) = own.get_mut(index).zip(other.get(index)) else {
        return other.clone_into(own);
    };
    match part {
        "name" => bit.name.clone_from(&from.name),
        "clock" => bit.clock = from.clock,
        "meaning" => bit.meaning = from.meaning,
        "active_low" => bit.active_low = from.active_low,
        _ => bit.cleared_by_transfer = from.cleared_by_transfer,
    }
}

fn adopt_pattern_property(own: &mut Vec<Pattern>, other: &[Pattern], index: usize, part: &str) {
    let Some((pattern, from)) = own.get_mut(index).zip(other.get(index)) else {
        return other.clone_into(own);
    };
    match part {
        "name" => pattern.name.clone_from(&from.name),
        "word" => pattern.word = from.word,
        _ => pattern.meaning = from.meaning,
    }
}

/// Returns a range with one part replaced by that of another range. If the ranges are of different kinds, the other
/// range is returned.
fn with_range_property(own: Range, other: Range, part: &str) -> Range {
    match (own, other, part) {
        (Range::Bits { singleturn, .. }, Range::Bits { multiturn, .. }, "multiturn")
        | (Range::Bits { multiturn, .. }, Range::Bits { singleturn, .. }, "singleturn") => {
            Range::Bits { multiturn, singleturn }
        }
        (Range::Steps { turns, .. }, Range::Steps { per_turn, .. }, "steps")
        | (Range::Steps { per_turn, .. }, Range::Steps { turns, .. }, "turns") => Range::Steps { per_turn, turns },
        (Range::RoundAxis { revolutions, .. }, Range::RoundAxis { steps, .. }, "steps")
        | (Range::RoundAxis { steps, .. }, Range::RoundAxis { revolutions, .. }, "revolutions") => {
            Range::RoundAxis { steps, revolutions }
        }
        (Range::Length { step_nanometres, .. }, Range::Length { bits, .. }, "bits")
        | (Range::Length { bits, .. }, Range::Length { step_nanometres, .. }, "step_nanometres") => {
            Range::Length { bits, step_nanometres }
        }
        (_, other, _) => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::{Families, Settings};
    use crate::profile::Profile as _;

    fn profile(text: &str) -> SsiProfile {
        let (key, settings) = Settings::parse(text).unwrap();
        let families = Families::built_in();
        let family = families.find_by_key(&key).unwrap();
        SsiProfile::from_family(family, &settings.resolve(family).unwrap())
    }

    #[test]
    fn adopted_entry_no_longer_differs() {
        let (mut left, right) =
            (profile("ahm36"), profile("ahm36,code=gray,st=12,err=following,direction=ccw,preset=7"));
        left.reading.cable_metres = Some(30);
        let differences = left.compare(&right).differences();
        let items: Vec<&str> = differences.iter().map(|own| own.item.as_str()).collect();
        assert_eq!(items, ["singleturn", "code", "errors[0].clock", "direction", "preset", "reading.cable_metres"]);
        for item in &items {
            let taken = right.clone().with_item(item, &left);
            let remaining = left.compare(&taken).differences();
            assert_eq!(remaining.len(), items.len() - 1, "{item}");
            assert!(remaining.iter().all(|own| own.item != *item), "{item}");
        }
        let all = items.iter().fold(right, |taken, item| taken.with_item(item, &left));
        assert_eq!(left.compare(&all).differences(), []);
    }

    #[test]
    fn adopts_entire_range_if_kinds_differ() {
        let (bits, steps) = (profile("ahs36"), profile("ahs36,steps=360"));
        assert_eq!(bits.clone().with_item("steps", &steps).descriptor.range, steps.descriptor.range);
        let without = profile("afs60,err=none").with_item("errors[2].clock", &profile("afs60s"));
        assert_eq!(without.descriptor.errors, profile("afs60s").descriptor.errors);
    }
}
