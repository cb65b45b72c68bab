//! Sums of powers of two signals up to the fourth, which are all that is needed to fit an ellipse to any number of
//! samples (Heydemann 1981). The sums are accumulated at a scale near one, which preserves precision in any unit, and
//! can be moved to another origin afterwards.

use super::ellipse::{Ellipse, FitError};

/// Largest sum of the powers of x and y.
const ORDER: usize = 4;
/// Number of powers in a row of the table.
const ROW: usize = ORDER + 1;
/// Number of samples in a partial sum. With partial sums, rounding errors grow with the square root of the number of
/// blocks instead of the number of samples.
const BLOCK: usize = 4096;
/// Number of sums that the processor accumulates in parallel.
const LANES: usize = 2;
/// Powers of x and y for each sum.
const POWERS: [(usize, usize); 14] =
    [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3), (4, 0), (3, 1), (2, 2), (1, 3), (0, 4)];

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    x: f64,
    y: f64,
    unit: f64,
}

/// Sums of xⁱ·yʲ with i + j ≤ 4, where x is the cosine channel and y the sine channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    scale: Scale,
    count: usize,
    sums: [f64; ROW * ROW],
    least: (f64, f64),
    most: (f64, f64),
}

#[derive(Clone, Copy)]
struct Extremes {
    least: (f64, f64),
    most: (f64, f64),
}

impl Scale {
    /// Creates a scale for samples with approximately the given mean levels and amplitude, in volts. If signals arrive
    /// in pieces, the scale of the first piece applies to all.
    pub fn new(sine: f64, cosine: f64, amplitude: f64) -> Self {
        let unit = if amplitude.is_finite() && amplitude > 0.0 { amplitude } else { 1.0 };
        Scale { x: cosine, y: sine, unit }
    }
}

impl Moments {
    pub fn new(scale: Scale) -> Self {
        let (least, most) = ((f64::INFINITY, f64::INFINITY), (f64::NEG_INFINITY, f64::NEG_INFINITY));
        Moments { scale, count: 0, sums: [0.0; ROW * ROW], least, most }
    }

    /// Returns the sums over all samples at the best scale. If one channel is longer, its surplus values are ignored.
    ///
    /// # Errors
    /// Returns [`FitError::NotFinite`] with the index of the first sample that is not finite.
    pub fn from_samples(sine: &[f64], cosine: &[f64]) -> Result<Self, FitError> {
        let Extremes { least, most } = Extremes::from_samples(sine, cosine);
        let middle = |low: f64, high: f64| low + (high - low) / 2.0;
        let amplitude = ((most.0 - least.0).max(most.1 - least.1) / 2.0).max(f64::MIN_POSITIVE);
        let scale = Scale::new(middle(least.1, most.1), middle(least.0, most.0), amplitude);
        let mut moments = Moments::new(scale);
        moments.add_samples(sine, cosine)?;
        Ok(moments)
    }

