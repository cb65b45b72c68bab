//! The two kinds of numbers in a history, and their outward rounding, which ensures that a range never becomes too
//! small.

/// Value of a sample, exactly as appended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    Real(f64),
    /// A count, for example a position in steps.
    Whole(i64),
}

impl Value {
    /// Returns the nearest `f64`, which is exact for counts below 2⁵³.
    pub fn to_f64(self) -> f64 {
        match self {
            Value::Real(real) => real,
            Value::Whole(whole) => whole as f64,
        }
    }
}

pub(super) trait Number: Copy + PartialOrd {
    fn is_number(self) -> bool;

    /// Returns the distance from `base`, rounded down. [`at_most`](Number::at_most) turns it into a value at or
    /// slightly below the number. Returns −∞ if the distance exceeds the range of `f32`.
    fn distance_down(self, base: Self) -> f32;

    /// Returns the distance from `base`, rounded up. [`at_least`](Number::at_least) turns it into a value at or
    /// slightly above the number. Returns +∞ if the distance exceeds the range of `f32`.
    fn distance_up(self, base: Self) -> f32;

    /// Returns `self + distance`, rounded down if rounding is necessary.
    fn at_most(self, distance: f32) -> f64;

    /// Returns `self + distance`, rounded up if rounding is necessary.
    fn at_least(self, distance: f32) -> f64;

    /// Returns the distance from `self` to `known`, rounded up so that [`at_most`](Number::at_most) yields at least
    /// `known`. Returns +∞ if no such distance is found.
    fn distance_rounded_up(self, known: f64) -> f32 {
        let distance = (known - self.value().to_f64()) as f32;
        let candidates = [distance, distance.next_up(), distance.next_up().next_up()];
        let holds = |distance: &f32| distance.is_finite() && self.at_most(*distance) >= known;
        candidates.into_iter().find(holds).unwrap_or(f32::INFINITY)
    }

    /// Returns the distance from `self` to `known`, rounded down so that [`at_least`](Number::at_least) yields at most
    /// `known`. Returns −∞ if no such distance is found.
    fn distance_rounded_down(self, known: f64) -> f32 {
        let distance = (known - self.value().to_f64()) as f32;
        let candidates = [distance, distance.next_down(), distance.next_down().next_down()];
        let holds = |distance: &f32| distance.is_finite() && self.at_least(*distance) <= known;
        candidates.into_iter().find(holds).unwrap_or(f32::NEG_INFINITY)
    }

    /// Returns `self − base`, rounded to nearest.
    fn difference_from(self, base: Self) -> f64;

    /// Returns the greatest `f64` not above the number.
    fn to_f64_floor(self) -> f64;

    /// Returns the least `f64` not below the number.
    fn to_f64_ceil(self) -> f64;

    fn value(self) -> Value;
}

impl Number for f64 {
    fn is_number(self) -> bool {
        self.is_finite()
    }

    fn distance_down(self, base: f64) -> f32 {
        let mut distance = (self - base) as f32;
        if distance.is_infinite() {
            return f32::NEG_INFINITY;
        }
        // Half of the numbers are rounded to the wrong side. No processor can predict which, so there is no branch.
        distance = step_f32(distance, -i32::from(base.at_most(distance) > self));
        while base.at_most(distance) > self {
            distance = distance.next_down();
        }
        distance
    }

    fn distance_up(self, base: f64) -> f32 {
        let mut distance = (self - base) as f32;
        if distance.is_infinite() {
            return f32::INFINITY;
        }
        distance = step_f32(distance, i32::from(base.at_least(distance) < self));
        while base.at_least(distance) < self {
            distance = distance.next_up();
        }
        distance
    }

    // The sum is rounded to nearest, which `down` and `up` have taken into account.
    fn at_most(self, distance: f32) -> f64 {
        self + f64::from(distance)
    }

    fn at_least(self, distance: f32) -> f64 {
        self + f64::from(distance)
    }

    fn difference_from(self, base: f64) -> f64 {
        self - base
    }

    fn to_f64_floor(self) -> f64 {
        self
    }

    fn to_f64_ceil(self) -> f64 {
        self
    }

    fn value(self) -> Value {
        Value::Real(self)
    }
}

/// Moves a finite `f32` up by the given number of representable values. −0 is one step below 0.
fn step_f32(distance: f32, steps: i32) -> f32 {
    // With the bits of negative numbers inverted, the bit patterns are in numerical order.
    let ordered = |bits: i32| bits ^ ((bits >> 31) & i32::MAX);
    let place = ordered(distance.to_bits().cast_signed()).wrapping_add(steps);
    f32::from_bits(ordered(place).cast_unsigned())
}

/// Largest magnitude up to which `f32` represents every whole number exactly.
const MAX_EXACT_F32_INTEGER: u64 = 1 << 24;

/// Largest magnitude of two numbers up to which an `f64` represents their sum exactly.
const EXACT_SUM_LIMIT: f64 = (1_i64 << 52) as f64;

