//! Tick steps of 1, 2 or 5 times a power of ten.

/// Returns the smallest step of 1, 2 or 5 times a power of ten that divides `span` into at most `most` parts.
pub fn step_1_2_5(span: f64, most: f64) -> f64 {
    let least = span / most.max(1.0);
    if !least.is_finite() || least <= 0.0 {
        return 1.0;
    }
    let power = 10_f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|step| *step >= least * 0.999_999);
    step.unwrap_or(10.0 * power)
}

/// Returns the number of decimals that a label needs for the given step.
pub fn decimal_places(step: f64) -> usize {
    // Steps such as 1e-300 do not occur in measurements.
    (-step.log10() - 1e-9).ceil().clamp(0.0, 12.0) as usize
}

/// Returns the multiples of a step within a range.
pub fn tick_values(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    /// Maximum number of ticks, which exceeds what a plot can display. Without this limit, a step of zero would cause
    /// an endless loop.
    const MAX_TICKS: i64 = 200;
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let count = if (last - first).is_finite() { ((last - first) as i64 + 1).clamp(0, MAX_TICKS) } else { 0 };
    // Each tick is calculated from the first, so errors do not accumulate. Adding 0 turns −0 into 0.
    (0..count).map(move |at| (first + at as f64) * step + 0.0)
}
