//! Timing limits of a transfer: duration of a burst, reading rate, and age of a position. See SICK SSI description 2.2,
//! 2.7, 2.8 and the section of each family, and reference sections 1 and 5.

#[cfg(test)]
mod tests;

use std::time::Duration;

use serde::Deserialize;

/// Timing of an encoder family. Times are in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Times {
    /// Minimum and maximum monoflop time tm, for which the data line stays low after the last clock and the encoder
    /// holds the value.
    pub monoflop: (f64, f64),
    /// Maximum clock frequency in hertz.
    pub most_hz: u32,
    /// Times in asynchronous operation, or `None` if they are unknown.
    #[serde(default)]
    pub asynchronous: Option<AsynchronousTimes>,
    /// Times in synchronous operation, or `None` if the family does not support it.
    #[serde(default)]
    pub synchronous: Option<SynchronousTimes>,
    /// Times for a number of steps that is not a power of two, if they differ.
    #[serde(default)]
    pub any_steps: Option<AnySteps>,
}

/// Times in asynchronous operation, in which the encoder samples positions independently of the transfers.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AsynchronousTimes {
    /// Interval between two positions, in microseconds.
    pub update: f64,
    /// Minimum age of a position at the time of reading, in microseconds.
    #[serde(default)]
    pub least_age: f64,
    /// Maximum pause between bursts in microseconds, if there is a limit.
    #[serde(default)]
    pub most_pause: Option<f64>,
    /// Allowed variation of the pauses in percent, or `None` if not specified.
    #[serde(default)]
    pub pause_varies: Option<f64>,
}

/// Times in synchronous operation, in which the host's clock triggers the sampling of a position.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SynchronousTimes {
    /// Moment at which a position is sampled.
    pub taken: SamplingMoment,
    /// Monoflop time tm in this mode in microseconds, if it differs.
    #[serde(default)]
    pub monoflop: Option<f64>,
    /// Minimum pause between bursts in microseconds.
    pub least_pause: f64,
    /// Maximum clock frequency in this mode in hertz, if it differs.
    #[serde(default)]
    pub most_hz: Option<u32>,
}

/// The moment at which the position is sampled in synchronous mode.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SamplingMoment {
    /// The position is sampled a certain time after the last clock.
    Behind {
        /// Time from the last clock until the encoder starts to sample the position, in microseconds.
        starts: f64,
        /// Time from the start of sampling until the position is ready, in microseconds.
        ready: f64,
    },
    /// The position is sampled at the first falling edge, and is sent in the next burst.
    FirstEdge,
}

/// Times for a number of steps that is not a power of two. They are longer than the usual times.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnySteps {
    /// Interval between two positions in asynchronous mode, in microseconds.
    pub update: f64,
    /// Monoflop time tm and minimum pause in synchronous mode, in microseconds.
    pub monoflop: f64,
}

/// Conditions under which a host reads frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadConditions {
    /// Number of bits in a burst.
    pub clocks: u8,
    /// Clock frequency in hertz.
    pub clock_hz: f64,
    /// Pause from the last clock of a burst to the first clock of the next one.
    pub pause: Duration,
    /// Cable length in metres, or `None` if unknown.
    pub cable_metres: Option<f64>,
    /// Whether the encoder is in synchronous mode.
    pub synchronous: bool,
    /// Whether the number of steps is not a power of two.
    pub any_steps: bool,
}

/// Times and violated limits under certain read conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// Duration of one clock period.
    pub period: Duration,
    /// Total duration of the clocks in a burst.
    pub burst: Duration,
    /// Time from the start of one burst to the start of the next.
    pub cycle: Duration,
    /// Minimum and maximum monoflop time tm.
    pub monoflop: (Duration, Duration),
    /// Lower limit of the pause between bursts. The pause must be longer.
    pub least_pause: Duration,
    /// Number of bursts per second at the shortest pause.
    pub most_reads_hz: f64,
    /// Minimum and maximum age of a position when its last bit arrives, or `None` if unknown.
    pub age: Option<(Duration, Duration)>,
    /// Maximum clock frequency for this cable in hertz, or `None` if the manual lists no cable of this length.
    pub cable_hz: Option<u32>,
    /// Timing limits that are violated.
    pub warnings: Vec<Warning>,
}

/// A violated timing limit with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// The clock is too fast for the encoder.
    EncoderClock {
        /// Maximum clock frequency in hertz.
        most_hz: u32,
    },
    /// The clock is too fast for the cable length.
    CableClock {
        /// Maximum clock frequency in hertz.
        most_hz: u32,
    },
    /// The cable is longer than any listed in the manual.
    CableLong,
    /// A clock level lasts longer than tm, so the encoder considers the burst complete.
    ClockSlow {
        /// Minimum clock frequency in hertz.
        least_hz: f64,
    },
    /// The pause is shorter than the encoder requires, so the encoder sends the old position or is not ready.
    PauseShort {
        /// Minimum pause that the encoder requires.
        least: Duration,
    },
    /// The pause is longer than the encoder allows.
    PauseLong {
        /// Maximum pause that the encoder allows.
        most: Duration,
    },
    /// Frames are read faster than the encoder samples positions, so some positions are read several times.
    Repeats {
        /// Interval at which the encoder samples positions.
        update: Duration,
    },
    /// The encoder family has no synchronous mode.
    NoSynchronous,
    /// It is unknown whether the encoder has a synchronous mode, because its family is unknown.
    SynchronousUnknown,
}

