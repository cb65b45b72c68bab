//! A virtual encoder on the line, with its power-up windows, processing times and line settings. See the manual,
//! "Dialog Timing", figure 38 "Einschaltverhalten", and "Fehlerbehandlung". The effects of commands are implemented in
//! [`electronics`](super::electronics), and collisions with other senders in the [`Bus`](super::Bus).
//!
//! ```text
//! off ── power ──▶ INIT (deaf) ── 100 ms ──▶ DEFAULT (factory settings) ── 900 ms ──▶ SWITCH (deaf) ── 200 ms ──▶ USER
//!                                               └── plausible command: keeps the factory settings
//! listening ── silence ≥ time-out ──▶ executing ──▶ talking ──▶ listening
//! ```
//! The manual leaves some behaviour open (`U`). In this model, if bytes are lost because the encoder is processing a
//! request or sending, the rest of their frame is lost too. The encoder's own reply ends a frame immediately. The
//! encoder does not reply to a damaged broadcast.

use std::time::Duration;

use super::config::Config;
use super::electronics::{EncoderElectronics, Wear};
use super::memory::Memory;
use crate::devices::hiperface::protocol::{
    BROADCAST, Command, DeviceAddress, Frame, FrameError, LineSettings, Request, StatusCode, Timing, checksum,
};
use crate::sim::SimulatedFaults;
use crate::units::Moment;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResponseTimes {
    /// Typical times, as observed. Reading the position takes 3.7 ms, a store takes 20 ms plus 1.5 ms per byte, and any
    /// other command takes half of its maximum time.
    #[default]
    Typical,
    /// Always the maximum times from the manual's table.
    Worst,
}

impl ResponseTimes {
    const READ_POSITION: Duration = Duration::from_micros(3_700);
    const STORE: Duration = Duration::from_millis(20);
    const STORE_BYTE: Duration = Duration::from_micros(1_500);

