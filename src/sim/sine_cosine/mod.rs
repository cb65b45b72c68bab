//! A virtual analogue source with the four wires of a sine/cosine encoder, which turns at a given speed and has
//! adjustable errors. It is deterministic: the same settings, changes and sample numbers yield the same voltages,
//! whatever the block sizes. This module does not use clocks, threads or devices.
//!
//! The model is from Heydemann (Applied Optics 20, 3382). See section 7 of the project's sine/cosine reference. With θ
//! as the true angle, the cosine channel is R·cos θ + p, and the sine channel is R·sin(θ − α)/r + q. Both tracks have
//! the same shape a quarter of a period apart, so a third harmonic h results in cos θ − h·cos 3θ and sin θ + h·sin 3θ.
//!
//! Angles are integer fractions of a turn, and times are whole nanoseconds, so no error accumulates over time.
//!
//! The following assumptions have no source in a manual. At a receiver with a resistor between the wires of a pair, an
//! open wire takes the voltage of the other wire, and their difference is zero. Without the resistor, it stays at the
//! mean level, at which the bias of the receiver holds it. Interference and hum are added to SIN and COS but not to
//! their references, because a receiver rejects the part common to both. The interference is half as strong in the
//! cosine channel and has the opposite sign there.

mod settings;

use std::collections::VecDeque;
use std::f64::consts::TAU;

pub use settings::{CheckedSettings, Quantity, ReferenceLevel, SettingError, Settings};

use crate::analysis::SampleTime;
use crate::analysis::wiring::{Wire, Wires};

/// Number of angle units per turn. At 0.001 rev/min, the shaft turns by one unit per nanosecond.
const TURN: u64 = 60_000 * 1_000_000_000;
/// Number of phase units per interference period. At 0.001 Hz, the phase advances by one unit per nanosecond.
const CYCLE: u64 = 1_000 * 1_000_000_000;
/// Maximum number of stored changes to the settings.
const MAX_CHANGES: usize = 64;

/// A virtual analogue source, whose samples are numbered from 0.
#[derive(Clone, Debug)]
pub struct Source {
    start: SampleTime,
    /// Segments with constant settings in chronological order, never empty.
    segments: VecDeque<Segment>,
}

#[derive(Clone, Debug)]
struct Segment {
    from: u64,
    /// Time in nanoseconds from the start to the first sample of the segment.
    elapsed: u64,
    /// Shaft position at the first sample of the segment, in units of 1/`TURN` turn.
    turn: u64,
    checked: CheckedSettings,
}

impl Source {
    /// Creates a source. Its first sample is taken at `start`, at angle 0.
    pub fn new(checked: CheckedSettings, start: SampleTime) -> Self {
        Source { start, segments: VecDeque::from([Segment { from: 0, elapsed: 0, turn: 0, checked }]) }
    }

    /// Changes the settings from sample `at` on. The shaft continues from its position. A change that is not later than
    /// the latest one replaces it.
    pub fn change_settings(&mut self, at: u64, checked: CheckedSettings) {
        let at = self.segments.back().map_or(at, |last| at.max(last.from));
        let Some(before) = self.segments.back() else { return };
        let segment = Segment { from: at, elapsed: before.elapsed_at(at), turn: before.turn_at(at), checked };
        if before.from == at {
            self.segments.pop_back();
        } else if self.segments.len() == MAX_CHANGES {
            self.segments.pop_front();
        }
        self.segments.push_back(segment);
    }

    /// Returns the settings after the latest change.
    pub fn settings(&self) -> Option<&Settings> {
        self.segments.back().map(|segment| segment.checked.settings())
    }

    /// Returns the time of a sample, or `None` if its settings are no longer stored.
    pub fn time(&self, index: u64) -> Option<SampleTime> {
        let segment = self.segment_at(index)?;
        Some(self.start.saturating_add_ns(i64::try_from(segment.elapsed_at(index)).unwrap_or(i64::MAX)))
    }

