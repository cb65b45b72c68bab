//! The possible findings in a signal, with their amounts.

use super::OutOfLimits;
use crate::analysis::ellipse::Channel;
use crate::analysis::wiring::Wire;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Notice,
    /// Out of its limits, or a disturbance that reduces accuracy.
    Warning,
    Fault,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagnosisFinding {
    pub severity: Severity,
    pub kind: FindingKind,
}

/// Kind of finding. Shares are of the amplitude of the cosine channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FindingKind {
    Limit(OutOfLimits),
    Still,
    /// Both channels are constant, away from zero: the shaft stands still.
    AtRest,
    /// One channel does not move while the other does.
    Dead {
        channel: Channel,
        stuck: Stuck,
    },
    /// One channel has half of the other's amplitude: one of its two wires is open.
    Half {
        channel: Channel,
        /// Ratio of its amplitude to the other's.
        share: f64,
    },
    /// Both channels show the same, or one the opposite of the other.
    Same,
    /// The mean level of a reference is outside of the family's limits.
    Level {
        wire: Wire,
        /// Its mean in volts.
        volts: f64,
        /// Good from, good to, in volts.
        ok_v: (f64, f64),
    },
    Hum {
        /// 50 or 60 Hz.
        mains_hz: f64,
        /// All of its lines together, peak, in volts.
        volts: f64,
        share: f64,
        /// In phase and about equally strong in both channels: coupled in by the screen or the ground.
        common: bool,
    },
    /// A line that is no harmonic of the signal.
    Interference {
        /// Its frequency in hertz.
        frequency_hz: f64,
        /// Peak in the stronger channel, in volts.
        volts: f64,
        share: f64,
        /// As for the hum.
        common: bool,
    },
    Noise {
        /// Of one channel, rms, in volts.
        volts: f64,
        share: f64,
    },
    /// The distance from the ellipse repeats this many times per period: harmonics one below and one above that.
    Harmonics {
        /// Order, 3 to 8.
        order: usize,
        /// As a share, peak; also the resulting error in radians.
        share: f64,
    },
    Clipping {
        channel: Channel,
        /// Level in volts.
        volts: f64,
        /// Share of the samples at that level.
        samples: f64,
    },
    Modulation {
        /// Half of the difference between largest and least, over the mean.
        share: f64,
    },
    /// Single samples far off were left out.
    Spikes {
        count: usize,
        /// The farthest, in volts off the ellipse.
        volts: f64,
    },
    /// Several samples in a row were far off and left out.
    LetsGo {
        count: usize,
        /// The most in a row.
        longest: usize,
    },
    Missing {
        gaps: usize,
        /// The longest time from one sample to the next, in seconds.
        longest_s: f64,
    },
    TimeBack {
        /// The first sample that is before the one before it, counted from 0.
        sample: usize,
    },
    Reversed {
        times: usize,
    },
    /// Too few samples per period to follow the angle with certainty.
    Coarse {
        /// Median angle from one sample to the next, in degrees.
        step_deg: f64,
    },
    /// Hum, interference or harmonics make offset, gain and phase uncertain.
    Uncertain {
        /// All of them together, as a share.
        share: f64,
    },
    /// The position error after the correction is larger than before.
    CorrectionHarms {
        /// Both channels are at the level of a single wire: no reference was subtracted.
        raw_deg: f64,
        /// And after.
        corrected_deg: f64,
    },
    /// Of two captures, the second has more noise.
    SingleEnded {
        /// Mean of the sine channel in volts.
        sine_v: f64,
        cosine_v: f64,
    },
    /// Of two captures, the second has more noise.
    NoiseRose {
        /// First, rms, in volts.
        from_v: f64,
        /// Second.
        to_v: f64,
    },
    /// Of two captures, only the second has this interference, or has more of it.
    InterferenceRose {
        /// Its frequency in hertz.
        frequency_hz: f64,
        /// In the first, peak, in volts; 0 if none was visible.
        from_v: f64,
        /// Second.
        to_v: f64,
        /// In the second, as for the hum.
        common: bool,
    },
    /// Of two captures, the second has another amplitude.
    AmplitudeChanged {
        /// First, peak, in volts.
        from_v: f64,
        /// Second.
        to_v: f64,
    },
}

/// The level of the wires of a channel that does not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stuck {
    /// Both at the same level: one is open, or they are shorted to each other.
    Together,
    Ground(Wire),
    Supply(Wire),
    /// This many volts apart: one of them is shorted, or open without a resistor between them.
    Apart(f64),
}