    /// Returns the time for processing a frame. A rejected frame takes as long as a status request.
    fn time(self, verdict: &Result<Request, StatusCode>) -> Duration {
        let longest = |command: Command| command.row().max_time;
        match (self, verdict) {
            (ResponseTimes::Worst, Ok(request)) => longest(request.command()),
            (ResponseTimes::Worst, Err(_)) => longest(Command::ReadStatus),
            (ResponseTimes::Typical, Ok(Request::ReadPosition)) => Self::READ_POSITION,
            (ResponseTimes::Typical, Ok(Request::StoreData { data, .. })) => {
                Self::STORE + Self::STORE_BYTE * u32::try_from(data.len()).unwrap_or(u32::MAX)
            }
            (ResponseTimes::Typical, Ok(request)) => longest(request.command()) / 2,
            (ResponseTimes::Typical, Err(_)) => longest(Command::ReadStatus) / 2,
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct ReceivedCharacter {
    pub(super) start: Moment,
    pub(super) end: Moment,
    pub(super) byte: u8,
    /// Whether the parity bit matches and the stop bit is valid.
    pub(super) intact: bool,
}

/// A reply that the encoder begins to send.
#[derive(Clone)]
pub(super) struct Transmission {
    pub(super) start: Moment,
    pub(super) settings: LineSettings,
    pub(super) bytes: Vec<u8>,
}

/// A virtual encoder on a [`Bus`](super::Bus), whose clock it uses. It has no `Debug` implementation, because frames
/// may contain access codes.
#[derive(Clone)]
pub struct Encoder {
    electronics: EncoderElectronics,
    faults: SimulatedFaults,
    pace: ResponseTimes,
    power: Power,
    /// Interface settings that were in the EEPROM at the last start.
    user: LineSettings,
    /// Interface settings set by 67h, which apply until the next start.
    temporary: Option<LineSettings>,
    activity: Activity,
    /// End of the last lost character. The rest of its frame is also lost.
    lost: Option<Moment>,
    frames_processed: u32,
    stores_begun: u32,
    silent: bool,
}

#[derive(Clone, Debug)]
enum Power {
    Off,
    /// The encoder was powered on at `since`. A plausible command in the DEFAULT window sets `keeps_default`.
    Starting {
        since: Moment,
        keeps_default: bool,
    },
    OnForLong,
}

#[derive(Clone)]
enum Activity {
    Listening(Option<IncomingFrame>),
    Executing { until: Moment, settings: LineSettings, verdict: Result<Request, StatusCode> },
    Talking { until: Moment },
}

#[derive(Clone)]
struct IncomingFrame {
    bytes: Vec<u8>,
    intact: bool,
    overlong: bool,
    /// Time at which the frame ends, unless another character begins first.
    ends: Moment,
}

impl IncomingFrame {
    /// Capacity in bytes. The longest request, 4Bh with 128 data bytes, has 135 bytes.
    const CAPACITY: usize = 140;

    fn ending_at(ends: Moment) -> Self {
        IncomingFrame { bytes: Vec::new(), intact: true, overlong: false, ends }
    }
}

impl Encoder {
    pub(super) fn new(config: &Config, index: u8) -> Self {
        Encoder {
            electronics: EncoderElectronics::new(config, index),
            faults: config.faults.clone(),
            pace: config.pace,
            power: Power::OnForLong,
            user: config.settings,
            temporary: None,
            activity: Activity::Listening(None),
            lost: None,
            frames_processed: 0,
            stores_begun: 0,
            silent: config.faults.silent_after() == Some(0),
        }
    }

    pub fn address(&self) -> DeviceAddress {
        self.electronics.address
    }

    pub fn memory(&self) -> &Memory {
        &self.electronics.memory
    }

    pub fn wear(&self) -> &Wear {
        &self.electronics.wear
    }

    pub fn counter(&self) -> u32 {
        self.electronics.counter
    }

    /// Sets the counter to the lowest 24 bits of `counter`. This is not counted as a write.
    pub fn set_counter(&mut self, counter: u32) {
        self.electronics.counter = counter & 0x00FF_FFFF;
    }

    pub fn position(&self, at: Moment) -> u32 {
        self.electronics.shaft.position(at)
    }

    /// Changes the speed of the shaft, starting at `now`.
    pub fn set_rpm(&mut self, now: Moment, rpm: f64) {
        self.electronics.shaft.set_rpm(now, rpm);
    }

    /// Sets the temperature. If it exceeds the limit, the encoder warns once with code 1Eh.
    pub fn set_temperature(&mut self, celsius: i16) {
        self.electronics.set_temperature(celsius);
    }

    /// Adds a monitoring code to the status queue. The code is lost if the queue is full (four codes).
    pub fn queue_code(&mut self, code: StatusCode) {
        self.electronics.queue.push(code);
    }

    /// Returns the settings stored with 57h, which take effect at the next start.
    pub fn stored_settings(&self) -> LineSettings {
        self.electronics.stored_settings
    }

    /// Returns the settings with which the encoder listens at time `at`, or `None` if it does not listen at that time.
    pub fn active_settings_at(&self, at: Moment) -> Option<LineSettings> {
        if self.silent {
            return None;
        }
        let switched = self.temporary.unwrap_or(self.user);
        match self.power {
            Power::Off => None,
            Power::OnForLong => Some(switched),
            Power::Starting { since, keeps_default } => {
                let running = at.duration_since(since);
                let factory = Some(self.temporary.unwrap_or(LineSettings::FACTORY));
                if running < Timing::INITIALISATION {
                    None
                } else if keeps_default || running < Timing::DEFAULT_WINDOW_END {
                    factory
                } else if running < Timing::DEFAULT_WINDOW_END + Timing::SWITCH {
                    None
                } else {
                    Some(switched)
                }
            }
        }
    }

    /// Replaces the simulated faults, but keeps the counts of frames and stores.
    pub(super) fn set_faults(&mut self, faults: SimulatedFaults) {
        self.silent = faults.silent_after().is_some_and(|frames| frames <= self.frames_processed);
        self.faults = faults;
    }

    pub(super) fn power_cycle(&mut self, now: Moment) {
        self.power_off();
        self.power_on(now);
    }

    /// Switches the encoder on if it has no power.
    pub(super) fn connect(&mut self, now: Moment) {
        if matches!(self.power, Power::Off) {
            self.power_on(now);
        }
    }

    fn power_off(&mut self) {
        self.power = Power::Off;
        self.activity = Activity::Listening(None);
    }

    /// Starts the encoder, either after power-on or after 53h.
    fn power_on(&mut self, now: Moment) {
        self.power = Power::Starting { since: now, keeps_default: false };
        self.user = self.electronics.stored_settings;
        self.temporary = None;
        self.activity = Activity::Listening(None);
        self.lost = None;
        self.electronics.restart();
    }

    /// Returns the time at which [`run_due_action`](Self::run_due_action) must be called next.
    pub(super) fn next_action_time(&self) -> Option<Moment> {
        match &self.activity {
            Activity::Listening(reception) => reception.as_ref().map(|reception| reception.ends),
            Activity::Executing { until, .. } | Activity::Talking { until } => Some(*until),
        }
    }

    /// Records a received character. All actions due before its start must have been [executed](Self::run_due_action).
    pub(super) fn handle_input(&mut self, heard: ReceivedCharacter) {
        let Some(settings) = self.active_settings_at(heard.start) else { return };
        let Some(timing) = Timing::from_settings(settings) else { return };
        let in_lost_frame = self.lost.is_some_and(|end| heard.start < end + timing.timeout);
        match &mut self.activity {
            Activity::Listening(reception) if !in_lost_frame => {
                let ends = heard.end + timing.timeout;
                let reception = reception.get_or_insert_with(|| IncomingFrame::ending_at(ends));
                reception.ends = ends;
                reception.intact &= heard.intact;
                if reception.bytes.len() < IncomingFrame::CAPACITY {
                    reception.bytes.push(heard.byte);
                } else {
                    reception.overlong = true;
                }
            }
            _ => self.lost = Some(heard.end),
        }
    }

    /// Executes the action that is due at `at`, which is the time returned by
    /// [`next_action_time`](Self::next_action_time).
    pub(super) fn run_due_action(&mut self, at: Moment) -> Option<Transmission> {
        match std::mem::replace(&mut self.activity, Activity::Listening(None)) {
            Activity::Listening(Some(reception)) => {
                self.handle_frame_end(at, &reception);
                None
            }
            Activity::Executing { settings, verdict, .. } => self.start_reply(at, settings, verdict),
            Activity::Listening(None) | Activity::Talking { .. } => None,
        }
    }

    fn handle_frame_end(&mut self, at: Moment, reception: &IncomingFrame) {
        // A frame is lost if it ends while the settings change.
        let Some(settings) = self.active_settings_at(at) else { return };
        let broadcast = match reception.bytes.first() {
            Some(&BROADCAST) => true,
            Some(first) if *first == self.address().byte() => false,
            _ => return,
        };
        let frame = if reception.overlong { Err(StatusCode::LENGTH) } else { validate_frame(reception) };
        if frame.is_err() && broadcast {
            return;
        }
        if self.faults.silent_after() == Some(self.frames_processed) {
            self.silent = true;
            return;
        }
        self.frames_processed = self.frames_processed.saturating_add(1);
        let verdict = frame.and_then(|frame| self.parse_request(&frame));
        if let (Power::Starting { since, keeps_default }, Ok(_)) = (&mut self.power, &verdict)
            && at.duration_since(*since) < Timing::DEFAULT_WINDOW_END
        {
            *keeps_default = true;
        }
        if verdict == Ok(Request::Reset) {
            self.power_on(at);
            return;
        }
        let until = at + self.pace.time(&verdict) + self.faults.reply_delay();
        self.activity = Activity::Executing { until, settings, verdict };
    }

    fn parse_request(&self, frame: &Frame<'_>) -> Result<Request, StatusCode> {
        if Command::from_byte(frame.command).is_some_and(|command| !self.electronics.supports(command)) {
            return Err(StatusCode::UNKNOWN_COMMAND);
        }
        Request::parse(frame).map_err(|error| error.status())
    }

    /// Completes the processing of a request by applying its effect and starting the reply.
    fn start_reply(
        &mut self,
        at: Moment,
        settings: LineSettings,
        verdict: Result<Request, StatusCode>,
    ) -> Option<Transmission> {
        let address = self.address().byte();
        if let Ok(request) = &verdict
            && self.is_power_lost_during(request)
        {
            self.power_off();
            return None;
        }
        let outcome = verdict.and_then(|request| {
            let data = self.electronics.execute(at, &request)?;
            Ok((request, data))
        });
        let error_bit = if self.electronics.queue.is_empty() { 0 } else { Frame::ERROR_BIT };
        let (command, payload) = match &outcome {
            Ok((request, data)) => (request.command(), data.as_slice()),
            Err(code) => (Command::ReadStatus, &[code.byte()][..]),
        };
        let bytes = Frame { address, command: command.byte() | error_bit, payload }.emit();
        // The request was received with these settings, so they contain no reserved values.
        let talk =
            Timing::from_settings(settings).map_or(Duration::ZERO, |timing| timing.time_of_characters(bytes.len()));
        self.activity = Activity::Talking { until: at + talk };
        if let Ok((Request::ConfigureLineTemporarily { settings }, _)) = outcome {
            // The new settings apply from the end of the reply. Until then, nothing is received.
            self.temporary = Some(settings);
        }
        Some(Transmission { start: at, settings, bytes })
    }

    /// Returns whether power is lost during this store, so that only half of its bytes are written.
    fn is_power_lost_during(&mut self, request: &Request) -> bool {
        let Request::StoreData { field, address, code, data } = request else { return false };
        if self.electronics.memory.check_store_request(*field, *address, data.len(), *code).is_err() {
            return false;
        }
        self.stores_begun = self.stores_begun.saturating_add(1);
        self.faults.save_with_power_failure() == Some(self.stores_begun)
            && self.electronics.store_first_half(*field, *address, data, *code).is_ok()
    }
}

/// Checks parity, then checksum, then length.
fn validate_frame(reception: &IncomingFrame) -> Result<Frame<'_>, StatusCode> {
    if !reception.intact {
        return Err(StatusCode::PARITY);
    }
    Frame::parse(&reception.bytes).map_err(|error| match error {
        FrameError::Checksum { .. } => StatusCode::CHECKSUM,
        FrameError::Short { .. } if checksum(&reception.bytes) != 0 => StatusCode::CHECKSUM,
        FrameError::Short { .. } => StatusCode::LENGTH,
    })
}
