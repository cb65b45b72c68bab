//! The possible findings in a signal, with their amounts.

use super::OutOfLimits;
use crate::analysis::ellipse::Channel;
use crate::analysis::wiring::Wire;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Good to know; the signal is usable.
    Notice,
    /// Outside of its limits, or a disturbance that costs accuracy.
    Warning,
    /// The position is wrong or will be.
    Fault,
}

/// Something to look at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagnosisFinding {
    pub severity: Severity,
    pub kind: FindingKind,
}

/// A kind of finding. Shares are of the amplitude of the cosine channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FindingKind {
    /// A parameter outside of the family's limits.
    Limit(OutOfLimits),
    /// Neither channel moves.
    Still,
    /// Both channels stay where they are, away from zero: the shaft stands.
    AtRest,
    /// One channel does not move while the other does.
    Dead {
        channel: Channel,
        /// Level of its wires.
        stuck: Stuck,
    },
    /// One channel has half of the other's amplitude: one of its two wires is open.
    Half {
        channel: Channel,
        /// Its amplitude over the other's.
        share: f64,
    },
    /// Both channels show the same, or one the opposite of the other.
    Same,
    /// The mean level of a reference is outside of the family's limits.
    Level {
        /// REFSIN or REFCOS.
        wire: Wire,
        /// Its mean in volts.
        volts: f64,
        /// Good from, good to, in volts.
        ok_v: (f64, f64),
    },
    /// The mains and its multiples.
    Hum {
        /// 50 or 60 Hz.
        mains_hz: f64,
        /// All of its lines together, peak, in volts.
        volts: f64,
        share: f64,
        /// In phase and about equally strong in both channels: it comes in by the screen or the ground.
        common: bool,
    },
    /// A line that is no harmonic of the signal.
    Interference {
        /// Its frequency in hertz.
        frequency_hz: f64,
        /// Peak in the channel that has more of it, in volts.
        volts: f64,
        share: f64,
        /// As of the hum.
        common: bool,
    },
    /// White noise.
    Noise {
        /// Of one channel, rms, in volts.
        volts: f64,
        share: f64,
    },
    /// The distance from the ellipse repeats so many times a period: harmonics one below and one above that.
    Harmonics {
        /// Order, 3 to 8.
        order: usize,
        /// As a share, peak; so many radians are what it costs.
        share: f64,
    },
    /// A channel is cut off.
    Clipping {
        channel: Channel,
        /// Level in volts.
        volts: f64,
        /// Share of the samples that stand there.
        samples: f64,
    },
    /// The amplitude changes over a revolution.
    Modulation {
        /// Half of the difference between largest and least, over the mean.
        share: f64,
    },
    /// Single samples far off were left out.
    Spikes {
        /// Number of samples.
        count: usize,
        /// The farthest, in volts off the ellipse.
        volts: f64,
    },
    /// Several samples in a row were far off and left out.
    LetsGo {
        /// Total number.
        count: usize,
        /// The most in a row.
        longest: usize,
    },
    /// Samples are missing.
    Missing {
        /// In how many places.
        gaps: usize,
        /// The longest time from one sample to the next, in seconds.
        longest_s: f64,
    },
    /// The time goes back.
    TimeBack {
        /// The first sample that is before the one before it, counted from 0.
        sample: usize,
    },
    /// The shaft turned back.
    Reversed {
        /// Number of times.
        times: usize,
    },
    /// So few samples a period that the angle cannot be followed for certain.
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
        /// Peak to peak before, in electrical degrees.
        raw_deg: f64,
        /// And after.
        corrected_deg: f64,
    },
    /// Both channels lie at the level of a single wire: no reference was taken off.
    SingleEnded {
        /// Mean of the sine channel in volts.
        sine_v: f64,
        /// And of the cosine channel.
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
        /// First, peak, in volts; 0 where there was none to be seen.
        from_v: f64,
        /// Second.
        to_v: f64,
        /// In the second, as of the hum.
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
    /// This many volts apart: one of them is shorted, or open where no resistor joins them.
    Apart(f64),
}
