//! The adapter, which executes the host's requests and sends replies and streams.
//!
//! SSI and BiSS share their wires, so a stream of one bus also blocks the other. HELLO ends the streams and leaves the
//! supply unchanged.

use alloc::borrow::ToOwned;
use alloc::string::String;

use bridge_codec::{
    AdapterStatus, BodyError, Capabilities, ErrorCode, Hello, Message, Operation, Packet, Receiver, Reply, Request,
    RestartReason,
};

use crate::analog::AnalogStream;
use crate::supply::Supply;
use crate::uart::Transfer;
use crate::{
    AnalogSetting, BissSetting, Bus, ClockedStream, Clocking, Correction, Frame, Outbox, Refusal, RegisterAccess,
    SsiSetting, UartSetting, access_register,
};

/// Identity that an adapter reports, and the corrections for its analogue inputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Name of the adapter.
    pub name: &'static str,
    /// Serial number.
    pub serial: String,
    /// Version of the firmware.
    pub firmware: &'static str,
    /// Capabilities of this build.
    pub capabilities: Capabilities,
    /// Reason for the last start.
    pub restart: RestartReason,
    /// Corrections for sine and cosine.
    pub corrections: [Correction; 2],
}

/// An adapter on a [`Bus`].
#[derive(Debug)]
pub struct Adapter<B> {
    bus: B,
    identity: Identity,
    receiver: Receiver,
    outbox: Outbox,
    ssi: Option<SsiSetting>,
    biss: Option<BissSetting>,
    /// Bus and settings that the hardware currently uses.
    selected: Option<Clocking>,
    stream: Option<ClockedStream>,
    analog: Option<AnalogSetting>,
    sampled: Option<AnalogStream>,
    supply: Supply,
    uart: Option<UartSetting>,
    transfer: Option<Transfer>,
    /// Time in microseconds before which the serial line must not be driven.
    line_free_us: u64,
    /// Earliest time for the next frame, in microseconds.
    free_us: u64,
    /// Sequence number of the next stream packet.
    stream_seq: u8,
    /// Number of packets with a valid checksum but invalid content.
    malformed: u32,
    /// Number of samples lost because the host did not fetch them in time.
    lost: u32,
}

const NOT_CONFIGURED: Refusal = (ErrorCode::BAD_ARGUMENT, "not configured yet");
const MALFORMED: Refusal = (ErrorCode::BAD_ARGUMENT, "malformed request");
const STREAMING: Refusal = (ErrorCode::BUSY, "a stream is running");
const TRANSFERRING: Refusal = (ErrorCode::BUSY, "a transfer is running");
const NOT_SUPPORTED: Refusal = (ErrorCode::NOT_SUPPORTED, "this adapter does not support the operation");

impl<B: Bus> Adapter<B> {
    /// Creates an adapter without streams or settings.
    pub fn new(bus: B, identity: Identity) -> Self {
        Adapter {
            bus,
            identity,
            receiver: Receiver::default(),
            outbox: Outbox::default(),
            ssi: None,
            biss: None,
            selected: None,
            stream: None,
            analog: None,
            sampled: None,
            supply: Supply::new(),
            uart: None,
            transfer: None,
            line_free_us: 0,
            free_us: 0,
            stream_seq: 0,
            malformed: 0,
            lost: 0,
        }
    }

    /// Returns a reference to the hardware.
    pub const fn bus(&self) -> &B {
        &self.bus
    }

    /// Returns a mutable reference to the hardware.
    pub const fn bus_mut(&mut self) -> &mut B {
        &mut self.bus
    }

    /// Returns the bytes to be sent to the host.
    pub const fn outbox(&mut self) -> &mut Outbox {
        &mut self.outbox
    }

    /// Returns whether [`receive`](Self::receive) may be called. If not, the host must wait.
    pub fn accepts_bytes(&self) -> bool {
        self.outbox.has_room()
    }

    /// Returns whether a transfer on the serial line is in progress.
    pub const fn is_transferring(&self) -> bool {
        self.transfer.is_some()
    }

    /// Returns whether a stream is running.
    pub const fn is_streaming(&self) -> bool {
        self.stream.is_some() || self.sampled.is_some()
    }

