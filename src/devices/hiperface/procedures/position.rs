//! Reads the position, analogue values and the counter, once or by polling, and checks that the shaft is at rest.

use std::time::Duration;

use super::identify::read_type_label;
use super::{Error, Master, read_extended_label};
use crate::devices::hiperface::protocol::{
    Command, ExtendedLabel, Geometry, Position, Reply, Request, StatusCode, TypeLabel,
};
use crate::units::Moment;

#[derive(Clone, Debug, PartialEq)]
pub struct PositionReading {
    /// Time at which the encoder sampled the position: the falling edge of the reply's first start bit.
    pub at: Moment,
    pub raw: u32,
    /// Position, or `None` if periods and turns are unknown.
    pub position: Option<Position>,
    /// Whether the position is within the measuring range and not invalidated by a status code.
    pub valid: bool,
    pub codes: Vec<StatusCode>,
}

/// Reads the position (42h), and all status codes if the reply announces any.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder does not report a position.
pub fn read_position(master: &mut Master<'_>, geometry: Option<Geometry>) -> Result<PositionReading, Error> {
    let met_before = master.station().codes_to_display.len();
    let timed = master.request_timed(&Request::ReadPosition)?;
    let Reply::Position(raw) = timed.reply else {
        return Err(Error::unexpected_reply(Command::ReadPosition, &timed.reply));
    };
    let codes = master.station().codes_to_display.get(met_before..).unwrap_or_default().to_vec();
    let position = geometry.map(|geometry| geometry.position(raw));
    let in_range = position.is_none_or(|position| position.in_range);
    let valid = in_range && !codes.iter().any(|code| code.invalidates_position());
    Ok(PositionReading { at: timed.at, raw, position, valid, codes })
}

#[derive(Clone, Debug, PartialEq)]
pub enum PolledSample {
    Position(PositionReading),
    /// The encoder replies, but currently has no position to report.
    NoPosition {
        at: Moment,
        codes: Vec<StatusCode>,
    },
    /// Value polled in addition to the position.
    Watched(WatchedReading),
}

/// Value that can be polled in addition to the position. All other values in an encoder change only when written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WatchedQuantity {
    /// Analogue channel (command 44h). Channel 48h is the temperature in °C. Channels 00h and 01h are usually the sine
    /// and cosine signals in counts of 10 bits for 5 V. The data sheet defines all other channels.
    Analogue(u8),
    /// The counter (46h), 0…FFFFFFh.
    Counter,
}

impl WatchedQuantity {
    /// Temperature in °C. Not every encoder has this channel.
    pub const TEMPERATURE: WatchedQuantity = WatchedQuantity::Analogue(0x48);
}

#[derive(Clone, Debug, PartialEq)]
pub struct WatchedReading {
    /// Time at which the encoder sampled an analogue value: the falling edge of the reply's first start bit. For the
    /// counter or a rejection, it is the time at which the reply was parsed.
    pub at: Moment,
    pub watch: WatchedQuantity,
    pub value: Result<i64, Error>,
    pub codes: Vec<StatusCode>,
}

impl WatchedReading {
    /// Returns whether the encoder does not support the command or the channel. All other rejections are temporary.
    pub fn is_refused(&self) -> bool {
        match &self.value {
            Err(Error::Rejected { codes, .. }) => {
                codes.iter().any(|code| matches!(*code, StatusCode::UNKNOWN_COMMAND | StatusCode::ARGUMENT))
            }
            _ => false,
        }
    }
}

/// Reads a watched value once. If the encoder rejects the request, the reading contains the rejection.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_watched_value(master: &mut Master<'_>, what: WatchedQuantity) -> Result<WatchedReading, Error> {
    let met_before = master.station().codes_to_display.len();
    let answer = match what {
        WatchedQuantity::Analogue(channel) => request_analogue(master, channel).map(|(at, value)| (at, value.into())),
        WatchedQuantity::Counter => read_counter(master).map(|value| (master.now(), value.into())),
    };
    let (at, value) = match answer {
        Ok((at, value)) => (at, Ok(value)),
        Err(error @ Error::Rejected { .. }) => (master.now(), Err(error)),
        Err(error) => return Err(error),
    };
    let codes = master.station().codes_to_display.get(met_before..).unwrap_or_default().to_vec();
    Ok(WatchedReading { at, watch: what, value, codes })
}

