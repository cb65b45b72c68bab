//! Scales of positions: range, size of a step, and units.

use crate::app::Text;
use crate::app::recorder::{GroupId, Scale, Series};

#[derive(Clone, Debug, PartialEq)]
pub struct PositionScales {
    /// Number of positions before they wrap, or `None` for a linear encoder.
    pub(in crate::app) range: Option<i64>,
    /// Units of position, speed and acceleration. Samples are in steps.
    pub scales: [Vec<Scale>; 3],
    pub(in crate::app) is_linear: bool,
    /// Size of a step in turns or millimetres, if known.
    step: Option<f64>,
}

impl PositionScales {
    /// Creates the scales for steps of unknown size.
    pub fn for_steps(range: Option<i64>) -> Self {
        let scales = [
            vec![Scale::new("unit.steps", 1.0, 0)],
            vec![Scale::new("unit.steps_per_second", 1.0, 0)],
            vec![Scale::new("unit.steps_per_second_squared", 1.0, 0)],
        ];
        PositionScales { range, scales, is_linear: false, step: None }
    }

    /// Creates the scales for positions of a shaft. The number of steps per revolution may be fractional.
    pub fn for_steps_per_turn(range: Option<i64>, steps_per_turn: f64) -> Self {
        let turns = 1.0 / steps_per_turn.max(f64::MIN_POSITIVE);
        let mut scales = [
            vec![
                Scale::new("unit.turns", turns, 5),
                Scale::new("unit.degrees", 360.0 * turns, 3),
                Scale::new("unit.steps", 1.0, 0),
            ],
            vec![
                Scale::new("unit.revolutions_per_minute", 60.0 * turns, 2),
                Scale::new("unit.degrees_per_second", 360.0 * turns, 1),
                Scale::new("unit.steps_per_second", 1.0, 0),
            ],
            vec![
                Scale::new("unit.revolutions_per_second_squared", turns, 3),
                Scale::new("unit.radians_per_second_squared", std::f64::consts::TAU * turns, 2),
                Scale::new("unit.steps_per_second_squared", 1.0, 0),
            ],
        ];
        if let ([positions, ..], Some(range)) = (&mut scales, range) {
            positions.push(Scale::new("unit.turns_in_range", turns, 5).within(range));
        }
        PositionScales { range, scales, is_linear: false, step: Some(turns) }
    }

    /// Displays positions wrapped to their range by default, as sent by the device.
    #[must_use]
    pub fn within_range(mut self) -> Self {
        let [positions, ..] = &mut self.scales;
        positions.sort_by_key(|scale| scale.range.is_none());
        self
    }

    /// Creates the scales for linear positions. `millimetres` is the length of a step.
    pub fn for_millimetres(millimetres: f64) -> Self {
        let scales = [
            vec![Scale::new("unit.millimetres", millimetres, 4), Scale::new("unit.steps", 1.0, 0)],
            vec![
                Scale::new("unit.millimetres_per_second", millimetres, 3),
                Scale::new("unit.metres_per_minute", millimetres * 0.06, 4),
                Scale::new("unit.steps_per_second", 1.0, 0),
            ],
            vec![
                Scale::new("unit.millimetres_per_second_squared", millimetres, 1),
                Scale::new("unit.steps_per_second_squared", 1.0, 0),
            ],
        ];
        PositionScales { range: None, scales, is_linear: true, step: Some(millimetres) }
    }

    /// Returns whether both scales apply to the same positions, possibly in different units.
    pub(super) fn is_same_location(&self, other: &PositionScales) -> bool {
        let own = |meaning: &PositionScales| (meaning.range, meaning.is_linear, meaning.step);
        own(self) == own(other)
    }

    fn column_headings(&self) -> [(&'static str, &'static str); 3] {
        let speed = if self.is_linear { "recorder.speed_linear" } else { "recorder.speed" };
        [("recorder.position", "position"), (speed, "speed"), ("recorder.acceleration", "acceleration")]
    }

    pub(super) fn create_series(&self, group: GroupId) -> [Series; 3] {
        let [position, speed, acceleration] = self.scales.clone();
        let [own_position, own_speed, own_acceleration] = self.column_headings();
        let line = |column, (name, heading): (&'static str, &'static str), scales| {
            Series::new(group, column, Text::new(name), heading, scales)
        };
        [
            line(0, own_position, position),
            line(1, own_speed, speed).into_derived(),
            line(2, own_acceleration, acceleration).into_derived().initially_hidden(),
        ]
    }
}
