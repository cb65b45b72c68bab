//! Lissajous figure of sine over cosine as a density, like the phosphor display of an oscilloscope. It holds the number
//! of samples in each cell of a square, and the shortest and longest vector in each direction. Samples outside the
//! square and samples that are not numbers are counted separately. The module is independent of colours.

use std::f64::consts::TAU;

/// Square section of the plane with the cosine as the horizontal and the sine as the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotSquare {
    pub cosine_v: f64,
    pub sine_v: f64,
    /// Distance from the centre to an edge, in volts.
    pub half_v: f64,
}

/// Accumulated density of samples.
#[derive(Clone, Debug)]
pub struct SampleDensity {
    square: PlotSquare,
    side: usize,
    counts: Vec<u32>,
    directions: Vec<u8>,
    /// Squared vector lengths in each direction.
    lengths: [VectorLengths; SECTORS],
    outside: u64,
    bad: u64,
}

/// Shortest and longest amplitude vector √(sin² + cos²) in one direction, in volts, or (∞, 0) without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorLengths {
    pub least_v: f64,
    pub most_v: f64,
}

/// Number of directions of 5° each, counted from the cosine axis towards the sine axis.
pub const SECTORS: usize = 72;
/// Maximum number of cells per side.
pub const MAX_CELLS: usize = 2048;

/// Margin around the samples, as a fraction of their range.
const MARGIN: f64 = 0.05;
/// Minimum distance from the centre to an edge in volts, for samples that are all equal.
const MIN_HALF_V: f64 = 1e-3;

impl PlotSquare {
    /// Creates a square centred on zero, the origin of the vectors.
    pub const fn centred_on_zero(half_v: f64) -> Self {
        PlotSquare { cosine_v: 0.0, sine_v: 0.0, half_v }
    }

    /// Returns a square around all finite samples, with a margin. Returns `None` if a channel has no finite value.
    pub fn enclosing(sine: &[f64], cosine: &[f64]) -> Option<Self> {
        let ((left, right), (bottom, top)) = (finite_range(cosine)?, finite_range(sine)?);
        let half = ((right - left).max(top - bottom) / 2.0).max(MIN_HALF_V);
        let middle = |low: f64, high: f64| low + (high - low) / 2.0;
        Some(PlotSquare { cosine_v: middle(left, right), sine_v: middle(bottom, top), half_v: half * (1.0 + MARGIN) })
    }
}

impl SampleDensity {
    /// Creates an empty density with `side` × `side` cells. `side` is limited to the range 1 to [`MAX_CELLS`]. Returns
    /// `None` for an empty square.
    pub fn new(square: PlotSquare, side: usize) -> Option<Self> {
        let PlotSquare { cosine_v, sine_v, half_v } = square;
        if !(cosine_v.is_finite() && sine_v.is_finite() && half_v.is_finite() && half_v > 0.0) {
            return None;
        }
        let side = side.clamp(1, MAX_CELLS);
        let mut density = SampleDensity {
            square,
            side,
            counts: vec![0; side * side],
            directions: vec![0; side * side],
            lengths: [VectorLengths::NONE; SECTORS],
            outside: 0,
            bad: 0,
        };
        let cell_v = 2.0 * half_v / side as f64;
        for (at, direction) in density.directions.iter_mut().enumerate() {
            let middle = |place: usize, of: f64| of - half_v + (place as f64 + 0.5) * cell_v;
            *direction = sector_index(middle(at / side, sine_v), middle(at % side, cosine_v)) as u8;
        }
        Some(density)
    }

