//! The state of a line and its encoder, kept from one job to the next.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use super::flags::Flags;
use super::identify::FrameSource;
use crate::analysis::SampleTime;
use crate::bits::ByteOrder;
use crate::buses::bridge::procedures::flow::SampleStream;
use crate::buses::bridge::procedures::{AdapterState, CLOCK, SupplyAfterSession};
use crate::buses::ubicom::protocol::{FORMAT, REPLY_TIME_OUT};
use crate::devices::biss::protocol::{Access, Crc, Description, Firmware, Identity as Kind, Layout, RegisterAddress};
use crate::expected::{AllowedValues, Quantity};
use crate::link::line::{Echo, LineState, MARGIN};
use crate::link::{UrlError, UrlQuery};
use crate::parameter::{
    CustomNotation, Keywords, Milliseconds, Millivolts, OptionalValue, ParameterGroup, RejectedParameter, WholeNumbers,
};
use crate::parameters;
use crate::units::{Baud, CharacterFormat, Moment, Parity, SupplyVoltage};

/// Keywords for the byte order of register numbers. `None` stands for automatic detection.
pub const ORDERS: Keywords<Option<ByteOrder>> =
    Keywords(&[("auto", None), ("low-first", Some(ByteOrder::LowFirst)), ("high-first", Some(ByteOrder::HighFirst))]);

parameters! {
    /// Link parameters for the configuration pin.
    pub struct PinParameters: UrlError {
        /// Baud rate of the serial port. The port may support fewer rates.
        pub baud: Baud = FORMAT.baud, "baud" => CustomNotation(AllowedValues::BitRate { low: 300, high: 4_000_000 }, read_baud),
            "settings_card.baud" like "115200";
        pub parity: Parity = FORMAT.parity, "parity" => Parity::KEYWORDS;
        /// Byte order of register numbers, or `None` to detect it.
        pub order: Option<ByteOrder> = None, "order" => ORDERS;
        pub echo: Echo = Echo::Unknown, "echo" => Echo::KEYWORDS;
        /// Time limit for a reply, not counting transmission time and the margin.
        pub timeout: Duration = REPLY_TIME_OUT, "timeout" => Milliseconds(1..=10_000);
    }
}

parameters! {
    /// Link parameters for the time limit for a reply.
    pub struct LineParameters: UrlError {
        /// Additional delay allowed for a reply, or `None` for the default of the link.
        pub margin: Option<Duration> = None, "margin" => OptionalValue(MARGIN), "connect.margin" like "50";
    }
}

parameters! {
    /// Link parameters for the bus behind an adapter.
    pub struct BusParameters: UrlError {
        /// BiSS clock frequency in hertz. The default is slow enough for long cables.
        pub clock_hz: u32 = 1_000_000, "clock" => CLOCK, "connect.biss_clock";
        /// Supply voltage that the adapter provides to the encoder, in millivolts, or `None` for no supply.
        pub millivolt: Option<u16> = None, "voltage" => OptionalValue(Millivolts(Supply::RANGE));
        pub after: SupplyAfterSession = SupplyAfterSession::AsFound, "leave-supply" => SupplyAfterSession::KEYWORDS;
    }
}

parameters! {
    /// Link parameters for the frame of an encoder that does not report its layout.
    pub struct FrameParameters: UrlError {
        pub multiturn: Option<u8> = None, "mt" => OptionalValue(WholeNumbers(Quantity::Bits, 0..=32)), "connect.biss_turns" like "16";
        pub singleturn: Option<u8> = None, "st" => OptionalValue(WholeNumbers(Quantity::Bits, 1..=32)), "connect.biss_steps" like "17";
        /// Checksum of the frames, if specified. `Some(None)` means that frames have no checksum.
        pub crc: Option<Option<Crc>> = None,
            "crc" => OptionalValue(CustomNotation(AllowedValues::Polynomial, read_crc)), "connect.biss_crc" like "0x43";
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// UBICOM over the configuration pin, with global register addresses.
    ConfigPin,
    /// BiSS through an adapter, with register addresses in the selected bank.
    Adapter,
}

impl Transport {
    /// Returns the link parameters that apply to the transport.
    pub fn parameters(self) -> Vec<&'static str> {
        match self {
            Transport::ConfigPin => [PinParameters::KEYS, LineParameters::KEYS, FrameParameters::KEYS].concat(),
            Transport::Adapter => [LineParameters::KEYS, BusParameters::KEYS, FrameParameters::KEYS].concat(),
        }
    }
}