/// Reads the position like [`read_position`], but does not treat a temporary lack of a position as an error.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder rejects the request for another reason.
pub fn read_sample(master: &mut Master<'_>, geometry: Option<Geometry>) -> Result<PolledSample, Error> {
    let met_before = master.station().codes_to_display.len();
    match read_position(master, geometry) {
        Ok(reading) => Ok(PolledSample::Position(reading)),
        Err(error) if error.is_without_position() => {
            let at = master.now();
            let mut codes = match error {
                Error::Rejected { codes, .. } => codes,
                _ => Vec::new(),
            };
            let met = master.station().codes_to_display.get(met_before..).unwrap_or_default();
            let more: Vec<StatusCode> = met.iter().copied().filter(|code| !codes.contains(code)).collect();
            codes.extend(more);
            Ok(PolledSample::NoPosition { at, codes })
        }
        Err(error) => Err(error),
    }
}

/// Reads an analogue channel (44h). Most channels have signed values with 10 bits for 5 V. For other channels, see the
/// data sheet.
///
/// # Errors
/// Returns an error if the exchange fails or the channel does not exist.
pub fn read_analogue(master: &mut Master<'_>, channel: u8) -> Result<i16, Error> {
    request_analogue(master, channel).map(|(_, value)| value)
}

/// Reads an analogue channel, and returns its value with the time at which the encoder sampled it.
fn request_analogue(master: &mut Master<'_>, channel: u8) -> Result<(Moment, i16), Error> {
    let timed = master.request_timed(&Request::ReadAnalogue { channel })?;
    match timed.reply {
        Reply::Analogue(value) => Ok((timed.at, value)),
        other => Err(Error::unexpected_reply(Command::ReadAnalogue, &other)),
    }
}

/// Reads an analogue channel's limit from the extended label, if there is one.
///
/// # Errors
/// Returns an error if the exchange fails.
pub fn read_analogue_limit(master: &mut Master<'_>, channel: u8) -> Result<Option<i16>, Error> {
    if read_type_label(master)?.encoder_type != TypeLabel::EXTENDED {
        return Ok(None);
    }
    match read_extended_label(master) {
        Ok(bytes) => {
            let limits = ExtendedLabel::parse(&bytes).map(|label| label.limits()).unwrap_or_default();
            Ok(limits.into_iter().find(|(of, _)| *of == channel).map(|(_, limit)| limit))
        }
        Err(Error::Rejected { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// Reads the counter (46h), 0…FFFFFFh.
///
/// # Errors
/// Returns an error if the exchange fails or the encoder rejects the request.
pub fn read_counter(master: &mut Master<'_>) -> Result<u32, Error> {
    match master.request_confirmed(&Request::ReadCounter)? {
        Reply::Counter(value) => Ok(value),
        other => Err(Error::unexpected_reply(Command::ReadCounter, &other)),
    }
}

/// Reads the position three times, a tenth of a second apart, and returns the last reading. The shaft is at rest if the
/// readings differ by at most one step.
///
/// # Errors
/// Returns [`Error::Moving`] if the shaft moves, or another error if a reading fails.
pub fn ensure_standstill(master: &mut Master<'_>, geometry: Option<Geometry>) -> Result<u32, Error> {
    let first = read_position(master, geometry)?.raw;
    let (mut last, mut readings) = (first, vec![first]);
    for _ in 0..2 {
        master.wait(Duration::from_millis(100))?;
        last = read_position(master, geometry)?.raw;
        readings.push(last);
    }
    let range = position_range(geometry);
    if readings.iter().all(|reading| shortest_distance(first, *reading, range) <= 1) {
        Ok(last)
    } else {
        Err(Error::Moving { readings })
    }
}

/// Returns the number of distinct positions, which is 2³² if the geometry is unknown.
pub(super) fn position_range(geometry: Option<Geometry>) -> u64 {
    geometry.and_then(Geometry::position_count).unwrap_or(1 << 32)
}

/// Returns the number of steps between two positions in the shorter direction, because a shaft at rest may jitter
/// across zero.
pub(super) fn shortest_distance(a: u32, b: u32, range: u64) -> u64 {
    let straight = u64::from(a.abs_diff(b));
    straight.min(range.saturating_sub(straight))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_takes_shorter_direction() {
        assert_eq!(shortest_distance(0, 4095, 4096), 1);
        assert_eq!(shortest_distance(5, 3, 4096), 2);
        assert_eq!(shortest_distance(0, u32::MAX, 1 << 32), 1);
    }
}
