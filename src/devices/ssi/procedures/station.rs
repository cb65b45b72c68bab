//! State of an adapter and the settings for reading SSI words, which are kept between the jobs of a session.

use std::fmt;
use std::time::Duration;

use crate::analysis::SampleTime;
use crate::buses::bridge::procedures::flow::SampleStream;
use crate::buses::bridge::procedures::{AdapterState, CLOCK, SupplyAfterSession};
use crate::buses::bridge::protocol::Hello;
use crate::expected::Quantity;
use crate::link::line::{LineState, MARGIN};
use crate::link::{UrlError, UrlQuery};
use crate::parameter::{Millivolts, OptionalValue, ParameterGroup, WholeNumbers};
use crate::parameters;
use crate::units::SupplyVoltage;

parameters! {
    /// Link parameters for the line and the encoder's supply.
    pub struct LinkParameters: UrlError {
        /// Extra time allowed for a reply beyond the protocol's maximum, or `None` for the default of the link.
        pub margin: Option<Duration> = None, "margin" => OptionalValue(MARGIN), "connect.margin" like "50";
        pub clock_hz: u32 = 400_000, "clock" => CLOCK;
        /// Minimum pause between two words in microseconds.
        pub pause_us: u16 = 200, "pause" => WholeNumbers(Quantity::Microseconds, 1..=u16::MAX);
        /// Supply voltage in millivolts that the adapter provides to the encoder, or `None` for no supply.
        pub millivolt: Option<u16> = None, "voltage" => OptionalValue(Millivolts(Supply::RANGE)), "connect.voltage" like "";
        pub after: SupplyAfterSession = SupplyAfterSession::AsFound, "leave-supply" => SupplyAfterSession::KEYWORDS;
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockSettings {
    /// Number of bits per word, 1 to 64.
    pub clocks: u8,
    /// Requested clock frequency in hertz. The adapter uses the nearest frequency that it supports.
    pub clock_hz: u32,
    /// Minimum pause between two words in microseconds. It must be longer than the monoflop time of the encoder.
    pub pause_us: u16,
}

impl Default for ClockSettings {
    /// Returns settings for words of 25 bits. The clock is slow enough for 50 m of cable, and the pause is long enough
    /// for every family. See SICK SSI description 2.7.
    fn default() -> Self {
        let LinkParameters { clock_hz, pause_us, .. } = LinkParameters::default();
        ClockSettings { clocks: 25, clock_hz, pause_us }
    }
}

/// Identity of the adapter, and the current settings for reading SSI words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    pub hello: Hello,
    pub clock_settings: ClockSettings,
    /// Actual clock frequency in hertz, as set by the adapter.
    pub clock_hz: u32,
    pub supply: Option<Supply>,
}

#[derive(Clone, Debug)]
pub struct Station {
    pub line: LineState,
    pub adapter: AdapterState,
    pub clock_settings: ClockSettings,
    /// Encoder supply that the adapter switches on, if requested.
    pub supply: Option<Supply>,
    /// Settings sent to the adapter, and the actual clock frequency in hertz. `None` if the adapter is not configured
    /// or may have been reset.
    pub(super) set: Option<(ClockSettings, u32)>,
    pub(super) flow: Option<SampleStream>,
    /// Time of the last word received in an earlier stream.
    pub(super) streamed_until: Option<SampleTime>,
    /// Number of individually requested SSI words since the settings last changed.
    pub(super) asked: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Supply {
    pub millivolt: u16,
    /// Voltage in millivolts and current in milliamperes, measured when the supply was switched on.
    pub measured: Option<(u16, u16)>,
}

impl Supply {
    /// Time from power-up until SSI words are valid. The manual does not specify this time (`U`).
    pub(super) const POWER_UP: Duration = Duration::from_millis(500);
    /// Supply voltages of SSI encoders in millivolts, from 5 V minus 10 % to 30 V. See SICK SSI description, TTK70.
    const RANGE: std::ops::RangeInclusive<u16> = 4_500..=30_000;

    /// Returns the supply voltage with its limits. The encoder is unknown, so the upper limit is 10 % above the
    /// requested voltage. An AFS60 at 5 V, for example, allows 4.5 to 5.5 V.
    pub(super) const fn with_voltage(millivolt: u16) -> SupplyVoltage {
        SupplyVoltage { least: *Self::RANGE.start(), nominal: millivolt, greatest: millivolt + millivolt / 10 }
    }
}

impl Station {
    /// Creates the state for an adapter that has not been identified. `margin` is the extra time allowed for a reply
    /// beyond the protocol's maximum.
    pub fn new(margin: Duration) -> Self {
        Station {
            line: LineState::new(margin),
            adapter: AdapterState::default(),
            clock_settings: ClockSettings::default(),
            supply: None,
            set: None,
            flow: None,
            streamed_until: None,
            asked: 0,
        }
    }

    /// Creates the state from the parameters of a link. Parameters that do not concern the line are ignored.
    ///
    /// # Errors
    /// Returns an error with the allowed values if the value of a parameter is invalid.
    pub fn from_query(query: &UrlQuery, margin: Duration) -> Result<Self, UrlError> {
        let link = LinkParameters::read(query.pairs())?;
        let mut station = Station::new(link.margin.unwrap_or(margin));
        (station.clock_settings.clock_hz, station.clock_settings.pause_us) = (link.clock_hz, link.pause_us);
        station.supply = link.millivolt.map(|millivolt| Supply { millivolt, measured: None });
        station.adapter.set_supply_after_session(link.after);
        Ok(station)
    }

    /// Discards all data about the adapter, so that the adapter is identified and configured again before its next use.
    pub(super) fn forget_adapter(&mut self) {
        self.adapter.forget_identity();
        self.flow = None;
        self.forget_settings();
    }

    /// Discards the settings and the supply state, because a reset adapter has lost its settings and switched off the
    /// supply.
    pub(super) fn forget_settings(&mut self) {
        self.set = None;
        if let Some(supply) = &mut self.supply {
            supply.measured = None;
        }
    }

    pub(crate) fn reset_request_count(&mut self) {
        self.asked = 0;
    }

    /// Returns the number of the next single request, and increments the counter.
    pub(super) fn count(&mut self) -> u64 {
        let number = self.asked;
        self.asked = number.wrapping_add(1);
        number
    }
}

impl fmt::Display for Station {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let clock_hz = self.set.map_or(self.clock_settings.clock_hz, |(_, clock_hz)| clock_hz);
        write!(f, "SSI of {} clocks at {clock_hz} Hz", self.clock_settings.clocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn station(query: &str) -> Result<Station, UrlError> {
        Station::from_query(&query.parse().unwrap(), Duration::from_millis(100))
    }

    #[test]
    fn parses_line_settings() {
        let usual = station("").unwrap();
        assert_eq!(
            (usual.clock_settings, usual.supply),
            (ClockSettings { clocks: 25, clock_hz: 400_000, pause_us: 200 }, None)
        );
        assert_eq!(usual.line.margin, Duration::from_millis(100));
        let own = station("margin=5&clock=1500000&pause=30&voltage=24").unwrap();
        assert_eq!(own.clock_settings, ClockSettings { clocks: 25, clock_hz: 1_500_000, pause_us: 30 });
        assert_eq!(own.supply, Some(Supply { millivolt: 24_000, measured: None }));
        assert_eq!(
            (own.line.margin, own.to_string()),
            (Duration::from_millis(5), "SSI of 25 clocks at 1500000 Hz".into())
        );
        assert_eq!(Supply::with_voltage(5_000), SupplyVoltage { least: 4_500, nominal: 5_000, greatest: 5_500 });
    }

    #[test]
    fn rejection_lists_allowed_values() {
        for (query, message) in [
            ("margin=-1", "margin=-1 is not valid (allowed: a time in milliseconds from 0 to 2000)"),
            ("clock=79999", "clock=79999 is not valid (allowed: a frequency in hertz from 80000 to 10000000)"),
            ("pause=0", "pause=0 is not valid (allowed: a time in microseconds from 1 to 65535)"),
            ("pause=65536", "pause=65536 is not valid (allowed: a time in microseconds from 1 to 65535)"),
            ("voltage=48", "voltage=48 is not valid (allowed: a voltage in volts from 4.5 to 30)"),
            ("voltage=NaN", "voltage=NaN is not valid (allowed: a voltage in volts from 4.5 to 30)"),
        ] {
            assert_eq!(station(query).unwrap_err().to_string(), message);
        }
    }
}
