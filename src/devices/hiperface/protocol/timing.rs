//! Protocol timing (manual, "Dialog Timing" and the table of commands).

use std::time::Duration;

use super::{LineSettings, Request};
use crate::units::CharacterFormat;

/// Times of the protocol for specific line settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Duration of one 11-bit character.
    pub character: Duration,
    /// Silence that ends a frame: 44 bits, or 11 bits if configured. The dead time before the next request is longer.
    pub timeout: Duration,
}

impl Timing {
    /// Maximum time after power-on or reset during which the encoder does not receive.
    pub const INITIALISATION: Duration = Duration::from_millis(100);
    /// Time from power-on to the end of the default window. Until then, the encoder uses the factory settings.
    pub const DEFAULT_WINDOW_END: Duration = Duration::from_millis(900);
    /// Maximum time during which the encoder does not receive while it applies the stored settings.
    pub const SWITCH: Duration = Duration::from_millis(200);

    /// Creates the timing for a character format. The time-out is 44 bits if `long_timeout` is set, and 11 bits
    /// otherwise.
    pub fn new(format: CharacterFormat, long_timeout: bool) -> Self {
        let bits = if long_timeout { 44 } else { 11 };
        Timing { character: format.character_time(), timeout: format.baud.duration_of_bits(bits) }
    }

    /// Creates the timing for a settings byte, or returns `None` if the byte contains reserved values.
    pub fn from_settings(settings: LineSettings) -> Option<Self> {
        Some(Self::new(settings.character_format()?, settings.has_long_timeout()))
    }

    /// Returns the maximum time from the first bit of a request to the last bit of its reply. It is the sum of both
    /// transfers, the time-out and the processing time. For a request without a reply, it is the sum of one transfer
    /// and the time-out.
    pub fn worst_case(&self, request: &Request) -> Duration {
        let sent = request.emit(0).bytes().len();
        let reply = request.reply_length(&[]).map_or(0, |length| length.max);
        self.time_of_characters(sent + reply) + self.timeout + request.command().row().max_time
    }

    /// Returns the duration of `count` consecutive characters.
    pub fn time_of_characters(&self, count: usize) -> Duration {
        self.character.saturating_mul(u32::try_from(count).unwrap_or(u32::MAX))
    }
}

#[cfg(test)]
mod tests {
    use super::super::AccessCode;
    use super::*;
    use crate::units::{Baud, Parity};

    /// The worst cases in units of 0.1 ms, at 9600 8E1 with the default time-out, were calculated by hand from 11 bits
    /// per character, a time-out of 44 bits and the manual's maximum times.
    #[test]
    fn worst_case_durations_at_9600_baud() {
        let timing = Timing::from_settings(LineSettings::FACTORY).unwrap();
        let code = AccessCode::FACTORY;
        let read = |count| Request::ReadData { field: 0, address: 0, count, code };
        let store = |count| Request::StoreData { field: 0, address: 0, code, data: vec![0; count] };
        let cases = [
            (Request::ReadPosition, 260),
            (Request::SetPosition { position: 0, code0: code }, 572),
            (Request::ReadAnalogue { channel: 0 }, 210),
            (Request::ReadCounter, 199),
            (Request::IncrementCounter, 415),
            (Request::ClearCounter { code0: code }, 426),
            (read(16), 678),
            (read(128), 1962),
            (store(16), 2878),
            (store(128), 4162),
            (Request::FieldStatus { field: 0 }, 199),
            (Request::FreeMemory, 188),
            (Request::ReadTypeLabel, 210),
            (Request::Reset, 80),
        ];
        for (request, tenths) in cases {
            let got = timing.worst_case(&request).as_micros().div_ceil(100) as u64;
            let close = got.abs_diff(tenths) <= 1;
            assert!(close, "{}: {got} is not {tenths}", request.command().row().name);
        }
    }

    #[test]
    fn timeout_is_programmable() {
        let format = CharacterFormat { baud: Baud::new(38400).unwrap(), parity: Parity::Even };
        assert_eq!(Timing::new(format, false).timeout, Duration::from_nanos(286_458));
        assert_eq!(Timing::new(format, true).timeout, Duration::from_nanos(1_145_833));
    }
}