/// Cable lengths in metres, each with the maximum clock frequency in hertz up to this length. See the manual, 2.7.
const CABLE_CLOCK_LIMITS: [(f64, u32); 4] = [(50.0, 400_000), (100.0, 300_000), (200.0, 200_000), (400.0, 100_000)];

impl Times {
    /// Timing limits of SSI in general, for an encoder without a family. The interval between positions is unknown. See
    /// SICK SSI description 2.2 and reference section 1.
    pub const GENERAL_LIMITS: Self =
        Times { monoflop: (15.0, 25.0), most_hz: 2_000_000, asynchronous: None, synchronous: None, any_steps: None };

    /// Calculates the times for reading an encoder of an unknown family.
    pub fn for_any_encoder(reads: &ReadConditions) -> Timing {
        let mut timing = Self::GENERAL_LIMITS.calculate_timing(reads);
        for warning in timing.warnings.iter_mut().filter(|own| **own == Warning::NoSynchronous) {
            *warning = Warning::SynchronousUnknown;
        }
        timing
    }

    /// Calculates the times for reading this encoder family under the given conditions.
    pub fn calculate_timing(&self, reads: &ReadConditions) -> Timing {
        let mut warnings = Vec::new();
        let clock = reads.clock_hz.max(1.0);
        let period = Duration::from_secs_f64(1.0 / clock);
        let burst = Duration::from_secs_f64(f64::from(reads.clocks) / clock);
        let synchronous = self.synchronous.filter(|_| reads.synchronous);
        if reads.synchronous && synchronous.is_none() {
            warnings.push(Warning::NoSynchronous);
        }
        let slower = self.any_steps.filter(|_| reads.any_steps);
        let monoflop = match (synchronous, slower) {
            (Some(_), Some(slower)) => slower.monoflop,
            (Some(mode), None) => mode.monoflop.unwrap_or(self.monoflop.1),
            (None, _) => self.monoflop.1,
        };
        let least = synchronous.map_or(monoflop, |mode| mode.least_pause.max(monoflop));
        let least_pause = from_micros(least);
        let cycle = burst + reads.pause;

        let most_hz = synchronous.and_then(|mode| mode.most_hz).unwrap_or(self.most_hz);
        if clock > f64::from(most_hz) {
            warnings.push(Warning::EncoderClock { most_hz });
        }
        let cable_hz = match reads.cable_metres {
            None => Some(most_hz),
            Some(length) => CABLE_CLOCK_LIMITS.iter().find(|(shorter, _)| length < *shorter).map(|(_, hz)| *hz),
        };
        match cable_hz {
            None => warnings.push(Warning::CableLong),
            Some(most_hz) if reads.cable_metres.is_some() && clock > f64::from(most_hz) => {
                warnings.push(Warning::CableClock { most_hz });
            }
            Some(_) => {}
        }
        let shortest_monoflop = if synchronous.is_some() { monoflop } else { self.monoflop.0 };
        let least_hz = 0.5e6 / shortest_monoflop.max(1e-3);
        if clock < least_hz {
            warnings.push(Warning::ClockSlow { least_hz });
        }
        if reads.pause <= least_pause {
            warnings.push(Warning::PauseShort { least: least_pause });
        }
        let age = match (synchronous, self.asynchronous) {
            (Some(mode), _) => Some(mode.position_age(burst, reads.pause)),
            (None, Some(mode)) => {
                let update = from_micros(slower.map_or(mode.update, |slower| slower.update));
                if let Some(most) = mode.most_pause.map(from_micros).filter(|most| reads.pause > *most) {
                    warnings.push(Warning::PauseLong { most });
                }
                if cycle < update {
                    warnings.push(Warning::Repeats { update });
                }
                Some((from_micros(mode.least_age) + burst, update + burst))
            }
            (None, None) => None,
        };
        Timing {
            period,
            burst,
            cycle,
            monoflop: (from_micros(shortest_monoflop), from_micros(monoflop)),
            least_pause,
            most_reads_hz: 1.0 / (burst + least_pause).as_secs_f64(),
            age,
            cable_hz,
            warnings,
        }
    }
}

impl SynchronousTimes {
    /// Returns the minimum and maximum age of a position. They are equal, because the pause is assumed to be constant.
    fn position_age(&self, burst: Duration, pause: Duration) -> (Duration, Duration) {
        let age = match self.taken {
            SamplingMoment::Behind { starts, .. } => pause.saturating_sub(from_micros(starts)) + burst,
            SamplingMoment::FirstEdge => burst + pause + burst,
        };
        (age, age)
    }
}

fn from_micros(micros: f64) -> Duration {
    Duration::from_secs_f64((micros * 1e-6).clamp(0.0, 3600.0))
}
