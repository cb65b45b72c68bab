//! A host for the virtual adapter in virtual time, and devices to attach in tests.

use std::time::Duration;

use crate::buses::bridge::protocol::*;
use crate::buses::bridge::sim::{Adapter, AttachableKind, AttachedDevice, BissDevice, SsiDevice};
use crate::parameter::ParameterValues as _;
use crate::sim::setting::query_pairs;
use crate::sim::{ByteDevice, ConfigError, Motor, RPM, SimulatedFaults};
use crate::units::Moment;

/// The host of the adapter.
pub(crate) struct Host {
    pub(crate) adapter: Adapter,
    pub(crate) receiver: Receiver,
    pub(crate) seq: u8,
    pub(crate) now: Moment,
}

pub(crate) const BISS: Request =
    Request::BissConfig { clock_hz: 2_000_000, data_bits: 35, crc_bits: 6, timeout_us: 18 };
pub(crate) const SSI: Request =
    Request::SsiConfig { clocks: 25, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE };

impl Host {
    /// Creates a host with an adapter to which the test devices are attached.
    pub(crate) fn with(query: &str) -> Self {
        Self::to(query, &[&SsiTestEncoder, &TestBissDevice::SETTINGS])
    }

    /// Creates a host with an adapter to which the given devices are attached.
    pub(crate) fn to(query: &str, devices: &[&dyn AttachableKind]) -> Self {
        let adapter = Adapter::from_pairs(&query_pairs(query), devices).unwrap();
        Host { adapter, receiver: Receiver::default(), seq: 0, now: Moment::START }
    }

    pub(crate) fn send(&mut self, request: &Request) {
        self.seq += 1;
        self.adapter.on_bytes(self.now, &request.emit(self.seq).emit());
    }

    /// Returns the messages received up to the given time.
    pub(crate) fn receive(&mut self, until: Moment) -> Vec<(u8, Message)> {
        while let Some(at) = self.adapter.poll_at().filter(|at| *at <= until) {
            self.now = self.now.max(at);
            let bytes = self.adapter.poll(self.now);
            self.receiver.push(&bytes);
        }
        self.now = self.now.max(until);
        let packets = std::iter::from_fn(|| self.receiver.next_packet());
        packets.map(|packet| (packet.seq, Message::parse(&packet).unwrap())).collect()
    }

    /// Returns the reply to a request. There must be exactly one within 100 ms.
    pub(crate) fn ask(&mut self, request: Request) -> Option<Message> {
        self.send(&request);
        let mut messages = self.receive(self.now + Duration::from_millis(100));
        messages.retain(|(_, message)| !matches!(message, Message::Data(_)));
        assert!(messages.len() <= 1, "{messages:?}");
        let (seq, message) = messages.pop()?;
        assert_eq!(seq, self.seq);
        Some(message)
    }

    #[track_caller]
    pub(crate) fn expect(&mut self, request: Request, reply: Reply) {
        assert_eq!(self.ask(request), Some(Message::Reply(reply)));
    }