    /// Adds samples in volts. If one channel is longer, its surplus values are ignored.
    pub fn add_samples(&mut self, sine: &[f64], cosine: &[f64]) {
        let PlotSquare { cosine_v, sine_v, half_v } = self.square;
        let (left, bottom) = (cosine_v - half_v, sine_v - half_v);
        let side = self.side as f64;
        let scale = side / (2.0 * half_v);
        for (y, x) in sine.iter().zip(cosine) {
            let (column, row) = ((x - left) * scale, (y - bottom) * scale);
            // The comparison is also false for NaN.
            let inside = column >= 0.0 && column < side && row >= 0.0 && row < side;
            let length = y * y + x * x;
            let direction = if inside {
                let cell = row as usize * self.side + column as usize;
                if let Some(count) = self.counts.get_mut(cell) {
                    *count = count.saturating_add(1);
                }
                self.directions.get(cell).copied().map_or(0, usize::from)
            } else if y.is_finite() && x.is_finite() {
                self.outside += 1;
                sector_index(*y, *x)
            } else {
                self.bad += 1;
                continue;
            };
            if let Some(lengths) = self.lengths.get_mut(direction) {
                lengths.least_v = if length < lengths.least_v { length } else { lengths.least_v };
                lengths.most_v = if length > lengths.most_v { length } else { lengths.most_v };
            }
        }
    }

    pub fn clear(&mut self) {
        self.counts.fill(0);
        self.lengths = [VectorLengths::NONE; SECTORS];
        (self.outside, self.bad) = (0, 0);
    }

    pub fn plot_square(&self) -> PlotSquare {
        self.square
    }

    pub fn cells_per_side(&self) -> usize {
        self.side
    }

    /// Returns the number of samples in each cell, row by row. The sine increases from row to row, and the cosine
    /// within a row.
    pub fn cell_counts(&self) -> &[u32] {
        &self.counts
    }

    pub fn max_count(&self) -> u32 {
        self.counts.iter().copied().max().unwrap_or(0)
    }

    pub fn outside_count(&self) -> u64 {
        self.outside
    }

    /// Returns the number of samples that are not numbers.
    pub fn invalid_count(&self) -> u64 {
        self.bad
    }

    /// Returns the shortest and longest vector in each of the [`SECTORS`] directions. The lengths are exact, but each
    /// sample is assigned to the direction of its cell.
    pub fn vector_lengths(&self) -> [VectorLengths; SECTORS] {
        self.lengths.map(|squares| VectorLengths { least_v: squares.least_v.sqrt(), most_v: squares.most_v.sqrt() })
    }
}

impl VectorLengths {
    const NONE: VectorLengths = VectorLengths { least_v: f64::INFINITY, most_v: 0.0 };
}

/// Returns the index of the direction of a vector, at most `SECTORS` − 1.
fn sector_index(sine: f64, cosine: f64) -> usize {
    let share = (sine.atan2(cosine) / TAU).rem_euclid(1.0);
    ((share * SECTORS as f64) as usize).min(SECTORS - 1)
}

