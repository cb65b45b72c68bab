//! Reads the position with the highest accuracy while the shaft is at rest, for commutation and synchronisation. The
//! absolute position is combined with sine and cosine if the encoder has analogue channels for them.

use super::{Error, Master, ensure_standstill, read_analogue, read_position};
use crate::devices::hiperface::protocol::Geometry;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestPosition {
    pub raw: u32,
    /// Whether the position is within the measuring range and not invalidated by a status code.
    pub valid: bool,
    /// Sine and cosine signals, if the encoder provides them.
    pub signals: Option<Signals>,
}

/// Sine and cosine signals, each relative to its reference wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signals {
    pub sine_v: f64,
    pub cosine_v: f64,
}

impl Signals {
    /// Analogue channels of sine and cosine. Only some encoder types have them.
    pub const CHANNELS: (u8, u8) = (0x00, 0x01);
    /// Volts per analogue count, with ten bits for 5 V.
    const VOLTS_PER_COUNT: f64 = 5.0 / 1023.0;
    /// Analogue counts at the reference level of sine and cosine, 2.5 V.
    const MEAN_COUNT: f64 = 511.5;

    fn from_counts(sine: f64, cosine: f64) -> Self {
        let volts = |counts: f64| (counts - Self::MEAN_COUNT) * Self::VOLTS_PER_COUNT;
        Signals { sine_v: volts(sine), cosine_v: volts(cosine) }
    }

    /// Returns the position resolution in periods. It is the fraction of a period that one analogue count represents at
    /// the amplitude of these signals.
    pub fn resolution_periods(&self) -> f64 {
        let amplitude = self.sine_v.hypot(self.cosine_v).max(Self::VOLTS_PER_COUNT);
        Self::VOLTS_PER_COUNT / amplitude / std::f64::consts::TAU
    }
}

/// Reads the position, then sine and cosine, then the position again. The sine and cosine values are averages of four
/// readings.
///
/// # Errors
/// Returns [`Error::Moving`] if the shaft moves, or another error if the exchange fails or there is no position.
pub fn read_at_rest(master: &mut Master<'_>, geometry: Option<Geometry>) -> Result<RestPosition, Error> {
    let before = ensure_standstill(master, geometry)?;
    let signals = read_signals(master)?;
    let after = read_position(master, geometry)?;
    if super::position::shortest_distance(before, after.raw, super::position::position_range(geometry)) > 1 {
        return Err(Error::Moving { readings: vec![before, after.raw] });
    }
    Ok(RestPosition { raw: after.raw, valid: after.valid, signals })
}

fn read_signals(master: &mut Master<'_>) -> Result<Option<Signals>, Error> {
    const READINGS: u8 = 4;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for _ in 0..READINGS {
        for (channel, sum) in [(Signals::CHANNELS.0, &mut sine), (Signals::CHANNELS.1, &mut cosine)] {
            match read_analogue(master, channel) {
                Ok(value) => *sum += f64::from(value),
                // Many types do not have these channels.
                Err(Error::Rejected { .. }) => return Ok(None),
                Err(error) => return Err(error),
            }
        }
    }
    let count = f64::from(READINGS);
    Ok(Some(Signals::from_counts(sine / count, cosine / count)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One count is 1/1023 of 5 V, so 2.5 V is 511.5 counts and 3 V is 613.8 counts. At an amplitude of 0.5 V, a count
    /// is 0.00978 rad.
    #[test]
    fn converts_counts_to_volts() {
        let signals = Signals::from_counts(613.8, 511.5);
        assert!((signals.sine_v - 0.5).abs() < 1e-12 && signals.cosine_v == 0.0, "{signals:?}");
        assert!((signals.resolution_periods() - 0.001_555_8).abs() < 1e-6, "{}", signals.resolution_periods());
        assert!(Signals { sine_v: 0.0, cosine_v: 0.0 }.resolution_periods() < 0.2, "no signal at all");
    }
}
