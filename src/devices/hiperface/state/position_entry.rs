//! Entry of a position in steps, degrees, turns and degrees, or millimetres. Parsing a displayed position in the same
//! unit yields the same number of steps.

use crate::app::Text;
use crate::devices::hiperface::protocol::{Geometry, STEPS_PER_PERIOD};
use crate::devices::hiperface::state::TEXTS;

/// Maximum number of digits before and after the decimal point.
const DIGITS: usize = 12;
/// Minimum number of decimals displayed for a distance or an angle.
const DECIMALS: u32 = 3;
const NANOMETRES: u128 = 1_000_000;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PositionUnit {
    #[default]
    Steps,
    /// Degrees from position 0. They exceed 360 in an encoder with several turns.
    Degrees,
    /// Whole turns, and degrees within the turn.
    TurnsAndDegrees,
    Millimetres,
}

/// A position as typed by the user. The number of turns is only used for [`PositionUnit::TurnsAndDegrees`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PositionEntry {
    pub unit: PositionUnit,
    pub turns: String,
    pub value: String,
}

impl PositionUnit {
    /// Returns the units in which positions of an encoder can be entered.
    pub fn available(geometry: Option<Geometry>) -> &'static [PositionUnit] {
        match geometry {
            None => &[PositionUnit::Steps],
            Some(Geometry::Rotary { turns: 0 | 1, .. }) => &[PositionUnit::Steps, PositionUnit::Degrees],
            Some(Geometry::Rotary { .. }) => {
                &[PositionUnit::Steps, PositionUnit::Degrees, PositionUnit::TurnsAndDegrees]
            }
            Some(Geometry::Linear { .. }) => &[PositionUnit::Steps, PositionUnit::Millimetres],
        }
    }

    /// Returns the message ID for the unit's name.
    pub const fn word(self) -> &'static str {
        match self {
            PositionUnit::Steps => "position_unit.steps",
            PositionUnit::Degrees => "position_unit.degrees",
            PositionUnit::TurnsAndDegrees => "position_unit.turns_degrees",
            PositionUnit::Millimetres => "position_unit.millimetres",
        }
    }
}

impl PositionEntry {
    /// Creates an entry for a position, in the given unit and with a decimal point.
    pub fn of(steps: u32, unit: PositionUnit, geometry: Option<Geometry>) -> Self {
        let own = |value: String| PositionEntry { unit, turns: String::new(), value };
        match (unit, geometry.and_then(|geometry| Some((geometry, geometry.steps_per_turn()?)))) {
            (PositionUnit::Degrees, Some((_, per_turn))) => own(ratio(steps.into(), (360, per_turn.into()), DECIMALS)),
            (PositionUnit::TurnsAndDegrees, Some((_, per_turn))) => {
                let (turns, rest) = (u64::from(steps) / per_turn, u64::from(steps) % per_turn);
                let value = ratio(rest.into(), (360, per_turn.into()), DECIMALS);
                PositionEntry { turns: turns.to_string(), ..own(value) }
            }
            (PositionUnit::Millimetres, None) => match geometry {
                Some(Geometry::Linear { period_nm, .. }) => {
                    let size = (u128::from(period_nm), u128::from(STEPS_PER_PERIOD) * NANOMETRES);
                    own(ratio(steps.into(), size, DECIMALS))
                }
                _ => own(steps.to_string()),
            },
            _ => own(steps.to_string()),
        }
    }

    /// Returns the position in steps. An entry in steps may be decimal, or hexadecimal with the prefix `0x`. An angle
    /// or a distance is rounded to the nearest step.
    ///
    /// # Errors
    /// Returns an error with the valid range if the entry is not a position of the encoder.
    pub fn steps(&self, geometry: Option<Geometry>) -> Result<u32, Text> {
        let last =
            geometry.and_then(Geometry::position_count).map_or(u64::from(u32::MAX), |range| range.saturating_sub(1));
        let refused = || self.refused(last, geometry);
        let steps = self.parsed(geometry).ok_or_else(refused)?;
        u32::try_from(steps).ok().filter(|steps| u64::from(*steps) <= last).ok_or_else(refused)
    }

    /// Returns the entry in another unit. An entry that is not a position remains as typed.
    #[must_use]
    pub fn converted(&self, unit: PositionUnit, geometry: Option<Geometry>) -> Self {
        match self.steps(geometry) {
            Ok(steps) => PositionEntry::of(steps, unit, geometry),
            Err(_) => PositionEntry { unit, ..self.clone() },
        }
    }

    pub fn is_empty(&self) -> bool {
        self.turns.trim().is_empty() && self.value.trim().is_empty()
    }

