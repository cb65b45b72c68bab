//! Simulated faults: noise on the line, slow and silent devices, and a power loss during a save. They are set with
//! `--fault` and `sim:?fault=`. Each device defines their effects.

use std::str::FromStr;
use std::time::Duration;

use fastrand::Rng;

/// Faults of a virtual device. By default, there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulatedFaults {
    drop: f64,
    flip: f64,
    garbage: f64,
    delay: Duration,
    silent_after: Option<u32>,
    die_in_store: Option<u32>,
}

/// The parser for the value of the `fault` setting.
pub const FAULTS: FaultParser = FaultParser;

/// The type of [`FAULTS`].
#[derive(Clone, Copy, Debug)]
pub struct FaultParser;

impl FaultParser {
    /// Parses a list of faults.
    ///
    /// # Errors
    /// Returns an error about the first invalid fault.
    pub fn parse_value(&self, _key: &str, value: &str) -> Result<SimulatedFaults, FaultError> {
        value.parse()
    }

    /// Returns an empty string, because a list of faults has no unit.
    pub fn unit(&self) -> &'static str {
        ""
    }

    /// Returns `false`, because a list of faults is not a number.
    pub fn is_decimal(&self) -> bool {
        false
    }
}

/// The reason why a list of faults is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// The fault is unknown, or its value is missing.
    #[error(
        "`{item}` is not a fault; valid faults are drop:P, flip:P, garbage:P, delay:MS, silent-after:N and \
         die-in-store:N, separated by commas"
    )]
    Unknown {
        /// Fault as entered.
        item: String,
    },
    /// The value of `drop`, `flip` or `garbage` is not a probability.
    #[error("fault `{item}`: the probability must be a number from 0 to 1")]
    Probability {
        /// Fault as entered.
        item: String,
    },
    /// The value of `delay`, `silent-after` or `die-in-store` is out of range.
    #[error("fault `{item}`: the value must be a whole number from {min} to {max}")]
    Number {
        /// Fault as entered.
        item: String,
        /// Minimum value.
        min: u32,
        /// Maximum value.
        max: u32,
    },
}

/// What arrives when a byte is sent over a noisy line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByteTransfer {
    /// Noise byte that arrives before the byte, if any.
    pub inserted: Option<u8>,
    /// Byte that arrived, or `None` if the byte was lost.
    pub carried: Option<ReceivedByte>,
}

/// A byte that has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReceivedByte {
    /// Data bits.
    pub byte: u8,
    /// Whether one bit was inverted in transit, which makes the parity wrong.
    pub flipped: bool,
}

impl SimulatedFaults {
    const MAX_DELAY_MS: u32 = 60_000;

    /// Returns the delay added before each reply.
    pub fn reply_delay(&self) -> Duration {
        self.delay
    }

    /// Returns the number of frames after which the device fails and does nothing more.
    pub fn silent_after(&self) -> Option<u32> {
        self.silent_after
    }

    /// Returns the number of the save during which the power fails, counted from 1.
    pub fn save_with_power_failure(&self) -> Option<u32> {
        self.die_in_store
    }

    /// Passes a byte over the noisy line.
    pub fn transmit_byte(&self, rng: &mut Rng, byte: u8) -> ByteTransfer {
        let inserted = random_event_occurs(self.garbage, rng).then(|| rng.u8(..));
        let carried = (!random_event_occurs(self.drop, rng)).then(|| match random_event_occurs(self.flip, rng) {
            true => ReceivedByte { byte: byte ^ 1 << rng.u8(..8), flipped: true },
            false => ReceivedByte { byte, flipped: false },
        });
        ByteTransfer { inserted, carried }
    }
}

fn random_event_occurs(probability: f64, rng: &mut Rng) -> bool {
    // f64() is below 1, so a probability of 1 always applies and 0 never does.
    rng.f64() < probability
}

impl FromStr for SimulatedFaults {
    type Err = FaultError;