    #[track_caller]
    pub(crate) fn refuses(&mut self, request: Request, expected: ErrorCode) {
        let own = request.operation().byte();
        match self.ask(request) {
            Some(Message::Error { op, code, text }) => {
                assert_eq!((op, code), (own, expected), "{text}");
                assert!(!text.is_empty());
            }
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn stream(&mut self, milliseconds: u64) -> Vec<StreamData> {
        let messages = self.receive(self.now + Duration::from_millis(milliseconds));
        let data = |(_, message)| match message {
            Message::Data(data) => Some(data),
            _ => None,
        };
        messages.into_iter().filter_map(data).collect()
    }
}

/// A BiSS device with a position of 35 bits, 17 of them within a revolution, followed by six other bits. Its registers
/// store any value that is written. Its shaft is at 270° of turn 1234h, and the device needs half a second to start.
pub(crate) struct TestBissDevice {
    motor: Motor,
    revolutions: f64,
    now: Moment,
    /// Time at which the device has started, or `None` if its power is off.
    ready: Option<Moment>,
    registers: [u8; 0x80],
}

/// Settings of a dial.
pub(crate) struct DialSettings;

/// SSI device that sends the position of the shaft: 12 turn bits and 13 step bits.
pub(crate) struct SsiTestEncoder;

impl TestBissDevice {
    pub(crate) const SETTINGS: DialSettings = DialSettings;
    const PER_TURN: u64 = 1 << 17;
    const START: Duration = Duration::from_millis(500);

    fn advance(&mut self, to: Moment) {
        self.revolutions += self.motor.rpm() / 60.0 * to.duration_since(self.now).as_secs_f64();
        self.now = self.now.max(to);
    }

    fn steps(&mut self, at: Moment) -> Option<u64> {
        self.advance(at);
        self.ready.filter(|ready| *ready <= at).map(|_| (self.revolutions * Self::PER_TURN as f64) as u64)
    }
}

impl AttachableKind for DialSettings {
    fn setting_names(&self) -> &'static [&'static str] {
        &["rpm", "seed", "fault"]
    }

    fn attach_device(&self, pairs: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError> {
        let mut rpm = 0.0;
        for (key, value) in pairs.iter().filter(|(key, _)| key == "rpm") {
            rpm = RPM.parse_value(key, value)?;
        }
        let revolutions = f64::from(0x1234) + 0.75;
        let (motor, registers) = (Motor::with_speed(rpm), [0x61; 0x80]);
        let dial = TestBissDevice { motor, revolutions, now: Moment::START, ready: Some(Moment::START), registers };
        Ok(Some(AttachedDevice::Biss(Box::new(dial))))
    }
}

impl BissDevice for TestBissDevice {
    fn clone_device(&self) -> Box<dyn BissDevice> {
        Box::new(TestBissDevice { motor: Motor::with_speed(self.motor.rpm()), ..*self })
    }

    fn frame_at(&mut self, at: Moment) -> Option<(u64, u8)> {
        self.steps(at).map(|steps| (steps << 6, 41))
    }

    fn shaft_position(&mut self, at: Moment) -> Option<(u64, u64)> {
        self.steps(at).map(|steps| (steps, Self::PER_TURN))
    }

    fn motor(&self) -> Motor {
        self.motor.clone()
    }

    fn set_rpm(&mut self, now: Moment, rpm: f64) {
        self.advance(now);
        self.motor.set_rpm(rpm);
    }

    fn set_faults(&mut self, _: &SimulatedFaults) {}

    fn disconnect(&mut self) {
        self.ready = None;
    }

    fn connect(&mut self, now: Moment) {
        self.ready = self.ready.or(Some(now + Self::START));
    }

    fn has_power(&self) -> bool {
        self.ready.is_some()
    }

    fn can_access_registers(&mut self, now: Moment) -> bool {
        self.steps(now).is_some()
    }

    fn has_address(&self, address: u8) -> bool {
        usize::from(address) < self.registers.len()
    }

    fn read_register(&mut self, _: Moment, address: u8) -> Option<u8> {
        self.registers.get(usize::from(address)).copied()
    }

    fn write_register(&mut self, _: Moment, address: u8, value: u8) -> bool {
        self.registers[usize::from(address)] = value;
        true
    }
}

impl AttachableKind for SsiTestEncoder {
    fn setting_names(&self) -> &'static [&'static str] {
        &[]
    }

    fn attach_device(&self, _: &[(String, String)]) -> Result<Option<AttachedDevice>, ConfigError> {
        Ok(Some(AttachedDevice::Ssi(Box::new(SsiTestEncoder))))
    }
}

impl SsiDevice for SsiTestEncoder {
    fn clone_device(&self) -> Box<dyn SsiDevice> {
        Box::new(SsiTestEncoder)
    }

    fn word_at(&mut self, _: Moment, (steps, per_turn): (u64, u64)) -> (u64, u8) {
        (steps / (per_turn >> 13) % (1 << 25), 25)
    }
}