    /// Returns `count` samples starting at `first`, or `None` if their settings are no longer stored. The latest 64
    /// changes are stored.
    pub fn samples_from(&self, first: u64, count: usize) -> Option<Wires> {
        let column = || Vec::with_capacity(count.min(1 << 20));
        let mut wires =
            Wires { sin_v: column(), refsin_v: column(), cos_v: column(), refcos_v: column(), reference_deg: column() };
        let end = first.saturating_add(count as u64);
        let mut next = first;
        while next < end {
            let segment = self.segment_at(next)?;
            let follower = self.segments.iter().map(|segment| segment.from).find(|from| *from > next);
            let until = follower.map_or(end, |from| from.min(end));
            segment.append(next, until - next, &mut wires);
            next = until;
        }
        Some(wires)
    }

    fn segment_at(&self, index: u64) -> Option<&Segment> {
        self.segments.iter().rev().find(|segment| segment.from <= index)
    }
}

impl Segment {
    fn period(&self) -> u64 {
        self.checked.settings().period_ns().unsigned_abs()
    }

    fn elapsed_at(&self, index: u64) -> u64 {
        self.elapsed.saturating_add(index.saturating_sub(self.from).saturating_mul(self.period()))
    }

    /// Returns the rotation between consecutive samples modulo one turn, in units of 1/`TURN` turn.
    fn phase_step(&self) -> u64 {
        let speed = (self.checked.settings().speed_rpm * 1_000.0).round() as i128;
        modulo(speed * i128::from(self.period()), TURN)
    }

    fn turn_at(&self, index: u64) -> u64 {
        let samples = i128::from(index.saturating_sub(self.from));
        modulo(i128::from(self.turn) + samples * i128::from(self.phase_step()), TURN)
    }

    /// Appends `count` samples starting at `first`.
    fn append(&self, first: u64, count: u64, wires: &mut Wires) {
        let settings = self.checked.settings();
        let model = Model::from_settings(settings);
        let elapsed = i128::from(self.elapsed_at(first));
        let line = |hertz: f64| {
            let millihertz = (hertz * 1_000.0).round() as i128;
            let (now, step) = (elapsed * millihertz, i128::from(self.period()) * millihertz);
            PhaseAccumulator { at: modulo(now, CYCLE), step: modulo(step, CYCLE), whole: CYCLE }
        };
        let mut shaft = PhaseAccumulator { at: self.turn_at(first), step: self.phase_step(), whole: TURN };
        let (mut interference, mut hum) = (line(settings.interference_hz), line(settings.hum_hz));
        for index in first..first + count {
            let common = settings.hum_v * hum.angle_radians().sin();
            let disturbed = settings.interference_v * interference.angle_radians().sin();
            let (sine, cosine) = model.channel_voltages(shaft);
            let [sin, refsin, cos, refcos] =
                model.wire_voltages(index, [sine + common + disturbed, cosine + common - disturbed / 2.0]);
            wires.sin_v.push(sin);
            wires.refsin_v.push(refsin);
            wires.cos_v.push(cos);
            wires.refcos_v.push(refcos);
            wires.reference_deg.push(360.0 * shaft.turn_fraction());
            [&mut shaft, &mut interference, &mut hum].into_iter().for_each(PhaseAccumulator::advance);
        }
    }
}

/// A phase that advances in equal integer steps.
#[derive(Clone, Copy)]
struct PhaseAccumulator {
    at: u64,
    step: u64,
    whole: u64,
}

impl PhaseAccumulator {
    fn advance(&mut self) {
        self.at += self.step;
        self.at -= if self.at >= self.whole { self.whole } else { 0 };
    }

    /// Returns the position within the turn as a fraction, at least 0 and below 1.
    fn turn_fraction(self) -> f64 {
        self.at as f64 / self.whole as f64
    }

    fn angle_radians(self) -> f64 {
        TAU * self.turn_fraction()
    }
}

/// Settings converted to a form that is fast to calculate with.
struct Model<'a> {
    settings: &'a Settings,
    periods: u64,
    /// Amplitude in radians of the phase shift that the eccentricity causes in the signal.
    eccentricity: f64,
    phase_error: f64,
    third: f64,
    /// Noise of each wire. The difference between two wires then has the noise given in the settings.
    noise: f64,
}