#[derive(Clone, Debug)]
pub struct Station {
    pub transport: Transport,
    /// Baud rate and parity on the configuration pin. The encoder itself only uses 115200 8N1, but a converter or radio
    /// link in between may differ.
    pub format: CharacterFormat,
    pub line: LineState,
    /// Byte order of register numbers over the configuration pin, or `None` until it is detected.
    pub order: Option<ByteOrder>,
    /// Reply time-out, not counting transmission time and the margin.
    pub timeout: Duration,
    /// Requested BiSS clock frequency in hertz. The adapter uses the nearest supported frequency.
    pub clock_hz: u32,
    /// Actual BiSS clock frequency of the adapter in hertz, or `None` until it has been set.
    pub actual_clock_hz: Option<u32>,
    /// Supply for the encoder, if the adapter is to switch it.
    pub supply: Option<Supply>,
    pub adapter: AdapterState,
    /// Register description of the encoder, or `None` before identification.
    pub description: Option<Arc<Description>>,
    /// Type and serial number found during identification.
    pub identified: Option<(Kind, String)>,
    /// Firmware version found during identification.
    pub firmware: Option<Firmware>,
    /// Frame layout from the encoder's data sheet or from the link, if either provides one.
    pub layout: Option<Layout>,
    /// Frame layout that the user specified for an encoder that does not report one.
    pub given: Option<Layout>,
    /// Source of the frame layout, or `None` before identification.
    pub(super) source: Option<FrameSource>,
    /// Whether every value must be read twice, even on a line without errors, because the values will be stored.
    pub(super) reads_twice: bool,
    pub(super) noisy: bool,
    pub(super) bus: Option<Bus>,
    /// The bank selected over BiSS, and the last time at which the selection was certain.
    pub(super) bank: Option<(u8, Moment)>,
    /// Number of frames with a wrong checksum since the last position reading.
    pub(super) crc_errors: u32,
    /// Whether a frame with the current widths has had a correct checksum.
    pub(super) good_frames: bool,
    /// Last values of the error and warning registers, if they are read over the configuration pin.
    pub(super) flags: Option<Flags>,
    pub(super) flow: Option<SampleStream>,
    /// Time of the last frame in earlier streams.
    pub(super) streamed_until: Option<SampleTime>,
    pub(super) written_at: Option<Moment>,
    /// Whether the encoder may still be storing data, calibrating or restarting, because a write ended early and the
    /// encoder was not returned to operation mode.
    pub unfinished: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Supply {
    /// Requested voltage in millivolts.
    pub millivolt: u16,
    /// Supply voltage in millivolts and current in milliamperes at switch-on. `None` until they are measured.
    pub measured: Option<(u16, u16)>,
}

impl Supply {
    /// Time from power-up until registers can be accessed (data sheet, 02:0Eh).
    pub(crate) const POWER_UP: Duration = Duration::from_millis(500);
    /// Supply voltages in millivolts that suit all versions of the kit encoder (manual, chapter 2: 4.75 to 12.5 V).
    pub(crate) const RANGE: std::ops::RangeInclusive<u16> = 4_750..=12_500;

