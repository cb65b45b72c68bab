//! Sample time stamps in whole nanoseconds, so that differences stay exact even after days. The module is independent
//! of any clock.

use crate::units::Moment;

/// Point in time in whole nanoseconds from an origin that all samples of a history share. The origin is, for example,
/// the start of a session's clock or the trigger of a capture. Earlier times are negative. The range is 292 years in
/// both directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct SampleTime(i64);

impl SampleTime {
    pub const ORIGIN: SampleTime = SampleTime(0);

    pub const fn from_nanoseconds(nanoseconds: i64) -> Self {
        SampleTime(nanoseconds)
    }

    pub const fn as_nanoseconds(self) -> i64 {
        self.0
    }

    /// Returns the point in time `nanoseconds` later, saturating at the end of the range.
    pub const fn saturating_add_ns(self, nanoseconds: i64) -> Self {
        SampleTime(self.0.saturating_add(nanoseconds))
    }

    /// Returns the exact number of nanoseconds since `origin`, which is negative if `origin` is later.
    pub const fn nanoseconds_since(self, origin: SampleTime) -> i64 {
        self.0.saturating_sub(origin.0)
    }

    /// Returns the number of seconds since `origin`. The difference is calculated before rounding, so the result is
    /// exact near `origin`.
    pub fn seconds_since(self, origin: SampleTime) -> f64 {
        self.nanoseconds_since(origin) as f64 / 1e9
    }
}

impl From<Moment> for SampleTime {
    /// Converts a moment to a sample time, which is counted from the start of the clock.
    fn from(moment: Moment) -> Self {
        let elapsed = moment.since_start();
        let seconds = i64::try_from(elapsed.as_secs()).unwrap_or(i64::MAX);
        SampleTime(seconds.saturating_mul(1_000_000_000).saturating_add(i64::from(elapsed.subsec_nanos())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn keeps_nanoseconds() {
        let ten_days = Duration::new(864_000, 1);
        assert_eq!(SampleTime::from(Moment::from_elapsed(ten_days)).as_nanoseconds(), 864_000_000_000_001);
        assert_eq!(SampleTime::from(Moment::from_elapsed(Duration::MAX)).as_nanoseconds(), i64::MAX);
    }

    #[test]
    fn differences_stay_exact_after_days() {
        let late = SampleTime::from_nanoseconds(864_000_000_000_000);
        assert_eq!(late.saturating_add_ns(1).nanoseconds_since(late), 1);
        assert_eq!(late.saturating_add_ns(1).seconds_since(late), 1e-9);
        assert_eq!(late.nanoseconds_since(late.saturating_add_ns(1)), -1);
        assert_eq!(SampleTime::from_nanoseconds(i64::MAX).saturating_add_ns(1), SampleTime::from_nanoseconds(i64::MAX));
    }
}