impl<'a> Model<'a> {
    fn from_settings(settings: &'a Settings) -> Self {
        Model {
            settings,
            periods: settings.periods as u64,
            eccentricity: (settings.eccentricity_arcsec / 3_600.0).to_radians() * settings.periods,
            phase_error: settings.phase_error_deg.to_radians(),
            third: settings.third_harmonic_percent / 100.0,
            noise: settings.noise_v * std::f64::consts::FRAC_1_SQRT_2,
        }
    }

    /// Returns the sine and cosine channels in volts, without noise, interference and hum.
    fn channel_voltages(&self, shaft: PhaseAccumulator) -> (f64, f64) {
        let settings = self.settings;
        let (once_sine, once_cosine) = shaft.angle_radians().sin_cos();
        // The angle is still an integer when it is multiplied by the number of periods. 65 536 turns fit into 64 bits.
        let signal = PhaseAccumulator { at: shaft.at * self.periods % TURN, ..shaft };
        let angle = signal.angle_radians() + self.eccentricity * once_sine;
        let amplitude = settings.amplitude_v * (1.0 + settings.modulation_percent / 100.0 * once_cosine);
        let cosine = angle.cos() - self.third * (3.0 * angle).cos();
        let late = angle - self.phase_error;
        let sine = late.sin() + self.third * (3.0 * late).sin();
        (amplitude * sine / settings.gain_ratio + settings.offset_sine_v, amplitude * cosine + settings.offset_cosine_v)
    }

    /// Returns SIN, REFSIN, COS and REFCOS at the receiver for the given differential voltages.
    fn wire_voltages(&self, index: u64, [sine, cosine]: [f64; 2]) -> [f64; 4] {
        let level = self.settings.level_v;
        let pair = |difference: f64| match self.settings.references {
            ReferenceLevel::Level => (level + difference, level),
            ReferenceLevel::Complement => (level + difference / 2.0, level - difference / 2.0),
        };
        let ((mut sin, mut refsin), (mut cos, mut refcos)) = (pair(sine), pair(cosine));
        let hanging = |partner: f64| if self.settings.terminated { partner } else { level };
        match self.settings.open_wire {
            None => {}
            Some(Wire::Sin) => sin = hanging(refsin),
            Some(Wire::Refsin) => refsin = hanging(sin),
            Some(Wire::Cos) => cos = hanging(refcos),
            Some(Wire::Refcos) => refcos = hanging(cos),
        }
        if self.noise > 0.0 {
            let [a, b] = gaussian_pair(self.settings.seed, 2 * index);
            let [c, d] = gaussian_pair(self.settings.seed, 2 * index + 1);
            sin += self.noise * a;
            refsin += self.noise * b;
            cos += self.noise * c;
            refcos += self.noise * d;
        }
        [sin, refsin, cos, refcos]
    }
}

fn modulo(number: i128, whole: u64) -> u64 {
    // The remainder of a division by a 64-bit number fits into 64 bits.
    u64::try_from(number.rem_euclid(i128::from(whole))).unwrap_or(0)
}

/// Returns two independent, normally distributed numbers that depend only on `seed` and `place` (Box and Muller 1958).
fn gaussian_pair(seed: u64, place: u64) -> [f64; 2] {
    let first = splitmix64(seed ^ splitmix64(place));
    let second = splitmix64(first ^ seed);
    // Use 53 bits of each number. The first one must be above 0.
    let unit = |bits: u64| (bits >> 11) as f64 / (1_u64 << 53) as f64;
    let length = (-2.0 * (1.0 - unit(first)).ln()).sqrt();
    let (sine, cosine) = (TAU * unit(second)).sin_cos();
    [length * sine, length * cosine]
}

/// Returns a SplitMix64 hash (Steele, Lea, Flood 2014), which maps adjacent numbers to unrelated ones.
fn splitmix64(number: u64) -> u64 {
    let mixed = number.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ mixed >> 31
}

#[cfg(test)]
mod tests;
