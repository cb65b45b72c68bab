//! Reading positions and watched registers for display and plotting.

use super::flags::add_error_flags;
use super::{ConsecutiveFrames, Error, Master, ReplyDamage};
use crate::bits::Word;
use crate::devices::biss::profile::RegisterRange;
use crate::devices::biss::protocol::{Layout, PositionData};
use crate::units::Moment;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionReading {
    /// Time at which the encoder sampled the position.
    pub at: Moment,
    /// Number of revolutions, which wraps around at the multiturn width.
    pub turns: u32,
    /// Position within the revolution in steps. The number of steps per revolution is 2 to the power of
    /// [`singleturn_bits`](Self::singleturn_bits).
    pub steps: u32,
    /// Whether the error bit marks the position as invalid, or `None` if unknown. Over the configuration pin, the error
    /// is read from a separate register.
    pub error: Option<bool>,
    /// Whether the warning bit is set, or `None` if unknown.
    pub warning: Option<bool>,
    /// Number of frames with a wrong CRC since the previous reading.
    pub crc_errors: u32,
    /// Width of the revolution count in bits, 0 to 32.
    pub multiturn_bits: u8,
    /// Width of the position within a revolution in bits, 0 to 32.
    pub singleturn_bits: u8,
    /// Whether the multiturn width is known. If not, `turns` and `steps` are merely the upper and lower bits of the
    /// position.
    pub is_split_known: bool,
    /// Complete frame with flags and CRC, or `None` over the configuration pin.
    pub frame: Option<Word>,
}

impl PositionReading {
    /// Creates a reading without the error and warning bits, CRC error count and frame, which some transports do not
    /// provide.
    pub(super) fn new(at: Moment, reading: &PositionData, layout: &Layout) -> Self {
        PositionReading {
            at,
            turns: reading.multiturn,
            steps: reading.singleturn,
            error: None,
            warning: None,
            crc_errors: 0,
            multiturn_bits: layout.multiturn_bits(),
            singleturn_bits: layout.singleturn_bits(),
            is_split_known: true,
            frame: None,
        }
    }

    /// Creates a reading from a frame with a correct checksum.
    pub fn from_frame(at: Moment, reading: &PositionData, layout: &Layout) -> Self {
        PositionReading {
            error: layout.has_error_bit().then_some(reading.error),
            warning: layout.has_warning_bit().then_some(reading.warning),
            frame: Some(Word { value: layout.emit(reading), bits: layout.bits() }),
            ..PositionReading::new(at, reading, layout)
        }
    }

    /// Returns the position word, in which the multiturn bits are above the singleturn bits. It contains no flags and
    /// no CRC.
    pub const fn position_word(&self) -> Word {
        Word { value: self.position(), bits: self.multiturn_bits + self.singleturn_bits }
    }

    /// Returns the turns and steps combined into a single number of steps.
    pub const fn position(&self) -> u64 {
        (self.turns as u64) << self.singleturn_bits | self.steps as u64
    }

    /// Returns the angle within the revolution in degrees, at least 0 and less than 360. Returns `None` if the number
    /// of steps per revolution is unknown.
    pub fn angle_degrees(&self) -> Option<f64> {
        self.is_split_known.then(|| self.degrees_in_turn())
    }

    /// Returns the angle within the revolution in degrees, at least 0 and less than 360.
    pub fn degrees_in_turn(&self) -> f64 {
        f64::from(self.steps) * 360.0 / (1u64 << self.singleturn_bits) as f64
    }

    /// Returns whether the position is valid, which is assumed unless the encoder reports an error.
    pub fn is_valid(&self) -> bool {
        self.error != Some(true)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum PolledSample {
    Position(PositionReading),
    /// Frames have arrived, but none of them had a correct checksum.
    Missed {
        /// Time of the last frame.
        at: Moment,
        /// Number of CRC errors, including frames that were read again.
        crc_errors: u32,
    },
    Frames(ConsecutiveFrames),
    Watched(WatchedReading),
}

#[derive(Clone, Debug, PartialEq)]
pub struct WatchedReading {
    pub at: Moment,
    pub range: RegisterRange,
    /// Values in ascending order of address, or the reason why they could not be read, such as a register that does not
    /// exist or belongs to a data area.
    pub value: Result<Vec<u8>, Error>,
}

/// Reads the position once. Damaged frames are not an error once a valid frame has been received.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_sample(master: &mut Master<'_>) -> Result<PolledSample, Error> {
    match master.position() {
        Ok(reading) if reading.frame.is_some() => Ok(PolledSample::Position(reading)),
        Ok(reading) => add_error_flags(master, reading).map(PolledSample::Position),
        Err(Error::Damaged { cause: ReplyDamage::Frame(_), .. }) => {
            Ok(PolledSample::Missed { at: master.now(), crc_errors: master.station().take_crc_errors() })
        }
        Err(error) => Err(error),
    }
}

/// Reads watched registers once. Registers that are missing or belong to a data area do not make the whole reading
/// fail.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_watched_value(master: &mut Master<'_>, what: RegisterRange) -> Result<WatchedReading, Error> {
    let description = master.station().description.clone();
    let of_area = |address| description.as_ref().is_some_and(|own| own.area_at(address).is_some());
    let value = match what.addresses().find(|address| of_area(*address)) {
        // Data areas are not read while the shaft turns (manual 6.5), and users do not stop the shaft to watch a
        // register.
        Some(address) => Err(Error::NotWatched { address }),
        None => match master.read_consecutive(what.start(), what.count().into()) {
            Err(error) if !matches!(error, Error::NoSuchRegister { .. }) => return Err(error),
            value => value,
        },
    };
    Ok(WatchedReading { at: master.now(), range: what, value })
}