    fn parsed(&self, geometry: Option<Geometry>) -> Option<u128> {
        let value = self.value.trim();
        match (self.unit, geometry) {
            (PositionUnit::Steps, _) => match value.strip_prefix("0x") {
                Some(hex) if hex.bytes().all(|c| c.is_ascii_hexdigit()) => u128::from_str_radix(hex, 16).ok(),
                Some(_) => None,
                None => whole(value),
            },
            (PositionUnit::Degrees, Some(rotary)) => nearest(value, (rotary.steps_per_turn()?.into(), 360)),
            (PositionUnit::TurnsAndDegrees, Some(rotary)) => {
                let per_turn = u128::from(rotary.steps_per_turn()?);
                let within = nearest(value, (per_turn, 360)).filter(|steps| *steps <= per_turn)?;
                whole(self.turns.trim())?.checked_mul(per_turn)?.checked_add(within)
            }
            (PositionUnit::Millimetres, Some(Geometry::Linear { period_nm, .. })) => {
                nearest(value, (u128::from(STEPS_PER_PERIOD) * NANOMETRES, period_nm.max(1).into()))
            }
            _ => None,
        }
    }

    fn refused(&self, last: u64, geometry: Option<Geometry>) -> Text {
        let end = PositionEntry::of(u32::try_from(last).unwrap_or(u32::MAX), self.unit, geometry);
        let (id, entry) = match self.unit {
            PositionUnit::Steps => ("entry.position", self.value.clone()),
            PositionUnit::Degrees => ("entry.degrees", self.value.clone()),
            PositionUnit::TurnsAndDegrees => ("entry.turns_degrees", format!("{} · {}", self.turns, self.value)),
            PositionUnit::Millimetres => ("entry.millimetres", self.value.clone()),
        };
        let text = TEXTS.text(id).with("entry", entry.trim());
        if self.unit == PositionUnit::TurnsAndDegrees {
            text.with("last", end.turns)
        } else {
            text.with_formatted_number("last", &end.value)
        }
    }
}

/// Describes a position in steps and, if the geometry is known, as an angle or a distance.
pub fn position_text(steps: u32, geometry: Option<Geometry>) -> Text {
    let place = |unit| PositionEntry::of(steps, unit, geometry);
    match geometry {
        None => TEXTS.text("place.steps").with("steps", steps),
        Some(Geometry::Rotary { .. }) => {
            let own = place(PositionUnit::TurnsAndDegrees);
            let text = TEXTS.text("place.rotary").with("steps", steps).with("turn", own.turns);
            text.with_formatted_number("degrees", &own.value)
        }
        Some(Geometry::Linear { .. }) => {
            let text = TEXTS.text("place.linear").with("steps", steps);
            text.with_formatted_number("millimetres", &place(PositionUnit::Millimetres).value)
        }
    }
}

fn whole(text: &str) -> Option<u128> {
    let is_number = !text.is_empty() && text.len() <= DIGITS && text.bytes().all(|c| c.is_ascii_digit());
    text.parse().ok().filter(|_| is_number)
}

/// Parses a decimal number, multiplies it by a fraction and rounds the result to the nearest whole number.
fn nearest(text: &str, (above, below): (u128, u128)) -> Option<u128> {
    let text = text.trim_end_matches('°').trim_end().replace(',', ".");
    let (before, behind) = text.split_once('.').unwrap_or((&text, ""));
    if behind.len() > DIGITS || (before.is_empty() && behind.is_empty()) {
        return None;
    }
    let digits = |part: &str| if part.is_empty() { Some(0) } else { whole(part) };
    let scale = 10_u128.checked_pow(u32::try_from(behind.len()).ok()?)?;
    let number = digits(before)?.checked_mul(scale)?.checked_add(digits(behind)?)?;
    let below = below.checked_mul(scale)?;
    Some(number.checked_mul(above)?.checked_add(below / 2)? / below.max(1))
}