    /// Returns the requested supply voltage with the allowed range of the kit encoder.
    pub(crate) const fn with_voltage(millivolt: u16) -> SupplyVoltage {
        SupplyVoltage { least: *Self::RANGE.start(), nominal: millivolt, greatest: *Self::RANGE.end() }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bus {
    pub(super) clock_hz: u32,
    pub(super) data_bits: u8,
    pub(super) crc_bits: u8,
}

impl Station {
    pub fn new(way: Transport, margin: Duration) -> Self {
        Station {
            transport: way,
            format: FORMAT,
            line: LineState::new(margin),
            order: None,
            timeout: REPLY_TIME_OUT,
            clock_hz: BusParameters::default().clock_hz,
            actual_clock_hz: None,
            supply: None,
            adapter: AdapterState::default(),
            description: None,
            identified: None,
            firmware: None,
            layout: None,
            given: None,
            source: None,
            reads_twice: false,
            noisy: false,
            bus: None,
            bank: None,
            crc_errors: 0,
            good_frames: false,
            flags: None,
            flow: None,
            streamed_until: None,
            written_at: None,
            unfinished: false,
        }
    }

    /// Creates the station from link parameters. Parameters that are not for the line are ignored.
    ///
    /// # Errors
    /// Returns an error with the allowed values if a value is invalid.
    pub fn from_query(query: &UrlQuery, way: Transport, margin: Duration) -> Result<Self, UrlError> {
        let pairs = query.pairs();
        let (pin, bus) = (PinParameters::read(pairs)?, BusParameters::read(pairs)?);
        let mut station = Station::new(way, LineParameters::read(pairs)?.margin.unwrap_or(margin));
        station.format = CharacterFormat { baud: pin.baud, parity: pin.parity };
        (station.order, station.line.echo, station.timeout) = (pin.order, pin.echo, pin.timeout);
        station.clock_hz = bus.clock_hz;
        station.supply = bus.millivolt.map(|millivolt| Supply { millivolt, measured: None });
        station.adapter.set_supply_after_session(bus.after);
        station.given = FrameParameters::read(pairs)?.layout(query)?;
        Ok(station)
    }

    /// Returns the layout of position frames. A layout from the data sheet or the link takes precedence over the
    /// description. If none is known, the layout of the kit encoder is used.
    pub fn frame_layout(&self) -> Layout {
        let described = || self.description.as_ref().and_then(|description| description.layout().cloned());
        self.layout.clone().or_else(described).unwrap_or_default()
    }

    /// Discards everything known about the adapter, so that it is identified and configured again.
    pub(super) fn forget_adapter(&mut self) {
        self.adapter.forget_identity();
        self.flow = None;
        self.forget_settings();
    }

    /// Discards the bus settings and the supply measurement, which no longer hold after a reset of the adapter.
    pub(super) fn forget_settings(&mut self) {
        (self.bank, self.bus) = (None, None);
        if let Some(supply) = &mut self.supply {
            supply.measured = None;
        }
    }

    /// Returns the number of frames with a wrong checksum since the last call, and resets the count.
    pub fn take_crc_errors(&mut self) -> u32 {
        std::mem::take(&mut self.crc_errors)
    }

    pub(super) fn is_split_known(&self) -> bool {
        self.source.is_none_or(FrameSource::is_known)
    }

    /// Returns whether values must be read twice, since a checksum misses some pairs of flipped bits.
    pub(super) fn requires_double_read(&self) -> bool {
        self.reads_twice || self.noisy
    }

    /// Returns whether reading back a register proves that a write succeeded. It proves nothing for a command register,
    /// which may still hold the same value from an earlier command.
    pub(super) fn is_readback_conclusive(&self, address: RegisterAddress) -> bool {
        if address == RegisterAddress::BANK_SELECT {
            return true;
        }
        let Some(description) = &self.description else { return false };
        description.access_at(address) == Some(Access::Rw) && !self.is_command_register(address)
    }

    /// Returns whether the register takes commands that run a procedure or save values.
    pub(super) fn is_command_register(&self, address: RegisterAddress) -> bool {
        self.description.as_ref().is_some_and(|description| {
            let saves = description.register_at(address).is_some_and(|register| !register.saves.is_empty());
            saves || description.procedures().iter().any(|procedure| procedure.command == address)
        })
    }
}

impl fmt::Display for Station {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.transport {
            Transport::ConfigPin => write!(f, "UBICOM at {}", self.format),
            Transport::Adapter => write!(f, "BiSS at {} Hz", self.actual_clock_hz.unwrap_or(self.clock_hz)),
        }
    }
}

impl FrameParameters {
    /// Returns the frame layout specified in the link. If the link specifies no checksum, the usual one is assumed.
    fn layout(self, query: &UrlQuery) -> Result<Option<Layout>, RejectedParameter> {
        let alone = |name: &str, allowed| RejectedParameter::new(name, query.get(name).unwrap_or_default(), allowed);
        let Some(singleturn) = self.singleturn else {
            let other = ["mt", "crc"].into_iter().find(|name| query.get(name).is_some());
            return other.map_or(Ok(None), |name| Err(alone(name, AllowedValues::OnlyWith("st"))));
        };
        let crc = self.crc.unwrap_or_else(|| Crc::new(Crc::POSITION, 0, true).ok());
        // Two widths of 32 bits leave no space for flags and checksum.
        let layout = Layout::new(self.multiturn.unwrap_or(0), singleturn, true, true, crc);
        layout.map(Some).map_err(|_| alone("st", AllowedValues::ShortFrame))
    }
}

/// Parses a checksum. Returns `Some(None)` if frames have no checksum.
fn read_crc(text: &str) -> Option<Option<Crc>> {
    if text == "none" {
        return Some(None);
    }
    let polynomial = u64::from_str_radix(text.strip_prefix("0x")?, 16).ok()?;
    Crc::new(polynomial, 0, true).ok().map(Some)
}

fn read_baud(text: &str) -> Option<Baud> {
    text.parse().ok().filter(|baud| (300..=4_000_000).contains(baud)).and_then(Baud::new)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::protocol::Descriptions;

    fn station(query: &str) -> Result<Station, UrlError> {
        Station::from_query(&query.parse().unwrap(), Transport::ConfigPin, Duration::from_millis(50))
    }

    #[test]
    fn omitted_parameters_are_probed_or_defaulted() {
        let station = station("").unwrap();
        assert_eq!(station.to_string(), "UBICOM at 115200 8N1");
        assert_eq!((station.order, station.line.echo), (None, Echo::Unknown));
        assert_eq!((station.timeout, station.line.margin), (Duration::from_millis(100), Duration::from_millis(50)));
        assert_eq!((station.clock_hz, station.supply, station.frame_layout().bits()), (1_000_000, None, 41));
    }

    #[test]
    fn parses_line_settings() {
        let station =
            station("baud=9600&parity=even&order=high-first&echo=on&timeout=250&margin=5&clock=80000&voltage=4.75")
                .unwrap();
        assert_eq!(station.to_string(), "UBICOM at 9600 8E1");
        assert_eq!((station.order, station.line.echo), (Some(ByteOrder::HighFirst), Echo::On));
        assert_eq!((station.timeout, station.line.margin), (Duration::from_millis(250), Duration::from_millis(5)));
        assert_eq!(station.clock_hz, 80_000);
        assert_eq!(station.supply, Some(Supply { millivolt: 4_750, measured: None }));
    }

    /// The frame consists of 12 multiturn bits, 19 singleturn bits, two flags, and CRC6 43h unless specified otherwise
    /// (issue 22.20).
    #[test]
    fn parses_frame_format_from_link() {
        let given = |query: &str| station(query).unwrap().given.map(|own| (own.data_bits(), own.crc_bits()));
        assert_eq!(given(""), None);
        assert_eq!(given("mt=12&st=19"), Some((33, 6)));
        assert_eq!(given("st=14&crc=0x13"), Some((16, 4)));
        assert_eq!(given("mt=0&st=14&crc=none"), Some((16, 0)));
    }

    #[test]
    fn rejection_lists_allowed_values() {
        let cases = [
            ("baud=0", "baud=0 is not valid (allowed: a bit rate from 300 to 4000000 bit/s, usually 115200)"),
            ("parity=mark", "parity=mark is not valid (allowed: none, even or odd)"),
            ("order=lsb", "order=lsb is not valid (allowed: auto, low-first or high-first)"),
            ("echo=yes", "echo=yes is not valid (allowed: auto, on or off)"),
            ("timeout=0", "timeout=0 is not valid (allowed: a time in milliseconds from 1 to 10000)"),
            ("margin=-1", "margin=-1 is not valid (allowed: a time in milliseconds from 0 to 2000)"),
            ("clock=10000001", "clock=10000001 is not valid (allowed: a frequency in hertz from 80000 to 10000000)"),
            ("clock=NaN", "clock=NaN is not valid (allowed: a frequency in hertz from 80000 to 10000000)"),
            ("mt=33&st=8", "mt=33 is not valid (allowed: a number of bits from 0 to 32)"),
            ("st=0", "st=0 is not valid (allowed: a number of bits from 1 to 32)"),
            ("mt=12", "mt=12 is not valid (allowed: only together with st)"),
            ("crc=0x43", "crc=0x43 is not valid (allowed: only together with st)"),
            (
                "st=8&crc=43",
                "crc=43 is not valid (allowed: a CRC polynomial including its highest term, such as 0x43, or \"none\")",
            ),
            (
                "mt=32&st=32",
                "st=32 is not valid (allowed: a frame of at most 64 bits, including the turns, two flags and the CRC)",
            ),
            ("leave-supply=no", "leave-supply=no is not valid (allowed: as-found, on or off)"),
            ("voltage=24", "voltage=24 is not valid (allowed: a voltage in volts from 4.75 to 12.5)"),
            ("voltage=NaN", "voltage=NaN is not valid (allowed: a voltage in volts from 4.75 to 12.5)"),
        ];
        for (query, message) in cases {
            assert_eq!(station(query).unwrap_err().to_string(), message);
        }
    }

    /// Only the bank selection, mode, password and data area registers can be read back after a write, according to
    /// appendix 9.1 of the manual. All other registers are commands, are read-only, or are not described.
    #[test]
    fn reads_back_only_retained_registers() {
        let mut station = Station::new(Transport::ConfigPin, Duration::ZERO);
        let tells = |station: &Station, text: &str| station.is_readback_conclusive(text.parse().unwrap());
        assert!(tells(&station, "0x40") && !tells(&station, "0x6B"), "nothing is known of the encoder yet");
        station.description = Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").cloned().map(Arc::new);
        for text in ["0x40", "0x6A", "0x6B", "0x01:0x02", "0x01:0x07", "0x04:0x00", "0x43:0x3F"] {
            assert!(tells(&station, text), "{text}");
        }
        let others = ["0x00:0x00", "0x00:0x06", "0x00:0x1A", "0x00:0x24", "0x01:0x00", "0x66", "0x02:0x05", "0x50"];
        for text in others {
            assert!(!tells(&station, text), "{text}");
        }
    }
}