    /// Adds samples in volts. If one channel is longer, its surplus values are ignored.
    ///
    /// # Errors
    /// Returns [`FitError::NotFinite`] if a sample is not finite. In this case, only the whole blocks before that
    /// sample have been added.
    pub fn add_samples(&mut self, sine: &[f64], cosine: &[f64]) -> Result<(), FitError> {
        let length = sine.len().min(cosine.len());
        let (sine, cosine) = (sine.get(..length).unwrap_or_default(), cosine.get(..length).unwrap_or_default());
        for (block, (ys, xs)) in sine.chunks(BLOCK).zip(cosine.chunks(BLOCK)).enumerate() {
            let sums = self.block_sums(xs, ys);
            let extremes = Extremes::from_samples(ys, xs);
            // These sums are not finite if a sample is not finite or its fourth power overflows.
            if !sums.iter().all(|sum| sum.is_finite()) {
                let bad = xs.iter().zip(ys).position(|(x, y)| !x.is_finite() || !y.is_finite());
                return Err(FitError::NotFinite { index: block * BLOCK + bad.unwrap_or_default() });
            }
            for ((i, j), sum) in POWERS.into_iter().zip(sums) {
                if let Some(total) = self.sums.get_mut(i * ROW + j) {
                    *total += sum;
                }
            }
            self.count += xs.len();
            self.least = (self.least.0.min(extremes.least.0), self.least.1.min(extremes.least.1));
            self.most = (self.most.0.max(extremes.most.0), self.most.1.max(extremes.most.1));
        }
        if let Some(ones) = self.sums.first_mut() {
            *ones = self.count as f64;
        }
        Ok(())
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the sum of xⁱ·yʲ in the unit of the scale, or 0 beyond the fourth power.
    pub(super) fn sum(&self, i: usize, j: usize) -> f64 {
        if i + j > ORDER { 0.0 } else { self.sums.get(i * ROW + j).copied().unwrap_or(0.0) }
    }

    /// Returns the ranges of the cosine and sine channels in volts.
    pub(super) fn ranges(&self) -> (f64, f64) {
        (self.most.0 - self.least.0, self.most.1 - self.least.1)
    }

    /// Returns the largest absolute voltage.
    pub(super) fn max_abs_voltage(&self) -> f64 {
        [self.least.0, self.least.1, self.most.0, self.most.1].into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    pub(super) fn central_moments(&self) -> Moments {
        let count = self.sum(0, 0).max(1.0);
        self.with_origin(self.sum(1, 0) / count, self.sum(0, 1) / count)
    }

    /// Returns the moments with the origin moved to (x, y), in the unit of the scale. The binomial theorem expands (x −
    /// a)ⁱ·(y − b)ʲ.
    pub(super) fn with_origin(&self, x: f64, y: f64) -> Moments {
        const BINOMIAL: [[f64; ROW]; ROW] = [
            [1.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0, 0.0],
            [1.0, 2.0, 1.0, 0.0, 0.0],
            [1.0, 3.0, 3.0, 1.0, 0.0],
            [1.0, 4.0, 6.0, 4.0, 1.0],
        ];
        let choose = |n: usize, k: usize| BINOMIAL.get(n).and_then(|row| row.get(k)).copied().unwrap_or(0.0);
        let power = |base: f64, exponent: usize| (0..exponent).fold(1.0, |product, _| product * base);
        let mut moved = self.clone();
        for (place, sum) in moved.sums.iter_mut().enumerate() {
            let (i, j) = (place / ROW, place % ROW);
            if i + j > ORDER {
                continue;
            }
            *sum = 0.0;
            for (k, l) in (0..=i).flat_map(|k| (0..=j).map(move |l| (k, l))) {
                *sum += choose(i, k) * choose(j, l) * power(-x, i - k) * power(-y, j - l) * self.sum(k, l);
            }
        }
        moved.scale.x += x * self.scale.unit;
        moved.scale.y += y * self.scale.unit;
        moved
    }

    /// Converts an ellipse found at the moments' scale to volts.
    pub(super) fn ellipse_in_volts(&self, ellipse: &Ellipse) -> Ellipse {
        Ellipse {
            amplitude_v: ellipse.amplitude_v * self.scale.unit,
            offset_cosine_v: ellipse.offset_cosine_v * self.scale.unit + self.scale.x,
            offset_sine_v: ellipse.offset_sine_v * self.scale.unit + self.scale.y,
            ..*ellipse
        }
    }

    fn block_sums(&self, xs: &[f64], ys: &[f64]) -> [f64; 14] {
        let mut lanes = [[0.0; LANES]; 14];
        let factor = 1.0 / self.scale.unit;
        let add = |lanes: &mut [[f64; LANES]; 14], lane: usize, x: f64, y: f64| {
            let (x, y) = ((x - self.scale.x) * factor, (y - self.scale.y) * factor);
            let (xx, xy, yy) = (x * x, x * y, y * y);
            let powers =
                [x, y, xx, xy, yy, xx * x, xx * y, x * yy, yy * y, xx * xx, xx * xy, xx * yy, xy * yy, yy * yy];
            for (sums, power) in lanes.iter_mut().zip(powers) {
                if let Some(sum) = sums.get_mut(lane) {
                    *sum += power;
                }
            }
        };
        let (pairs, rest) = xs.as_chunks::<LANES>();
        let (pairs_y, rest_y) = ys.as_chunks::<LANES>();
        for (x, y) in pairs.iter().zip(pairs_y) {
            for lane in 0..LANES {
                if let (Some(x), Some(y)) = (x.get(lane), y.get(lane)) {
                    add(&mut lanes, lane, *x, *y);
                }
            }
        }
        for (x, y) in rest.iter().zip(rest_y) {
            add(&mut lanes, 0, *x, *y);
        }
        lanes.map(|sums| sums.iter().sum())
    }
}

impl Extremes {
    fn from_samples(sine: &[f64], cosine: &[f64]) -> Self {
        let ((least_x, most_x), (least_y, most_y)) = (min_and_max(cosine), min_and_max(sine));
        Extremes { least: (least_x, least_y), most: (most_x, most_y) }
    }
}

fn min_and_max(values: &[f64]) -> (f64, f64) {
    let (groups, rest) = values.as_chunks::<4>();
    let mut least = [f64::INFINITY; 4];
    let mut most = [f64::NEG_INFINITY; 4];
    for group in groups {
        for ((least, most), value) in least.iter_mut().zip(&mut most).zip(group) {
            *least = if value < least { *value } else { *least };
            *most = if value > most { *value } else { *most };
        }
    }
    let all = |start: [f64; 4], choose: fn(f64, f64) -> f64| start.iter().chain(rest).copied().fold(start[0], choose);
    (all(least, f64::min), all(most, f64::max))
}
