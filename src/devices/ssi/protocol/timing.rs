//! Timing limits of a transfer: burst duration, reading rate, and age of a position (SICK SSI description 2.2, 2.7, 2.8
//! and the section of each family; reference sections 1 and 5).

#[cfg(test)]
mod tests;

use std::time::Duration;

use serde::Deserialize;

/// A family's times, in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Times {
    /// tm: how long the data line stays low after the last clock, least and most. For this time the value is kept.
    pub monoflop: (f64, f64),
    /// Highest clock, in hertz.
    pub most_hz: u32,
    /// Times of asynchronous operation, if positions are made independently of transfers; none: not known.
    #[serde(default)]
    pub asynchronous: Option<Asynchronous>,
    /// Positions are made when the host clocks.
    #[serde(default)]
    pub synchronous: Option<Synchronous>,
    /// Both, if the number of steps is no power of two.
    #[serde(default)]
    pub any_steps: Option<AnySteps>,
}

/// Positions are made on their own.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asynchronous {
    /// Time from one position to the next.
    pub update: f64,
    /// Least age of a position when it is read.
    #[serde(default)]
    pub least_age: f64,
    /// The longest pause between bursts.
    #[serde(default)]
    pub most_pause: Option<f64>,
    /// Variation of the pauses, in percent.
    #[serde(default)]
    pub pause_varies: Option<f64>,
}

/// Positions are made when the host clocks.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Synchronous {
    /// The moment at which a position is taken.
    pub taken: Taken,
    /// tm in this mode.
    #[serde(default)]
    pub monoflop: Option<f64>,
    /// The shortest pause.
    pub least_pause: f64,
    /// Highest clock in this mode, in hertz.
    #[serde(default)]
    pub most_hz: Option<u32>,
}

/// The moment at which a position is taken in synchronous mode.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Taken {
    /// This long after the last clock, and ready this long after that.
    Behind {
        /// Time from the last clock.
        starts: f64,
        /// Time from the start.
        ready: f64,
    },
    /// With the first falling edge; it is sent with the burst after that.
    FirstEdge,
}

/// Times that are longer if the number of steps is not a power of two.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnySteps {
    /// Asynchronous: time from one position to the next.
    pub update: f64,
    /// Synchronous: tm and the shortest pause.
    pub monoflop: f64,
}

/// The timing of reading frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reads {
    /// Bits of a burst.
    pub clocks: u8,
    /// Clock in hertz.
    pub clock_hz: f64,
    /// Time from the last clock of a burst to the first of the next.
    pub pause: Duration,
    /// Cable in metres.
    pub cable_metres: Option<f64>,
    /// Positions are made when the host clocks.
    pub synchronous: bool,
    /// The number of steps is no power of two.
    pub any_steps: bool,
}

/// The resulting times.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// A clock.
    pub period: Duration,
    /// Duration of all clocks of a burst.
    pub burst: Duration,
    /// Time from burst to burst.
    pub cycle: Duration,
    /// tm, least and most.
    pub monoflop: (Duration, Duration),
    /// The shortest pause that is safe.
    pub least_pause: Duration,
    /// Bursts a second with the shortest pause.
    pub most_reads_hz: f64,
    /// Least and greatest age of a position when its last bit has arrived; `None` if not known.
    pub age: Option<(Duration, Duration)>,
    /// The highest clock for this cable, in hertz; `None`: longer than any cable in the manual.
    pub cable_hz: Option<u32>,
    /// The violated limits.
    pub warnings: Vec<Warning>,
}

/// A violated limit, with both values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Warning {
    /// The encoder does not bear this clock.
    EncoderClock {
        /// Highest, in hertz.
        most_hz: u32,
    },
    /// This cable does not bear this clock.
    CableClock {
        /// Highest, in hertz.
        most_hz: u32,
    },
    /// The manual has no cable of this length.
    CableLong,
    /// A clock level lasts longer than tm: the encoder takes that for the end of the burst.
    ClockSlow {
        /// Lowest clock, in hertz.
        least_hz: f64,
    },
    /// The pause is shorter than the encoder needs: bits of the old position continue, or it is not ready.
    PauseShort {
        /// Shortest.
        least: Duration,
    },
    /// The pause is longer than the encoder bears.
    PauseLong {
        /// Longest.
        most: Duration,
    },
    /// Reading is faster than positions are made: the same position is repeated, and the host has to accept that.
    Repeats {
        /// Time from one position to the next.
        update: Duration,
    },
    /// The family has no synchronous mode.
    NoSynchronous,
    /// The encoder belongs to no family, so it is not known whether it has a synchronous mode.
    SynchronousUnknown,
}

/// The manual's table of cables (2.7): length below this number of metres, highest clock in hertz.
const CABLES: [(f64, u32); 4] = [(50.0, 400_000), (100.0, 300_000), (200.0, 200_000), (400.0, 100_000)];

impl Times {
    /// What the manual says of SSI as such (SICK SSI description 2.2; reference section 1), for an encoder of no family. How
    /// often it makes positions is not known.
    pub const GENERAL: Self =
        Times { monoflop: (15.0, 25.0), most_hz: 2_000_000, asynchronous: None, synchronous: None, any_steps: None };

    /// Calculates the times of reading an encoder of no family.
    pub fn of_any_encoder(reads: &Reads) -> Timing {
        let mut timing = Self::GENERAL.reckon(reads);
        for warning in timing.warnings.iter_mut().filter(|own| **own == Warning::NoSynchronous) {
            *warning = Warning::SynchronousUnknown;
        }
        timing
    }

    /// Calculates the times of reading like this.
    pub fn reckon(&self, reads: &Reads) -> Timing {
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
        let least_pause = micros(least);
        let cycle = burst + reads.pause;

        let most_hz = synchronous.and_then(|mode| mode.most_hz).unwrap_or(self.most_hz);
        if clock > f64::from(most_hz) {
            warnings.push(Warning::EncoderClock { most_hz });
        }
        let cable_hz = match reads.cable_metres {
            None => Some(most_hz),
            Some(length) => CABLES.iter().find(|(shorter, _)| length < *shorter).map(|(_, hz)| *hz),
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
            (Some(mode), _) => Some(mode.age(burst, reads.pause)),
            (None, Some(mode)) => {
                let update = micros(slower.map_or(mode.update, |slower| slower.update));
                if let Some(most) = mode.most_pause.map(micros).filter(|most| reads.pause > *most) {
                    warnings.push(Warning::PauseLong { most });
                }
                if cycle < update {
                    warnings.push(Warning::Repeats { update });
                }
                Some((micros(mode.least_age) + burst, update + burst))
            }
            (None, None) => None,
        };
        Timing {
            period,
            burst,
            cycle,
            monoflop: (micros(shortest_monoflop), micros(monoflop)),
            least_pause,
            most_reads_hz: 1.0 / (burst + least_pause).as_secs_f64(),
            age,
            cable_hz,
            warnings,
        }
    }
}

impl Synchronous {
    /// Returns the age, which varies only if the pause does.
    fn age(&self, burst: Duration, pause: Duration) -> (Duration, Duration) {
        let age = match self.taken {
            Taken::Behind { starts, .. } => pause.saturating_sub(micros(starts)) + burst,
            Taken::FirstEdge => burst + pause + burst,
        };
        (age, age)
    }
}

fn micros(micros: f64) -> Duration {
    Duration::from_secs_f64((micros * 1e-6).clamp(0.0, 3600.0))
}
