//! Wrapping of continuous counts to a range for display, such as the positions of a rotary encoder.

use super::picture::{Pixel, ReducedSamples, RenderedHistory};

impl RenderedHistory {
    /// Wraps counts to the range from 0 to below `range`. Where they wrap, the line is interrupted. A pixel column in
    /// which the counts wrap once has two parts, one at each end of the range.
    pub fn wrap(&mut self, range: i64) {
        let range = range.max(1) as f64;
        let mut wrapped = Vec::with_capacity(self.pixels.len());
        // Period of the last value, if the next value may be joined to it.
        let mut period: Option<f64> = None;
        for pixel in self.pixels.drain(..) {
            let Some(values) = pixel.values else {
                wrapped.push(pixel);
                continue;
            };
            let joined = pixel.joined && period == Some(wrap_index(values.first, range));
            period = Some(wrap_index(values.last, range));
            let is_whole = push_parts(&mut wrapped, Pixel { joined, ..pixel }, values, range);
            period = period.filter(|_| is_whole);
        }
        self.pixels = wrapped;
    }
}

fn wrap_index(value: f64, range: f64) -> f64 {
    (value / range).floor()
}

/// Appends the parts of a pixel column. Returns whether the last part contains the last value.
fn push_parts(wrapped: &mut Vec<Pixel>, pixel: Pixel, values: ReducedSamples, range: f64) -> bool {
    let [begin, end] = [values.first, values.last].map(|own| wrap_index(own, range));
    // The extremes are rounded outward, but counts are whole numbers.
    let (low, high) = (wrap_index(values.min.ceil(), range).min(begin.min(end)), wrap_index(values.max.floor(), range));
    let high = high.max(begin.max(end));
    let part = |period: f64, joined: bool| {
        let within = |own: f64| (own - period * range).clamp(0.0, range);
        let values = ReducedSamples {
            first: within(values.first),
            min: within(values.min),
            max: within(values.max),
            last: within(values.last),
        };
        Pixel { values: Some(values), joined, ..pixel }
    };
    if high - low > 1.0 {
        let whole = ReducedSamples { first: 0.0, min: 0.0, max: range, last: range };
        wrapped.push(Pixel { values: Some(whole), joined: false, ..pixel });
        return false;
    }
    wrapped.push(part(begin, pixel.joined));
    if low < high {
        wrapped.push(part(if begin == low { high } else { low }, false));
    }
    low == high || begin != end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::SampleTime;
    use crate::analysis::history::{ColumnPart, Flags, Grid, History, Kind};

    const RANGE: i64 = 1000;

    /// Returns the picture of counts that are one microsecond apart, in `pixels` columns.
    fn picture(counts: &[i64], pixels: usize) -> RenderedHistory {
        let mut history = History::new(&[Kind::Whole], 100_000);
        let times: Vec<SampleTime> =
            (0..counts.len() as i64).map(|at| SampleTime::from_nanoseconds(at * 1000)).collect();
        history
            .append(&times, &[ColumnPart::from_integers(counts).with_flags(&vec![Flags::NONE; counts.len()])])
            .unwrap();
        let end = SampleTime::from_nanoseconds(counts.len() as i64 * 1000);
        let mut picture = RenderedHistory::default();
        history.render_column(
            0,
            &history.divide_into_pixels(&Grid::new(SampleTime::ORIGIN, end, pixels)),
            &mut picture,
        );
        picture.wrap(RANGE);
        picture
    }

    fn extents(picture: &RenderedHistory) -> Vec<(f64, f64, bool)> {
        picture.pixels.iter().filter_map(|own| Some((own.values?.min, own.values?.max, own.joined))).collect()
    }

    #[test]
    fn does_not_join_samples_across_wrap() {
        let shown = extents(&picture(&[-1, 0, 998, 1001, 1000, 999], 6));
        let expected = [
            (999.0, 999.0, false),
            (0.0, 0.0, false),
            (998.0, 998.0, true),
            (1.0, 1.0, false),
            (0.0, 0.0, true),
            (999.0, 999.0, false),
        ];
        assert_eq!(shown, expected);
    }

    /// With one wrap in 2000 samples and 100 samples per column, each column spans 50 counts. No bar may therefore
    /// reach from one end of the range to the other.
    #[test]
    fn no_column_spans_wrap() {
        let counts: Vec<i64> = (0..10_000).map(|at| 25 + at / 2).collect();
        let picture = picture(&counts, 100);
        assert!(!picture.raw);
        let shown = extents(&picture);
        // 5025 counts pass the end of the range five times, and each time a column has a second part.
        assert_eq!(shown.len(), 105);
        assert!(shown.iter().all(|(min, max, _)| *min >= 0.0 && *max <= 1000.0 && max - min < 60.0), "{shown:?}");
        let starts = shown.iter().filter(|(.., joined)| !joined).count();
        assert_eq!(starts, 6, "the first column, and five beginnings of the range");
    }

    #[test]
    fn two_turns_fill_column_range() {
        let counts: Vec<i64> = (0..10_000).map(|at| at * 3).collect();
        let shown = extents(&picture(&counts, 10));
        assert!(shown.iter().all(|own| *own == (0.0, 1000.0, false)), "{shown:?}");
    }
}