/// Returns the minimum and maximum of the finite values. Returns `None` if there are none.
fn finite_range(values: &[f64]) -> Option<(f64, f64)> {
    let finite = |value: f64| value.abs() < f64::INFINITY;
    let (groups, rest) = values.as_chunks::<4>();
    let mut ends = [(f64::INFINITY, f64::NEG_INFINITY); 4];
    let widen = |(least, most): &mut (f64, f64), value: f64| {
        *least = if finite(value) && value < *least { value } else { *least };
        *most = if finite(value) && value > *most { value } else { *most };
    };
    for group in groups {
        ends.iter_mut().zip(group).for_each(|(ends, value)| widen(ends, *value));
    }
    let [mut all, ..] = ends;
    rest.iter().for_each(|value| widen(&mut all, *value));
    for (least, most) in ends {
        all = (all.0.min(least), all.1.max(most));
    }
    (all.0 <= all.1).then_some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn counts_sample_in_its_cell() {
        // Cells of 0.25 V from −0.5 to 0.5 V.
        let mut density = SampleDensity::new(PlotSquare::centred_on_zero(0.5), 4).unwrap();
        let samples = [
            (-0.5, -0.5, Some(0)),
            (-0.49, 0.49, Some(3)),
            (0.0, 0.0, Some(10)),
            (0.3, -0.1, Some(13)),
            (0.499, 0.499, Some(15)),
            (0.5, 0.0, None),
            (0.0, -0.51, None),
        ];
        for (sine, cosine, cell) in samples {
            density.clear();
            density.add_samples(&[sine], &[cosine]);
            let found = density.cell_counts().iter().position(|count| *count == 1);
            assert_eq!((found, density.outside_count()), (cell, u64::from(cell.is_none())), "{sine} {cosine}");
        }
        density.add_samples(&[f64::NAN, 0.1, f64::INFINITY], &[0.1, f64::NAN, 0.1]);
        assert_eq!((density.invalid_count(), density.max_count()), (3, 0));
    }

    #[test]
    fn measures_vector_length_by_direction() {
        let mut density = SampleDensity::new(PlotSquare::centred_on_zero(0.7), 256).unwrap();
        for degree in 0..3_600 {
            let (y, x) = (f64::from(degree) / 10.0).to_radians().sin_cos();
            // 0.5 V all around, 0.4 V at 90°, 0.65 V at 200°, and 2 V at 300°, which is outside.
            let length = match degree {
                920 => 0.4,
                2_020 => 0.65,
                3_020 => 2.0,
                _ => 0.5,
            };
            density.add_samples(&[length * y], &[length * x]);
        }
        let lengths = density.vector_lengths();
        let near = |found: VectorLengths, least: f64, most: f64| {
            assert!((found.least_v - least).abs() < 1e-12 && (found.most_v - most).abs() < 1e-12, "{found:?}");
        };
        near(lengths[10], 0.5, 0.5);
        near(lengths[18], 0.4, 0.5);
        near(lengths[40], 0.5, 0.65);
        near(lengths[60], 0.5, 2.0);
        assert_eq!((density.outside_count(), density.max_count() > 1), (1, true));
        density.clear();
        assert_eq!(density.vector_lengths()[0], VectorLengths { least_v: f64::INFINITY, most_v: 0.0 });
    }

    #[test]
    fn fits_square_around_samples() {
        let square = PlotSquare::enclosing(&[2.0, 3.0, f64::NAN], &[-0.1, 0.1, 0.0]).unwrap();
        assert!((square.sine_v - 2.5).abs() < 1e-12 && square.cosine_v.abs() < 1e-12);
        assert!((square.half_v - 0.525).abs() < 1e-12);
        assert!((PlotSquare::enclosing(&[2.5], &[2.5]).unwrap().half_v - 1.05e-3).abs() < 1e-9);
        assert_eq!(PlotSquare::enclosing(&[], &[]), None);
        assert_eq!(PlotSquare::enclosing(&[f64::NAN], &[1.0]), None);
        for half_v in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(SampleDensity::new(PlotSquare::centred_on_zero(half_v), 4).is_none());
        }
        assert_eq!(SampleDensity::new(PlotSquare::centred_on_zero(1.0), 0).unwrap().cells_per_side(), 1);
    }

    proptest! {
        /// All samples are counted however they are split into calls, and none is outside a square around them.
        #[test]
        fn counts_every_sample(samples in proptest::collection::vec((any::<f32>(), any::<f32>()), 1..300), cut in 0_usize..300) {
            let (sine, cosine): (Vec<f64>, Vec<f64>) =
                samples.iter().map(|(sine, cosine)| (f64::from(*sine), f64::from(*cosine))).unzip();
            let cut = cut.min(sine.len());
            for square in [PlotSquare::enclosing(&sine, &cosine), Some(PlotSquare::centred_on_zero(0.6))].into_iter().flatten() {
                let mut density = SampleDensity::new(square, 16).unwrap();
                density.add_samples(&sine[..cut], &cosine[..cut]);
                density.add_samples(&sine[cut..], &cosine[cut..]);
                let inside: u64 = density.cell_counts().iter().map(|count| u64::from(*count)).sum();
                prop_assert_eq!(inside + density.outside_count() + density.invalid_count(), sine.len() as u64);
                if square.half_v != 0.6 {
                    prop_assert_eq!(density.outside_count(), 0);
                }
            }
        }
    }
}
