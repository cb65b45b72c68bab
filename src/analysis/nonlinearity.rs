//! Differential and integral non-linearity against a reference. The deviation within one signal period is caused by
//! offset, gain, phase and harmonics, and the deviation over the revolution by eccentricity, coupling and scale. The
//! mean over one period around each sample is the integral part, and the rest is the differential part. Both are given
//! as ± values, which are half of the peak-to-peak range. See SICK 8010701, definitions of errors, and section 6 of the
//! project's sine/cosine reference.

#[derive(Clone, Debug, PartialEq)]
pub struct Nonlinearity {
    /// DNL: ± deviation inside one period, in mechanical degrees.
    pub differential_deg: f64,
    /// INL: ± deviation of the mean over one period, in mechanical degrees.
    pub integral_deg: f64,
    /// Both parts of the deviation over the reference angle, with the mean removed, in mechanical degrees. Only samples
    /// surrounded by a whole period are included.
    pub curve: Vec<Deviation>,
    /// Number of revolutions covered by the curve. The INL applies to a whole revolution only if this is at least 1.
    pub revolutions: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Reference angle in mechanical degrees.
    pub reference_deg: f64,
    /// Deviation from the mean over a period, in mechanical degrees.
    pub differential_deg: f64,
    /// Mean deviation over a period, in mechanical degrees.
    pub integral_deg: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NonlinearityError {
    /// The reference angle reverses or does not change.
    #[error("the reference reverses or does not change at sample {index}")]
    NotMonotonic {
        /// Sample index, counted from 0.
        index: usize,
    },
    /// The data cover less than two periods, or a period has fewer than four samples.
    #[error("at least two periods with at least four samples each are required")]
    TooLittle,
    /// A sample is not a finite number, or `periods` is zero.
    #[error("a sample is not a number")]
    NotFinite,
}

/// Compares measured and reference angles in mechanical degrees, both unwrapped. `periods` is the number of signal
/// periods per revolution.
///
/// # Errors
/// Returns a [`NonlinearityError`] if the reference reverses, or the data are too short or invalid.
pub fn compute_nonlinearity(
    measured: &[f64],
    reference: &[f64],
    periods: u32,
) -> Result<Nonlinearity, NonlinearityError> {
    let count = measured.len().min(reference.len());
    let (measured, reference) = (measured.get(..count).unwrap_or_default(), reference.get(..count).unwrap_or_default());
    let finite = measured.iter().chain(reference).all(|value| value.is_finite());
    let (Some(first), Some(last)) = (reference.first(), reference.last()) else {
        return Err(NonlinearityError::TooLittle);
    };
    if !finite || periods == 0 {
        return Err(NonlinearityError::NotFinite);
    }
    let direction = (last - first).signum();
    let forward = |pair: &[f64]| matches!(pair, [a, b] if (b - a) * direction > 0.0);
    if let Some(before) = reference.windows(2).position(|pair| !forward(pair)) {
        return Err(NonlinearityError::NotMonotonic { index: before + 1 });
    }
    let period_deg = 360.0 / f64::from(periods);
    let covered = (last - first).abs();
    if covered < 2.0 * period_deg || (count as f64) < 4.0 * covered / period_deg {
        return Err(NonlinearityError::TooLittle);
    }
    let errors: Vec<f64> = measured.iter().zip(reference).map(|(measured, reference)| measured - reference).collect();
    let curve = split(&errors, reference, period_deg, direction);
    let half_range = |part: fn(&Deviation) -> f64| {
        let ends = curve
            .iter()
            .map(part)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        (ends.1 - ends.0) / 2.0
    };
    Ok(Nonlinearity {
        differential_deg: half_range(|deviation| deviation.differential_deg),
        integral_deg: half_range(|deviation| deviation.integral_deg),
        revolutions: covered / 360.0,
        curve,
    })
}

/// Splits the error into its two parts at each sample with half a period on either side. The mean over the period is
/// that of the straight lines between samples, so it does not depend on where the samples are in the period.
fn split(errors: &[f64], reference: &[f64], period_deg: f64, direction: f64) -> Vec<Deviation> {
    let start = reference.first().copied().unwrap_or(0.0);
    // Angles from the start, increasing in either direction of rotation.
    let place = |index: usize| reference.get(index).map(|angle| (angle - start) * direction);
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let error = |index: usize| errors.get(index).copied().unwrap_or(0.0) - mean;
    let mut areas = Vec::with_capacity(errors.len());
    let mut area = 0.0;
    for index in 0..errors.len() {
        if let (Some(before), Some(here)) = (index.checked_sub(1).and_then(place), place(index)) {
            area += (here - before) * (error(index - 1) + error(index)) / 2.0;
        }
        areas.push(area);
    }
    let end = place(errors.len().saturating_sub(1)).unwrap_or(0.0);
    // Area up to an angle. `from` advances with the angle.
    let area_to = |angle: f64, from: &mut usize| {
        while place(*from + 1).is_some_and(|next| next <= angle) {
            *from += 1;
        }
        let (here, next) = (place(*from).unwrap_or(0.0), place(*from + 1).unwrap_or(end));
        let share = if next > here { (angle - here) / (next - here) } else { 0.0 };
        let height = error(*from) + (error(*from + 1) - error(*from)) * share / 2.0;
        areas.get(*from).copied().unwrap_or(0.0) + (angle - here) * height
    };
    let (mut low, mut high) = (0, 0);
    let mut curve = Vec::new();
    for (index, angle) in reference.iter().enumerate() {
        let here = (angle - start) * direction;
        let (from, to) = (here - period_deg / 2.0, here + period_deg / 2.0);
        if from < 0.0 || to > end {
            continue;
        }
        let integral_deg = (area_to(to, &mut high) - area_to(from, &mut low)) / period_deg;
        curve.push(Deviation { reference_deg: *angle, differential_deg: error(index) - integral_deg, integral_deg });
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Returns a reference over `revolutions`, and a measurement with an eccentricity of 0.02° and a period error of
    /// 0.003°.
    fn measured(count: usize, revolutions: f64, periods: f64) -> (Vec<f64>, Vec<f64>) {
        (0..count)
            .map(|at| {
                let turn = revolutions * at as f64 / count as f64;
                let error = 0.02 * (TAU * turn).sin() + 0.003 * (TAU * periods * turn + 0.4).cos();
                (turn * 360.0 + 17.0 + error, turn * 360.0)
            })
            .unzip()
    }

    #[test]
    fn separates_integral_and_differential_parts() {
        let (values, reference) = measured(40_000, 1.1, 128.0);
        let back = |values: &[f64]| values.iter().map(|value| -value).collect::<Vec<_>>();
        for (values, reference) in [(values.clone(), reference.clone()), (back(&values), back(&reference))] {
            let told = compute_nonlinearity(&values, &reference, 128).unwrap();
            // The mean over 1/128 revolution reduces a sine of one revolution by only 1e-4 of its amplitude.
            assert!((told.integral_deg - 0.02).abs() < 5e-6, "{}", told.integral_deg);
            assert!((told.differential_deg - 0.003).abs() < 5e-6, "{}", told.differential_deg);
            assert!((told.revolutions - 1.1).abs() < 1e-3);
        }
    }

    #[test]
    fn accepts_fractional_samples_per_period() {
        let (values, reference) = measured(1111, 1.0, 16.0);
        let told = compute_nonlinearity(&values, &reference, 16).unwrap();
        // The mean over 1/16 revolution removes (π/16)²/6 of a sine of one revolution, which is added to the
        // differential part.
        let leaked = 0.02 * (TAU / 32.0).powi(2) / 6.0;
        assert!((told.differential_deg - leaked - 0.003).abs() < 3e-5, "{}", told.differential_deg);
        assert!((told.integral_deg / 0.02 - 1.0).abs() < 0.02, "{}", told.integral_deg);
    }

    #[test]
    fn rejects_insufficient_data() {
        let (values, mut reference) = measured(1000, 1.0, 16.0);
        assert_eq!(compute_nonlinearity(&values[..100], &reference[..100], 16), Err(NonlinearityError::TooLittle));
        assert_eq!(compute_nonlinearity(&values, &reference, 512), Err(NonlinearityError::TooLittle));
        assert_eq!(compute_nonlinearity(&values, &reference, 0), Err(NonlinearityError::NotFinite));
        assert_eq!(compute_nonlinearity(&[], &[], 16), Err(NonlinearityError::TooLittle));
        reference[500] = reference[499];
        assert_eq!(compute_nonlinearity(&values, &reference, 16), Err(NonlinearityError::NotMonotonic { index: 500 }));
        reference[500] = f64::NAN;
        assert_eq!(compute_nonlinearity(&values, &reference, 16), Err(NonlinearityError::NotFinite));
    }
}
