//! Findings of a signal diagnosis, with their magnitudes.

use super::OutOfLimits;
use crate::analysis::ellipse::SignalChannel;
use crate::analysis::wiring::Wire;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Notice,
    /// A parameter is outside its limits, or a disturbance reduces accuracy.
    Warning,
    Fault,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagnosisFinding {
    pub severity: Severity,
    pub kind: FindingKind,
}

/// Kind of finding. Shares are fractions of the cosine channel's amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FindingKind {
    Limit(OutOfLimits),
    Still,
    /// Both channels are constant and nonzero, so the shaft is at rest.
    AtRest,
    /// One channel is constant while the other one changes.
    Dead {
        channel: SignalChannel,
        stuck: StuckLevel,
    },
    /// One channel has half the amplitude of the other, because one of its two wires is open.
    Half {
        channel: SignalChannel,
        /// Ratio of this channel's amplitude to that of the other channel.
        share: f64,
    },
    /// Both channels carry the same signal, or one carries the inverse of the other.
    Same,
    /// The mean level of a reference is outside the limits of the encoder family.
    Level {
        wire: Wire,
        /// Mean level in volts.
        volts: f64,
        /// Permitted range in volts.
        ok_v: (f64, f64),
    },
    Hum {
        mains_hz: f64,
        /// Combined peak of all mains lines, in volts.
        volts: f64,
        share: f64,
        /// Whether the hum is in phase and about equally strong in both channels, as if coupled in through the cable
        /// screen or the ground.
        common: bool,
    },
    /// The spectrum contains a line that is not a harmonic of the signal.
    Interference {
        frequency_hz: f64,
        /// Peak in the stronger channel, in volts.
        volts: f64,
        share: f64,
        /// Whether the line is in phase and about equally strong in both channels.
        common: bool,
    },
    Noise {
        /// RMS noise of one channel in volts.
        volts: f64,
        share: f64,
    },
    /// The signal deviates from the ellipse `order` times per period, because of harmonics of the orders one below and
    /// one above.
    Harmonics {
        /// Repetitions per period, 3 to 8.
        order: usize,
        /// Peak as a fraction of the amplitude. The resulting error in radians has the same value.
        share: f64,
    },
    Clipping {
        channel: SignalChannel,
        /// Clipping level in volts.
        volts: f64,
        /// Fraction of the samples at the clipping level.
        samples: f64,
    },
    Modulation {
        /// Half the difference between the maximum and minimum amplitude, as a fraction of the mean amplitude.
        share: f64,
    },
    /// The capture contains isolated outliers, which were left out of the fit.
    Spikes {
        count: usize,
        /// Greatest distance of an outlier from the ellipse, in volts.
        volts: f64,
    },
    IntermittentContact {
        count: usize,
        /// Length of the longest interruption in samples.
        longest: usize,
    },
    Missing {
        gaps: usize,
        /// Longest time between consecutive samples, in seconds.
        longest_s: f64,
    },
    TimeGoesBack {
        /// Index of the first sample that is earlier than its predecessor, counted from 0.
        sample: usize,
    },
    Reversed {
        times: usize,
    },
    /// The capture has too few samples per period for the angle to be followed reliably.
    Coarse {
        /// Median angle between consecutive samples, in degrees.
        step_deg: f64,
    },
    /// Hum, interference or harmonics make offset, gain and phase uncertain.
    Uncertain {
        /// Combined magnitude of the disturbances, as a fraction of the amplitude.
        share: f64,
    },
    HarmfulCorrection {
        /// Peak-to-peak position error before the correction, in electrical degrees.
        raw_deg: f64,
        /// Peak-to-peak position error after the correction, in electrical degrees.
        corrected_deg: f64,
    },
    /// Both channels have the mean level of a single wire, so no reference was subtracted.
    SingleEnded {
        /// Mean of the sine channel in volts.
        sine_v: f64,
        cosine_v: f64,
    },
    NoiseIncreased {
        /// RMS noise of the first capture in volts.
        from_v: f64,
        /// RMS noise of the second capture in volts.
        to_v: f64,
    },
    /// The interference at this frequency is stronger in the second capture, or is new.
    InterferenceIncreased {
        frequency_hz: f64,
        /// Peak in the first capture, in volts, or 0 if no interference was visible.
        from_v: f64,
        /// Peak in the second capture, in volts.
        to_v: f64,
        /// Whether the interference in the second capture is in phase and about equally strong in both channels.
        common: bool,
    },
    AmplitudeChanged {
        /// Peak amplitude in the first capture, in volts.
        from_v: f64,
        /// Peak amplitude in the second capture, in volts.
        to_v: f64,
    },
}

/// Voltage levels of the two wires of a constant channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StuckLevel {
    /// Both wires are at the same level, because one is open or they are shorted to each other.
    Together,
    Ground(Wire),
    Supply(Wire),
    /// The wires differ by this voltage. Either one is shorted, or one is open and no resistor joins the two.
    Apart(f64),
}
