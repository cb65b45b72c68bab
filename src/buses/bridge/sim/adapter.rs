//! The virtual adapter, which handles requests, replies and streams byte by byte and simulates faults. Where the
//! reference leaves the behaviour open, this adapter replies a quarter of a millisecond after a request, or after the
//! 47 cycles of a control frame if the request needs one. HELLO ends all streams and leaves the supply unchanged. SSI
//! and BiSS share their wires, so only one of them can stream at a time.

use std::any::Any;
use std::time::Duration;

use fastrand::Rng;

use super::attached::{AttachedDevice, BissDevice};
use super::bus::Bus;
use super::clocking::{BissSetting, MAX_CLOCK_HZ, SsiSetting, nearest_available_clock};
use super::config::{Config, Shaft, Shared};
use super::stream::{ClockedStream, Kind, SampledStream};
use super::uart::Uart;
use crate::buses::bridge::protocol::{
    BissStatus, BodyError, Capabilities, ErrorCode, Hello, Message, Operation, Packet, Receiver, Reply, Request,
};
use crate::sim::line::TransitQueue;
use crate::sim::sine_cosine::{CheckedSettings, Quantity, Settings};
use crate::sim::{ByteDevice, Motor, SimulatedFaults};
use crate::units::{CharacterFormat, Moment};

#[derive(Clone)]
pub struct Adapter {
    bus: Bus,
    faults: SimulatedFaults,
    rng: Rng,
    switched_supply: bool,
    version: u8,
    receiver: Receiver,
    biss: Option<BissSetting>,
    ssi: Option<SsiSetting>,
    analog: Settings,
    clocked: Option<ClockedStream>,
    sampled: Option<SampledStream>,
    uart: Option<Uart>,
    requests: u32,
    pushed: u8,
    now: Moment,
    /// Time at which the transmission of the last reply ends.
    last_reply_end: Moment,
    /// Bytes on the way to the host, in order of arrival.
    to_host: TransitQueue<Vec<u8>>,
    inbox: Vec<u8>,
}