impl Number for i64 {
    fn is_number(self) -> bool {
        true
    }

    fn distance_down(self, base: i64) -> f32 {
        if let Some(near) = self.checked_sub(base).filter(|near| near.unsigned_abs() <= MAX_EXACT_F32_INTEGER) {
            return near as f32;
        }
        let exact = i128::from(self) - i128::from(base);
        let mut distance = exact as f32;
        while distance as i128 > exact {
            distance = distance.next_down();
        }
        distance
    }

    fn distance_up(self, base: i64) -> f32 {
        if let Some(near) = self.checked_sub(base).filter(|near| near.unsigned_abs() <= MAX_EXACT_F32_INTEGER) {
            return near as f32;
        }
        let exact = i128::from(self) - i128::from(base);
        let mut distance = exact as f32;
        while (distance as i128) < exact {
            distance = distance.next_up();
        }
        distance
    }

    fn at_most(self, distance: f32) -> f64 {
        let (base, distance) = (self as f64, f64::from(distance));
        if base.abs() <= EXACT_SUM_LIMIT && distance.abs() <= EXACT_SUM_LIMIT {
            return base + distance;
        }
        i128_to_f64_floor(i128::from(self) + distance as i128)
    }

    fn at_least(self, distance: f32) -> f64 {
        let (base, distance) = (self as f64, f64::from(distance));
        if base.abs() <= EXACT_SUM_LIMIT && distance.abs() <= EXACT_SUM_LIMIT {
            return base + distance;
        }
        i128_to_f64_ceil(i128::from(self) + distance as i128)
    }

    fn difference_from(self, base: i64) -> f64 {
        match self.checked_sub(base) {
            Some(difference) => difference as f64,
            None => (i128::from(self) - i128::from(base)) as f64,
        }
    }

    fn to_f64_floor(self) -> f64 {
        i128_to_f64_floor(i128::from(self))
    }

    fn to_f64_ceil(self) -> f64 {
        i128_to_f64_ceil(i128::from(self))
    }

    fn value(self) -> Value {
        Value::Whole(self)
    }
}

fn i128_to_f64_floor(exact: i128) -> f64 {
    let nearest = exact as f64;
    if nearest as i128 > exact { nearest.next_down() } else { nearest }
}

fn i128_to_f64_ceil(exact: i128) -> f64 {
    let nearest = exact as f64;
    if (nearest as i128) < exact { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn large_counts_stay_exact_near_base() {
        let base = 1 << 60;
        for step in [0, 1, -1, 12_345_677, -(1 << 24)] {
            let position: i64 = base + step;
            assert_eq!((position.distance_down(base), position.distance_up(base)), (step as f32, step as f32));
        }
        let far = (1_i64 << 24) + 1;
        assert_eq!((far.distance_down(0), far.distance_up(0)), (16_777_216.0, 16_777_218.0));
        assert_eq!(i64::MAX.distance_up(i64::MIN), 18_446_744_073_709_551_616.0);
    }

    #[test]
    fn values_beyond_f32_are_infinite() {
        assert_eq!((1e300).distance_down(0.0), f32::NEG_INFINITY);
        assert_eq!((1e300).distance_up(0.0), f32::INFINITY);
        assert_eq!(f64::MAX.distance_down(f64::MIN), f32::NEG_INFINITY);
        assert_eq!((1e300).distance_down(1e300), 0.0);
    }

    proptest! {
        #[test]
        fn rounds_counts_outward(value in any::<i64>(), base in any::<i64>(), shift in 0..63) {
            let value = base.saturating_add(value >> shift);
            let distance = (i128::from(value) - i128::from(base)).unsigned_abs() as f64;
            let loss = distance / f64::from(1 << 23) + (value as f64).abs() * f64::EPSILON * 2.0;
            let (low, high) = (base.at_most(value.distance_down(base)), base.at_least(value.distance_up(base)));
            prop_assert!(low as i128 <= i128::from(value) && i128::from(value) <= high as i128);
            prop_assert!(high - low <= 2.0 * loss, "{low} {value} {high}");
        }

        #[test]
        fn rounds_reals_outward(value in any::<f64>(), base in any::<f64>(), close in any::<f64>()) {
            prop_assume!(value.is_finite() && base.is_finite());
            for value in [value, base + base * (close % 1.0), base.next_up(), base.next_down(), 0.0] {
                let (low, high) = (value.distance_down(base), value.distance_up(base));
                prop_assert_eq!(low.is_infinite(), high.is_infinite());
                if low.is_finite() && value.is_finite() {
                    let (low, high) = (base.at_most(low), base.at_least(high));
                    prop_assert!(low <= value && value <= high);
                    let loss = (value - base).abs() / f64::from(1 << 23) + 2e-45;
                    let grain = (value.abs().max(base.abs())) * f64::EPSILON;
                    prop_assert!(high - low <= 2.0 * (loss + grain), "{low:e} {value:e} {high:e} {base:e}");
                }
            }
        }
    }
}
