//! Grid lines of a chart at round positions.

use super::VisibleRange;
use crate::devices::interbus::profile::{Scale, Unit};

/// A grid line of the chart, at the start of a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    pub position: f64,
    pub value: f64,
    /// Number of decimals in its label.
    pub decimals: usize,
}

/// Possible intervals between grid lines in degrees. Each divides a full turn.
const DEGREES: [f64; 9] = [1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0];
/// Maximum number of grid lines. No chart has space for more.
const MAX_TICKS: usize = 400;

/// Returns the smallest number in the series 1, 2, 5, 10, 20, 50… that is at least `at_least`.
pub fn round_up_1_2_5(at_least: f64) -> f64 {
    if !at_least.is_finite() || at_least <= 0.0 {
        return 1.0;
    }
    let power = 10_f64.powf(at_least.log10().floor());
    let part = at_least / power;
    let nice = [1.0, 2.0, 5.0].into_iter().find(|nice| *nice >= part - 1e-9).unwrap_or(10.0);
    nice * power
}

/// Returns the visible grid lines, which are at least `apart` steps apart.
pub fn grid_ticks(scale: &Scale, view: &VisibleRange, range: u32, apart: f64) -> Vec<Tick> {
    let one = scale.steps_per_unit();
    let unit = round_interval(scale.unit(), apart / one);
    let decimals = decimal_places(unit);
    let zero = f64::from(scale.zero());
    let (from, to) = (view.first(), (view.first() + view.length()).min(f64::from(range)));
    let first = ((from - zero) / one / unit - 1e-9).ceil();
    let span = scale.range_length(range);
    let at = |line: usize| {
        let value = (first + line as f64) * unit;
        let shown = if scale.wraps_around(range) { wrap_value(value, span) } else { value };
        Tick { position: zero + value * one, value: shown, decimals }
    };
    (0..MAX_TICKS).map(at).take_while(|tick| tick.position <= to + 1e-9).collect()
}

/// Returns the next grid line after a position, or the last one before it, in steps. It may be beyond the range.
pub fn next_grid_line(scale: &Scale, apart: f64, position: u32, forward: bool) -> i64 {
    let around = grid_lines_around(scale, apart, f64::from(position), 2);
    let position = i64::from(position);
    let mut lines = around.into_iter().map(|line| line as i64);
    if forward {
        lines.find(|line| *line > position).unwrap_or(position)
    } else {
        lines.rfind(|line| *line < position).unwrap_or(position)
    }
}

/// Returns the grid lines around a position in ascending order, with at least `each` lines on either side. They are
/// rounded to whole steps.
pub(super) fn grid_lines_around(scale: &Scale, apart: f64, position: f64, each: i32) -> Vec<f64> {
    let steps = scale.steps_per_unit() * round_interval(scale.unit(), apart / scale.steps_per_unit());
    let zero = f64::from(scale.zero());
    let own = ((position - zero) / steps).floor();
    (-each..=each + 1).map(|line| (zero + (own + f64::from(line)) * steps).round()).collect()
}

/// Returns the smallest round number, for the given unit, that is not below `at_least`.
fn round_interval(unit: Unit, at_least: f64) -> f64 {
    match unit {
        Unit::Steps => round_up_1_2_5(at_least).max(1.0),
        Unit::Millimetres => round_up_1_2_5(at_least),
        Unit::Degrees if at_least > 180.0 => round_up_1_2_5(at_least / 360.0).max(1.0) * 360.0,
        Unit::Degrees if at_least > 0.5 => {
            DEGREES.into_iter().find(|degrees| *degrees >= at_least - 1e-9).unwrap_or(360.0)
        }
        Unit::Degrees => round_up_1_2_5(at_least),
    }
}

fn wrap_value(value: f64, span: f64) -> f64 {
    let turned = value.rem_euclid(span);
    if (span - turned).abs() < 1e-9 * span { 0.0 } else { turned }
}

fn decimal_places(unit: f64) -> usize {
    if unit >= 1.0 { 0 } else { (-unit.log10()).ceil().clamp(0.0, 6.0) as usize }
}