/// Error code and message for a rejected request.
type ErrorReply = (ErrorCode, &'static str);

const NOT_CONFIGURED: ErrorReply = (ErrorCode::BAD_ARGUMENT, "not configured yet");
const OUT_OF_RANGE: ErrorReply = (ErrorCode::BAD_ARGUMENT, "out of range");
const STREAMING: ErrorReply = (ErrorCode::BUSY, "a stream is running");
const ENCODER_SILENT: ErrorReply = (ErrorCode::NO_REPLY, "the encoder does not answer");
const MISSING_FEATURE: ErrorReply = (ErrorCode::NOT_SUPPORTED, "this adapter has no such thing");

impl Adapter {
    const MAX_SAMPLE_HZ: u32 = 1_000_000;
    const LATENCY: Duration = Duration::from_micros(250);
    const CONTROL_CYCLES: u32 = 47;
    /// Maximum number of pending replies, limited by the memory of a small controller. Further requests are lost.
    const MAX_PENDING_REPLIES: usize = 16;
    /// Range of the encoder's supply voltage in millivolts. See manual, chapter 2.
    const SUPPLY: std::ops::RangeInclusive<u16> = 4_750..=15_000;
    const SUPPLY_MILLIWATT: u32 = 300;

    /// Creates the virtual adapter with the given devices. If several devices use the same connector, the last of them
    /// is connected.
    pub(super) fn new(config: &Config, shared: &Shared, shaft: &Shaft, attached: Vec<AttachedDevice>) -> Self {
        let mut adapter = Adapter {
            bus: Bus::new(config, shared, shaft),
            faults: shared.faults.clone(),
            rng: Rng::with_seed(shared.seed),
            switched_supply: config.switched_supply,
            version: config.version,
            receiver: Receiver::default(),
            biss: None,
            ssi: None,
            analog: Settings { seed: shared.seed, ..Settings::default() },
            clocked: None,
            sampled: None,
            uart: None,
            requests: 0,
            pushed: 0,
            now: Moment::START,
            last_reply_end: Moment::START,
            to_host: TransitQueue::default(),
            inbox: Vec::new(),
        };
        for device in attached {
            match device {
                AttachedDevice::Biss(device) => adapter.bus.biss = Some(device),
                AttachedDevice::Ssi(device) => adapter.bus.ssi = Some(device),
                AttachedDevice::Serial(device) => adapter.uart = Some(Uart::new(device)),
            }
        }
        adapter.switch_off();
        let rpm = adapter.motor().rpm();
        adapter.analog = adapter.analog.with_value(Quantity::Speed, rpm);
        if let Some(uart) = &mut adapter.uart {
            uart.set_rpm(Moment::START, rpm);
        }
        adapter
    }

    /// Returns the BiSS device if its type is `T`. Tests use it to inspect the device and to set its temperature or
    /// errors.
    pub fn device<T: BissDevice>(&self) -> Option<&T> {
        let device: &dyn Any = &**self.bus.biss.as_ref()?;
        device.downcast_ref()
    }

    pub fn device_mut<T: BissDevice>(&mut self) -> Option<&mut T> {
        let device: &mut dyn Any = &mut **self.bus.biss.as_mut()?;
        device.downcast_mut()
    }

    pub fn motor(&self) -> Motor {
        self.bus.motor()
    }

    /// Changes the speed of the shaft from `now` on.
    pub fn set_rpm(&mut self, now: Moment, rpm: f64) {
        self.advance_to(now);
        self.bus.set_rpm(self.now, rpm);
        self.follow_motor();
    }

    fn follow_motor(&mut self) {
        self.bus.follow_motor(self.now);
        let rpm = self.motor().rpm();
        if rpm == self.analog.speed_rpm {
            return;
        }
        self.analog.speed_rpm = rpm;
        if let Some(uart) = &mut self.uart {
            uart.set_rpm(self.now, rpm);
        }
        if let (Some(stream), Ok(settings)) = (&mut self.sampled, self.analog.clone().validate()) {
            stream.change_settings(self.now, settings);
        }
    }

    /// Replaces the simulated faults. The counters of requests and stores are not reset.
    pub fn set_faults(&mut self, faults: &SimulatedFaults) {
        self.faults = faults.clone();
        if let Some(device) = &mut self.bus.biss {
            device.set_faults(faults);
        }
    }

    fn advance_to(&mut self, to: Moment) {
        self.now = self.now.max(to);
        let mut packets = Vec::new();
        if let Some(stream) = &mut self.clocked {
            let (bus, kind) = (&mut self.bus, stream.kind);
            let biss_bits = self.biss.map_or(0, |setting| setting.bits);
            let ssi_bits = self.ssi.map_or(0, |setting| setting.clocks);
            packets.extend(stream.run(self.now, |at| match kind {
                Kind::Biss => bus.frame_at(at, biss_bits),
                Kind::Ssi => (BissStatus::OK, bus.word_at(at, ssi_bits)),
            }));
        }
        if let Some(stream) = &mut self.sampled {
            packets.extend(stream.run(self.now, self.bus.is_supplied));
        }
        packets.sort_by_key(|(at, _)| *at);
        for (at, data) in packets {
            let packet = Message::Data(data).emit(self.pushed);
            self.pushed = self.pushed.wrapping_add(1);
            self.send(at + Self::LATENCY, &packet);
        }
        self.follow_motor();
        while let Some(bytes) = self.to_host.pop_until(self.now) {
            self.inbox.extend(bytes);
        }
    }

    fn send(&mut self, at: Moment, packet: &Packet) {
        let bytes = add_noise(&self.faults, &mut self.rng, &packet.emit());
        self.to_host.insert(at, bytes);
    }

    fn handle_packet(&mut self, packet: &Packet) {
        if self.to_host.len() >= Self::MAX_PENDING_REPLIES {
            return;
        }
        let silent = self.faults.silent_after().is_some_and(|requests| requests <= self.requests);
        self.requests = self.requests.saturating_add(1);
        if silent {
            // A silent adapter does nothing, so its streams end too.
            (self.clocked, self.sampled) = (None, None);
            return;
        }
        let refused = |(code, text): ErrorReply| Message::Error { op: packet.op, code, text: text.to_owned() };
        let (message, time) = match Request::parse(packet) {
            Err(BodyError::Operation(_)) => (refused(MISSING_FEATURE), Duration::ZERO),
            Err(_) => (refused(OUT_OF_RANGE), Duration::ZERO),
            Ok(request) => {
                let time = self.time(&request);
                (self.execute(request).map_or_else(refused, Message::Reply), time)
            }
        };
        let mut reply = message.emit(packet.seq);
        if let (Message::Reply(Reply::Hello(_)), Some(version)) = (&message, reply.body.first_mut()) {
            *version = self.version;
        }
        self.last_reply_end = self.last_reply_end.max(self.now) + Self::LATENCY + time + self.faults.reply_delay();
        self.send(self.last_reply_end, &reply);
    }

    /// Returns how long the adapter processes a request, excluding transmission.
    fn time(&self, request: &Request) -> Duration {
        let frame = self.biss.map_or(Duration::ZERO, |setting| setting.frame_duration());
        match request.operation() {
            Operation::SsiRead => self.ssi.map_or(Duration::ZERO, SsiSetting::burst_duration),
            Operation::BissRead => frame,
            Operation::BissRegisterRead | Operation::BissRegisterWrite => frame * Self::CONTROL_CYCLES,
            _ => Duration::ZERO,
        }
    }

    fn execute(&mut self, request: Request) -> Result<Reply, ErrorReply> {
        let t_us = adapter_microseconds(self.now);
        let operation = request.operation();
        let stops = matches!(request, Request::SsiStream { period_us: 0 } | Request::BissStream { period_us: 0 });
        let clocked = (Operation::SsiConfig.byte()..=Operation::BissStream.byte()).contains(&operation.byte());
        if clocked && !stops && self.clocked.is_some() || operation == Operation::AnalogConfig && self.sampled.is_some()
        {
            return Err(STREAMING);
        }
        match request {
            Request::Hello => Ok(Reply::Hello(self.identify())),
            Request::Supply { on, millivolt } => self.switch_supply(on, millivolt),
            Request::SsiConfig { clocks, clock_hz, pause_us, .. } => {
                let actual =
                    nearest_available_clock(clock_hz).filter(|_| (1..=64).contains(&clocks)).ok_or(OUT_OF_RANGE)?;
                self.ssi = Some(SsiSetting { clock_hz: actual, clocks, pause_us });
                Ok(Reply::SsiConfig { clock_hz: actual })
            }
            Request::SsiRead => {
                let setting = self.ssi.ok_or(NOT_CONFIGURED)?;
                Ok(Reply::SsiRead { t_us, raw: self.bus.word_at(self.now, setting.clocks) })
            }
            Request::SsiStream { period_us } => {
                let setting = self.ssi.ok_or(NOT_CONFIGURED)?;
                let period_us = self.start_stream(Kind::Ssi, period_us, setting.min_period_us(), setting.clocks);
                Ok(Reply::SsiStream { period_us })
            }
            Request::BissConfig { clock_hz, data_bits, crc_bits, timeout_us } => {
                let bits = data_bits.checked_add(crc_bits).filter(|bits| (1..=64).contains(bits) && data_bits > 0);
                let (bits, clock_hz) = bits.zip(nearest_available_clock(clock_hz)).ok_or(OUT_OF_RANGE)?;
                self.biss = Some(BissSetting { clock_hz, bits, timeout_us });
                Ok(Reply::BissConfig { clock_hz })
            }
            Request::BissRead => {
                let setting = self.biss.ok_or(NOT_CONFIGURED)?;
                let (status, raw) = self.bus.frame_at(self.now, setting.bits);
                Ok(Reply::BissRead { t_us, status, raw })
            }
            Request::BissRegisterRead { slave, address } => {
                let value = self.register(slave, address, None)?;
                Ok(Reply::BissRegisterRead { value })
            }
            Request::BissRegisterWrite { slave, address, value } => {
                let value = self.register(slave, address, Some(value))?;
                Ok(Reply::BissRegisterWrite { value })
            }
            Request::BissStream { period_us } => {
                let setting = self.biss.ok_or(NOT_CONFIGURED)?;
                let least = u32::try_from(setting.frame_duration().as_micros()).unwrap_or(u32::MAX);
                let period_us = self.start_stream(Kind::Biss, period_us, least, setting.bits);
                Ok(Reply::BissStream { period_us })
            }
            // The virtual adapter samples both signals at the same time, and its faults are simulated.
            Request::Status | Request::AnalogSkew => Err(MISSING_FEATURE),
            Request::AnalogConfig { sample_hz } => {
                let checked = self.analog.clone().with_value(Quantity::Rate, f64::from(sample_hz)).validate();
                self.analog = checked.map_err(|_| OUT_OF_RANGE)?.settings().clone();
                let period_ns = self.analog.period_ns().unsigned_abs().max(1);
                // The rate is at most a million.
                let sample_hz = u32::try_from(1_000_000_000 / period_ns).unwrap_or(Self::MAX_SAMPLE_HZ);
                let full_scale_microvolt = SampledStream::FULL_SCALE_MICROVOLT;
                Ok(Reply::AnalogConfig { sample_hz, full_scale_microvolt, bits: 16 })
            }
            Request::AnalogStream { on } => {
                let settings: CheckedSettings = self.analog.clone().validate().map_err(|_| OUT_OF_RANGE)?;
                match (on, &self.sampled) {
                    (true, Some(_)) => return Err(STREAMING),
                    (true, None) => self.sampled = Some(SampledStream::new(self.now, settings)),
                    (false, _) => self.sampled = None,
                }
                Ok(Reply::AnalogStream { on })
            }
            Request::UartConfig { baud, parity, .. } => {
                let set = self.uart.as_mut().ok_or(MISSING_FEATURE)?.configure(self.now, baud, parity);
                if set { Ok(Reply::UartConfig { baud }) } else { Err(OUT_OF_RANGE) }
            }
            Request::UartTransfer { timeout_us, idle_us, tx } => {
                let [timeout, idle] = [timeout_us, idle_us].map(|time| Duration::from_micros(time.into()));
                let transfer = self.uart.as_mut().ok_or(MISSING_FEATURE)?.transfer(self.now, timeout, idle, &tx);
                let transfer = transfer.ok_or(NOT_CONFIGURED)?;
                self.last_reply_end = self.last_reply_end.max(transfer.end);
                Ok(Reply::UartTransfer { t_us: adapter_microseconds(transfer.start), rx: transfer.rx })
            }
        }
    }

    fn identify(&mut self) -> Hello {
        (self.clocked, self.sampled) = (None, None);
        let is_supplied = self.switched_supply && self.bus.is_supplied;
        let can = Capabilities::SSI
            .union(Capabilities::BISS)
            .union(Capabilities::BISS_REGISTERS)
            .union(Capabilities::ANALOG)
            .union(if self.switched_supply { Capabilities::SUPPLY } else { Capabilities::new(0) })
            .union(if is_supplied { Capabilities::SUPPLY_ON } else { Capabilities::new(0) })
            .union(if self.uart.is_some() { Capabilities::UART } else { Capabilities::new(0) });
        Hello {
            capabilities: can,
            max_clock_hz: MAX_CLOCK_HZ,
            max_sample_hz: Self::MAX_SAMPLE_HZ,
            name: "virtual adapter".to_owned(),
            serial: "V0001".to_owned(),
            firmware: "1.0".to_owned(),
        }
    }

    fn switch_off(&mut self) {
        if self.switched_supply {
            self.bus.is_supplied = false;
            if let Some(device) = &mut self.bus.biss {
                device.disconnect();
            }
        }
    }

    fn switch_supply(&mut self, on: bool, millivolt: u16) -> Result<Reply, ErrorReply> {
        if !self.switched_supply {
            return Err(MISSING_FEATURE);
        }
        if !on {
            self.switch_off();
            return Ok(Reply::Supply { on, millivolt: 0, milliampere: 0 });
        }
        if !Self::SUPPLY.contains(&millivolt) {
            return Err(OUT_OF_RANGE);
        }
        self.bus.is_supplied = true;
        if let Some(device) = &mut self.bus.biss {
            device.connect(self.now);
        }
        let milliampere = u16::try_from(Self::SUPPLY_MILLIWATT * 1000 / u32::from(millivolt)).unwrap_or(u16::MAX);
        Ok(Reply::Supply { on, millivolt, milliampere })
    }

    /// Reads a register. If `value` is `Some`, it is written to the register first.
    fn register(&mut self, slave: u8, address: u8, value: Option<u8>) -> Result<u8, ErrorReply> {
        self.biss.ok_or(NOT_CONFIGURED)?;
        let has_address = self.bus.biss.as_ref().is_none_or(|device| device.has_address(address));
        if !has_address || slave >= 8 {
            return Err(OUT_OF_RANGE);
        }
        let now = self.now;
        let device = self.bus.readable_device(now).filter(|_| slave == 0).ok_or(ENCODER_SILENT)?;
        if let Some(value) = value {
            let accepted = device.write_register(now, address, value);
            if !device.has_power() {
                return Err(ENCODER_SILENT);
            }
            if accepted && !device.can_access_registers(now) {
                // The encoder returned the value before it restarted or began a calibration.
                return Ok(value);
            }
        }
        device.read_register(now, address).ok_or((ErrorCode::NO_REPLY, "the encoder refuses the register"))
    }

    /// Starts or ends a stream. Returns the actual period in microseconds.
    fn start_stream(&mut self, kind: Kind, period_us: u32, least_us: u32, bits: u8) -> u32 {
        if period_us == 0 {
            self.clocked = self.clocked.take().filter(|stream| stream.kind != kind);
            return 0;
        }
        let period_us = period_us.max(least_us);
        let start = self.last_reply_end.max(self.now) + Self::LATENCY;
        self.clocked = Some(ClockedStream::new(kind, start, Duration::from_micros(period_us.into()), bits));
        period_us
    }
}

/// Converts a moment to microseconds of the adapter's clock.
fn adapter_microseconds(at: Moment) -> u64 {
    u64::try_from(at.since_start().as_micros()).unwrap_or(u64::MAX)
}

fn add_noise(faults: &SimulatedFaults, rng: &mut Rng, bytes: &[u8]) -> Vec<u8> {
    let passages = bytes.iter().map(|byte| faults.transmit_byte(rng, *byte));
    passages
        .flat_map(|passage| passage.inserted.into_iter().chain(passage.carried.map(|carried| carried.byte)))
        .collect()
}

impl ByteDevice for Adapter {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.advance_to(now);
        let received = add_noise(&self.faults, &mut self.rng, bytes);
        self.receiver.push(&received);
        while let Some(packet) = self.receiver.next_packet() {
            self.handle_packet(&packet);
        }
    }

    fn poll(&mut self, now: Moment) -> Vec<u8> {
        self.advance_to(now);
        std::mem::take(&mut self.inbox)
    }

    fn poll_at(&self) -> Option<Moment> {
        if !self.inbox.is_empty() {
            return Some(self.now);
        }
        let clocked = self.clocked.as_ref().map(ClockedStream::next_packet_time);
        let sampled = self.sampled.as_ref().map(SampledStream::next_packet_time);
        [self.to_host.next_due(), clocked, sampled].into_iter().flatten().min()
    }

    /// Ignores the format, since a serial port over USB has no baud rate.
    fn set_host_format(&mut self, now: Moment, _format: CharacterFormat) {
        self.advance_to(now);
    }

    fn connect(&mut self, now: Moment) {
        self.advance_to(now);
        self.inbox.clear();
        if !self.switched_supply
            && let Some(device) = &mut self.bus.biss
        {
            device.connect(self.now);
        }
    }
}