/// Formats the product of `steps` and the fraction. It has at least `least` decimals, and enough to distinguish
/// consecutive steps.
fn ratio(steps: u128, (above, below): (u128, u128), least: u32) -> String {
    let below = below.max(1);
    let decimals = (least..DIGITS as u32).find(|own| above * 10_u128.pow(*own) > below).unwrap_or(DIGITS as u32);
    let scale = 10_u128.pow(decimals);
    let number = (steps * above * scale + below / 2) / below;
    format!("{}.{:0width$}", number / scale, number % scale, width = decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use PositionUnit::{Degrees, Millimetres, Steps, TurnsAndDegrees};

    /// 128 periods of 32 steps are 4096 steps per turn, and 4096 turns are 16,777,216 steps.
    const SKM36: Geometry = Geometry::Rotary { periods: 128, turns: 4096 };
    /// A period of 1.6 mm has 32 steps of 0.05 mm.
    const LINEAR: Geometry = Geometry::Linear { period_nm: 1_600_000, periods: 1000 };

    fn entry(unit: PositionUnit, turns: &str, value: &str) -> PositionEntry {
        PositionEntry { unit, turns: turns.to_owned(), value: value.to_owned() }
    }

    #[test]
    fn parses_positions_in_every_unit() {
        for (unit, turns, value, steps) in [
            (Steps, "", "0", 0),
            (Steps, "", " 1024 ", 1024),
            (Steps, "", "0x10", 16),
            (Steps, "", "16777215", 16_777_215),
            (Degrees, "", "90", 1024),
            (Degrees, "", "90 °", 1024),
            // 0.5° is 5.69 steps.
            (Degrees, "", "0,5", 6),
            // Two and a half turns.
            (Degrees, "", "900", 10_240),
            (TurnsAndDegrees, "2", "180", 10_240),
            // 224 turns and 116.807°, which are 1329.003 steps: 224 · 4096 + 1329.
            (TurnsAndDegrees, "224", "116.807", 918_833),
            (TurnsAndDegrees, "0", ".25", 3),
        ] {
            assert_eq!(entry(unit, turns, value).steps(Some(SKM36)), Ok(steps), "{unit:?} {turns} {value}");
        }
        assert_eq!(entry(Millimetres, "", "1.6").steps(Some(LINEAR)), Ok(32));
        assert_eq!(entry(Millimetres, "", "0,074").steps(Some(LINEAR)), Ok(1));
        assert_eq!(entry(Steps, "", "4294967295").steps(None), Ok(u32::MAX));
    }

    #[test]
    fn rejects_invalid_positions() {
        for (unit, turns, value) in [
            (Steps, "", ""),
            (Steps, "", "-1"),
            (Steps, "", "+5"),
            (Steps, "", "0x+5"),
            (Steps, "", "1.5"),
            (Steps, "", "90°"),
            (Steps, "", "16777216"),
            (Steps, "", "4294967296"),
            (Degrees, "", ""),
            (Degrees, "", "°"),
            (Degrees, "", "."),
            (Degrees, "", "-90"),
            (Degrees, "", "NaN"),
            (Degrees, "", "1e2"),
            (Degrees, "", "1.2.3"),
            // 4096 turns exceed the range.
            (Degrees, "", "1474560"),
            (Degrees, "", "99999999999999999999"),
            (TurnsAndDegrees, "", "10"),
            (TurnsAndDegrees, "1", ""),
            (TurnsAndDegrees, "1", "361"),
            (TurnsAndDegrees, "4096", "0"),
            (TurnsAndDegrees, "4095", "359.99"),
            (Millimetres, "", "1"),
        ] {
            assert!(entry(unit, turns, value).steps(Some(SKM36)).is_err(), "{unit:?} {turns} {value}");
        }
        assert!(entry(Degrees, "", "90").steps(None).is_err(), "without a resolution, degrees are no steps");
        // 1000 periods of 1.6 mm end at 1600 mm.
        assert!(entry(Millimetres, "", "1600").steps(Some(LINEAR)).is_err());
    }

    #[test]
    fn unit_conversions_round_trip() {
        let mut geometries = vec![LINEAR, Geometry::Linear { period_nm: 1, periods: 0 }];
        for periods in [1, 7, 16, 50, 128, 1000, 1024, 2048, 131_071] {
            geometries.extend([1, 4096].map(|turns| Geometry::Rotary { periods, turns }));
        }
        for geometry in geometries {
            let range = geometry.position_count().unwrap_or(1 << 32).min(1 << 32);
            let near_ends = (0..3000).chain(range.saturating_sub(3000)..range).filter(|steps| *steps < range);
            for steps in near_ends.chain((0..1000).map(|at| range / 1000 * at)) {
                let steps = u32::try_from(steps).unwrap();
                for unit in PositionUnit::available(Some(geometry)) {
                    let shown = PositionEntry::of(steps, *unit, Some(geometry));
                    assert_eq!(shown.steps(Some(geometry)), Ok(steps), "{geometry:?} {shown:?}");
                }
            }
        }
    }

    #[test]
    fn entry_follows_unit() {
        let degrees = entry(Steps, "", "918833").converted(TurnsAndDegrees, Some(SKM36));
        // 1329 · 360° / 4096 = 116.8066…°
        assert_eq!(degrees, entry(TurnsAndDegrees, "224", "116.807"));
        // 224 · 360 + 116.807
        assert_eq!(degrees.converted(Degrees, Some(SKM36)), entry(Degrees, "", "80756.807"));
        assert_eq!(degrees.converted(Steps, Some(SKM36)), entry(Steps, "", "918833"));
        assert_eq!(entry(Steps, "", "x").converted(Degrees, Some(SKM36)), entry(Degrees, "", "x"));
        assert_eq!(entry(Steps, "", "").converted(Degrees, Some(SKM36)), entry(Degrees, "", ""));
    }
}