    /// Returns two counts: damaged packets, and packets with invalid content.
    pub const fn faulty_packets(&self) -> (u64, u32) {
        (self.receiver.dropped_count(), self.malformed)
    }

    /// Takes bytes from the host, and executes all requests that are complete.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.receiver.push(bytes);
        while let Some(packet) = self.receiver.next_packet() {
            if let Some(message) = self.answer(&packet) {
                self.send(&message, packet.seq);
            }
        }
    }

    /// Sends the available samples. If the host has stopped fetching data, ends the streams.
    pub fn poll(&mut self) {
        if self.outbox.is_stuck(self.bus.now_us()) {
            self.handle_host_disconnect();
        }
        self.supply.poll(&mut self.bus);
        self.poll_transfer();
        while self.outbox.has_room() {
            let clocked = self.stream.as_mut().and_then(|stream| stream.packet(&self.bus));
            let sampled = self.sampled.as_mut().and_then(|stream| stream.packet(&mut self.bus));
            if clocked.is_none() && sampled.is_none() {
                return;
            }
            for data in [clocked, sampled].into_iter().flatten() {
                self.lost = self.lost.saturating_add(data.sample_range().2.into());
                self.send(&Message::Data(data), self.stream_seq);
                self.stream_seq = self.stream_seq.wrapping_add(1);
            }
        }
    }

    /// Ends the streams and discards unsent bytes after the host has disconnected.
    pub fn handle_host_disconnect(&mut self) {
        self.stop_streams();
        if self.transfer.take().is_some() {
            self.bus.end_transfer();
        }
        self.outbox.clear();
        self.receiver = Receiver::default();
    }

    fn send(&mut self, message: &Message, seq: u8) {
        self.outbox.push(&message.emit(seq).emit(), self.bus.now_us());
    }

    fn poll_transfer(&mut self) {
        let Some((transfer, setting)) = self.transfer.as_mut().zip(self.uart) else { return };
        let seq = transfer.seq;
        if let Some((t_us, rx)) = transfer.poll(&mut self.bus, setting) {
            self.transfer = None;
            self.line_free_us = Transfer::free_us(self.bus.now_us(), setting);
            self.send(&Message::Reply(Reply::UartTransfer { t_us, rx }), seq);
        }
    }

    /// Returns the reply to a request, or `None` if the reply will follow later.
    fn answer(&mut self, packet: &Packet) -> Option<Message> {
        let answer = match Request::parse(packet) {
            Ok(Request::UartTransfer { timeout_us, idle_us, tx }) => {
                match self.begin_transfer((packet.seq, timeout_us, idle_us), &tx) {
                    Ok(()) => return None,
                    Err(refusal) => Err(refusal),
                }
            }
            Ok(request) => self.execute(&request).map(Message::Reply),
            Err(error) => {
                self.malformed = self.malformed.saturating_add(1);
                Err(if matches!(error, BodyError::Operation(_)) { NOT_SUPPORTED } else { MALFORMED })
            }
        };
        let refused = |(code, text): Refusal| Message::Error { op: packet.op, code, text: text.to_owned() };
        Some(answer.unwrap_or_else(refused))
    }

    fn execute(&mut self, request: &Request) -> Result<Reply, Refusal> {
        let operation = request.operation();
        let is_stop = matches!(request, Request::SsiStream { period_us: 0 } | Request::BissStream { period_us: 0 });
        if is_clocked(operation) && !is_stop && self.stream.is_some()
            || operation == Operation::AnalogConfig && self.sampled.is_some()
        {
            return Err(STREAMING);
        }
        match *request {
            Request::Hello => Ok(Reply::Hello(self.hello())),
            Request::SsiConfig { clocks, clock_hz, pause_us, flags } => {
                let setting = SsiSetting::new(clocks, clock_hz, pause_us, flags)?;
                self.ssi = Some(setting);
                Ok(Reply::SsiConfig { clock_hz: setting.clock_hz() })
            }
            Request::SsiRead => {
                let setting = self.ssi.ok_or(NOT_CONFIGURED)?;
                let Frame { t_us, words } = self.frame(Clocking::Ssi(setting), false);
                Ok(Reply::SsiRead { t_us, raw: words.join(setting.clocks) as u64 })
            }
            Request::SsiStream { period_us } => {
                let setting = self.ssi.ok_or(NOT_CONFIGURED)?;
                let period_us = self.stream(Clocking::Ssi(setting), period_us, setting.least_period_us());
                Ok(Reply::SsiStream { period_us })
            }
            Request::BissConfig { clock_hz, data_bits, crc_bits, timeout_us } => {
                let setting = BissSetting::new(clock_hz, data_bits, crc_bits, timeout_us)?;
                self.biss = Some(setting);
                Ok(Reply::BissConfig { clock_hz: setting.clock_hz() })
            }
            Request::BissRead => {
                let setting = self.biss.ok_or(NOT_CONFIGURED)?;
                let Frame { t_us, words } = self.frame(Clocking::Biss(setting), false);
                let frame = setting.decode(words);
                Ok(Reply::BissRead { t_us, status: frame.status, raw: frame.raw })
            }
            Request::BissRegisterRead { slave, address } => {
                let value = self.register(RegisterAccess { slave, address, value: None })?;
                Ok(Reply::BissRegisterRead { value })
            }
            Request::BissRegisterWrite { slave, address, value } => {
                let value = self.register(RegisterAccess { slave, address, value: Some(value) })?;
                Ok(Reply::BissRegisterWrite { value })
            }
            Request::BissStream { period_us } => {
                let setting = self.biss.ok_or(NOT_CONFIGURED)?;
                let period_us = self.stream(Clocking::Biss(setting), period_us, setting.least_period_us());
                Ok(Reply::BissStream { period_us })
            }
            Request::Status => Ok(Reply::Status(self.status())),
            Request::AnalogConfig { sample_hz } => {
                self.requires(Capabilities::ANALOG)?;
                let setting = AnalogSetting::new(sample_hz)?;
                self.analog = Some(setting);
                Ok(Reply::AnalogConfig {
                    sample_hz: setting.sample_hz(),
                    full_scale_microvolt: AnalogSetting::FULL_SCALE_MICROVOLT,
                    bits: AnalogSetting::BITS,
                })
            }
            Request::AnalogStream { on } => {
                self.requires(Capabilities::ANALOG)?;
                let setting = self.analog.ok_or(NOT_CONFIGURED)?;
                match on {
                    true if self.sampled.is_some() => return Err(STREAMING),
                    true => {
                        let corrections = self.identity.corrections;
                        self.sampled = Some(AnalogStream::begin(setting, corrections, &mut self.bus));
                    }
                    false => self.stop_sampling(),
                }
                Ok(Reply::AnalogStream { on })
            }
            Request::AnalogSkew => {
                self.requires(Capabilities::ANALOG_SKEW)?;
                Ok(Reply::AnalogSkew { skew_ns: AnalogSetting::SKEW_NS })
            }
            Request::UartConfig { baud, parity, turnaround_us } => {
                self.requires(Capabilities::UART)?;
                if self.transfer.is_some() {
                    return Err(TRANSFERRING);
                }
                let setting = UartSetting::new(baud, parity, turnaround_us)?;
                self.bus.configure_uart(setting);
                self.uart = Some(setting);
                Ok(Reply::UartConfig { baud })
            }
            Request::Supply { on, millivolt } => {
                self.requires(Capabilities::SUPPLY)?;
                let millivolt = self.supply.switch(&mut self.bus, on, millivolt)?;
                // The switch limits the current but does not measure it.
                Ok(Reply::Supply { on, millivolt, milliampere: 0 })
            }
            // Transfers are handled before, because their replies follow later.
            Request::UartTransfer { .. } => Err(NOT_SUPPORTED),
        }
    }

    fn begin_transfer(&mut self, times: (u8, u32, u32), tx: &[u8]) -> Result<(), Refusal> {
        self.requires(Capabilities::UART)?;
        let setting = self.uart.ok_or(NOT_CONFIGURED)?;
        if self.transfer.is_some() {
            return Err(TRANSFERRING);
        }
        self.bus.wait_until(self.line_free_us);
        self.transfer = Some(Transfer::begin(&mut self.bus, setting, times, tx)?);
        Ok(())
    }

    fn hello(&mut self) -> Hello {
        self.stop_streams();
        let supplied = if self.supply.is_on() { Capabilities::SUPPLY_ON } else { Capabilities::new(0) };
        Hello {
            capabilities: self.identity.capabilities.union(supplied),
            max_clock_hz: BissSetting::MAX_HZ,
            max_sample_hz: AnalogSetting::MAX_HZ,
            name: self.identity.name.to_owned(),
            serial: self.identity.serial.clone(),
            firmware: self.identity.firmware.to_owned(),
        }
    }

    fn status(&mut self) -> AdapterStatus {
        let has_supply = self.identity.capabilities.contains(Capabilities::SUPPLY);
        AdapterStatus {
            t_us: self.bus.now_us(),
            restart: self.identity.restart,
            faults: self.supply.faults(),
            input_millivolt: if has_supply { self.bus.supply_millivolt() } else { 0 },
            damaged: u32::try_from(self.receiver.dropped_count()).unwrap_or(u32::MAX),
            malformed: self.malformed,
            lost: self.lost,
        }
    }

    /// Returns an error if this build does not have the capability.
    fn requires(&self, capability: Capabilities) -> Result<(), Refusal> {
        if self.identity.capabilities.contains(capability) { Ok(()) } else { Err(NOT_SUPPORTED) }
    }

    /// Waits for the pause after the previous frame, and then clocks one frame.
    fn frame(&mut self, clocking: Clocking, cdm: bool) -> Frame {
        self.select(clocking);
        let frame = self.bus.frame(cdm);
        self.free_us = self.bus.now_us() + pause_us(clocking);
        frame
    }

    fn select(&mut self, clocking: Clocking) {
        self.bus.wait_until(self.free_us);
        if self.selected != Some(clocking) {
            self.bus.select(clocking);
            self.selected = Some(clocking);
        }
    }

    fn register(&mut self, access: RegisterAccess) -> Result<u8, Refusal> {
        let setting = self.biss.ok_or(NOT_CONFIGURED)?;
        if access.slave > 7 || access.address > 0x7F {
            return Err((ErrorCode::BAD_ARGUMENT, "slaves 0 to 7 and addresses 00h to 7Fh"));
        }
        let result = access_register(access, |cdm| {
            let frame = setting.decode(self.frame(Clocking::Biss(setting), cdm).words);
            (frame.status == bridge_codec::BissStatus::OK).then_some(frame.cds)
        });
        result.map_err(|error| error.refusal())
    }

    /// Starts a stream, or ends it if the period is 0. Returns the actual period in microseconds.
    fn stream(&mut self, clocking: Clocking, period_us: u32, least_us: u32) -> u32 {
        if period_us == 0 {
            let same = |stream: &ClockedStream| bus_discriminant(stream.clocking()) == bus_discriminant(clocking);
            if self.stream.as_ref().is_some_and(same) {
                self.stop_stream();
            }
            return 0;
        }
        let period_us = period_us.max(least_us);
        self.select(clocking);
        let start_us = self.bus.start(period_us);
        self.stream = Some(ClockedStream::new(clocking, period_us, start_us));
        period_us
    }

    fn stop_sampling(&mut self) {
        if self.sampled.take().is_some() {
            self.bus.stop_conversions();
        }
    }

    fn stop_streams(&mut self) {
        self.stop_stream();
        self.stop_sampling();
    }

    fn stop_stream(&mut self) {
        if let Some(stream) = self.stream.take() {
            self.bus.stop();
            self.free_us = self.bus.now_us() + pause_us(stream.clocking());
        }
    }
}

/// Returns whether the operation uses the clock and data lines.
fn is_clocked(operation: Operation) -> bool {
    (Operation::SsiConfig.byte()..=Operation::BissStream.byte()).contains(&operation.byte())
}

fn bus_discriminant(clocking: Clocking) -> core::mem::Discriminant<Clocking> {
    core::mem::discriminant(&clocking)
}

/// Returns the microseconds from the end of a frame until the encoder is ready and the clock line is high again.
fn pause_us(clocking: Clocking) -> u64 {
    u64::from(match clocking {
        Clocking::Ssi(setting) => setting.pause_us,
        Clocking::Biss(setting) => setting.timeout_us,
    }) + 3
}