    /// Parses a list such as `drop:0.01,delay:5`. If an item is repeated, the last one applies. An empty string means
    /// no faults.
    fn from_str(text: &str) -> Result<Self, FaultError> {
        let mut faults = SimulatedFaults::default();
        for item in text.split(',').map(str::trim).filter(|item| !item.is_empty()) {
            let unknown = || FaultError::Unknown { item: item.to_owned() };
            let (name, value) = item.split_once(':').ok_or_else(unknown)?;
            match name {
                "drop" => faults.drop = parse_probability(item, value)?,
                "flip" => faults.flip = parse_probability(item, value)?,
                "garbage" => faults.garbage = parse_probability(item, value)?,
                "delay" => {
                    faults.delay = Duration::from_millis(parse_number(item, value, 0, Self::MAX_DELAY_MS)?.into());
                }
                "silent-after" => faults.silent_after = Some(parse_number(item, value, 0, u32::MAX)?),
                "die-in-store" => faults.die_in_store = Some(parse_number(item, value, 1, u32::MAX)?),
                _ => return Err(unknown()),
            }
        }
        Ok(faults)
    }
}

fn parse_probability(item: &str, value: &str) -> Result<f64, FaultError> {
    value
        .parse()
        .ok()
        .filter(|probability| (0.0..=1.0).contains(probability))
        .ok_or_else(|| FaultError::Probability { item: item.to_owned() })
}

fn parse_number(item: &str, value: &str, min: u32, max: u32) -> Result<u32, FaultError> {
    value.parse().ok().filter(|number| (min..=max).contains(number)).ok_or_else(|| FaultError::Number {
        item: item.to_owned(),
        min,
        max,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::proptest;

    #[test]
    fn parses_fault_specification() {
        let faults: SimulatedFaults =
            "drop:0.01, flip:1,garbage:0,delay:25,silent-after:0,die-in-store:2".parse().unwrap();
        assert_eq!((faults.drop, faults.flip, faults.garbage), (0.01, 1.0, 0.0));
        assert_eq!(faults.reply_delay(), Duration::from_millis(25));
        assert_eq!((faults.silent_after(), faults.save_with_power_failure()), (Some(0), Some(2)));
        assert_eq!("".parse(), Ok(SimulatedFaults::default()));
    }

    #[test]
    fn rejects_invalid_faults() {
        let cases = [
            ("drop:2", "fault `drop:2`: the probability must be a number from 0 to 1"),
            ("flip:NaN", "fault `flip:NaN`: the probability must be a number from 0 to 1"),
            ("garbage:", "fault `garbage:`: the probability must be a number from 0 to 1"),
            ("delay:-1", "fault `delay:-1`: the value must be a whole number from 0 to 60000"),
            ("die-in-store:0", "fault `die-in-store:0`: the value must be a whole number from 1 to 4294967295"),
            (
                "delay:1,lose:0.5",
                "`lose:0.5` is not a fault; valid faults are drop:P, flip:P, garbage:P, delay:MS, silent-after:N \
                 and die-in-store:N, separated by commas",
            ),
        ];
        for (text, sentence) in cases {
            assert_eq!(text.parse::<SimulatedFaults>().unwrap_err().to_string(), sentence);
        }
        assert!(matches!("drop".parse::<SimulatedFaults>(), Err(FaultError::Unknown { .. })));
    }

    #[test]
    fn probability_bounds_are_certain() {
        let mut rng = Rng::with_seed(1);
        let quiet = SimulatedFaults::default();
        let lossy: SimulatedFaults = "drop:1".parse().unwrap();
        let noisy: SimulatedFaults = "flip:1,garbage:1".parse().unwrap();
        for byte in 0..=255 {
            let whole = Some(ReceivedByte { byte, flipped: false });
            assert_eq!(quiet.transmit_byte(&mut rng, byte), ByteTransfer { inserted: None, carried: whole });
            assert_eq!(lossy.transmit_byte(&mut rng, byte).carried, None);
            let passage = noisy.transmit_byte(&mut rng, byte);
            assert!(passage.inserted.is_some());
            assert_eq!((passage.carried.unwrap().byte ^ byte).count_ones(), 1);
        }
    }

    proptest! {
        #[test]
        fn arbitrary_text_never_panics(text in "[a-z:0-9,.-]*") {
            let _ = text.parse::<SimulatedFaults>();
        }
    }
}
