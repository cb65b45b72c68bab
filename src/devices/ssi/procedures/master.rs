//! Host side of an adapter that reads words from an SSI encoder. While words are streamed, the adapter accepts no other
//! request, so any other request ends the stream first.
//!
//! Reading a word does not change anything except error bits that a transfer clears, so it can be repeated. An adapter
//! that has replied before is asked up to five times within eight seconds. An adapter that has never replied is asked
//! twice. See the reference.

use std::time::Duration;

use super::station::{Identity, Supply};
use super::{ClockSettings, Error, Station, Words};
use crate::buses::bridge::procedures::flow::{SampleStream, StreamKind};
use crate::buses::bridge::procedures::{Adapter, AdapterError, Failure};
use crate::buses::bridge::protocol::{
    Capabilities, ErrorCode, REQUEST_RETRY_TIMEOUT, Reply, Request, SsiFlags, StreamData,
};
use crate::link::Ctx;
use crate::link::line::SerialLine;
use crate::units::Moment;

/// Interval between checks for cancellation.
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// The host side of an adapter in front of an SSI encoder.
pub struct Master<'a> {
    line: SerialLine<'a>,
    station: &'a mut Station,
}

impl<'a> Master<'a> {
    /// Creates a master for one job, and restarts the time limit for retries.
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        station.line.begin_job();
        Master { line: SerialLine::new(ctx), station }
    }

    /// Identifies the adapter, switches on the encoder supply if requested, and configures how SSI words are read.
    /// Steps that are already done are skipped.
    ///
    /// # Errors
    /// Returns [`AdapterError::Version`], [`AdapterError::NoSsi`] or [`AdapterError::NoSupply`] if the adapter is not
    /// suitable, or another error if it rejects a request or the connection fails.
    pub fn identify(&mut self) -> Result<Identity, Error> {
        self.stop_word_stream()?;
        self.with_retries(|master| master.adapter_host().read_identity())?;
        let Some(hello) = self.station.adapter.identity().cloned() else { return Err(AdapterError::Silent.into()) };
        if !hello.capabilities.contains(Capabilities::SSI) {
            return Err(AdapterError::NoSsi { name: hello.name }.into());
        }
        self.switch_on()?;
        let clock_hz = self.set_clocks(hello.max_clock_hz)?;
        Ok(Identity { hello, clock_settings: self.station.clock_settings, clock_hz, supply: self.station.supply })
    }

    /// Changes the settings for reading SSI words.
    ///
    /// # Errors
    /// Returns any error that [`identify`](Self::identify) returns. In this case, the previous settings stay in effect.
    pub fn apply_settings(&mut self, clock_settings: ClockSettings) -> Result<Identity, Error> {
        let before = std::mem::replace(&mut self.station.clock_settings, clock_settings);
        if before != clock_settings {
            self.station.asked = 0;
        }
        self.identify().inspect_err(|_| self.station.clock_settings = before)
    }

    /// Reads a single SSI word.
    ///
    /// # Errors
    /// Returns any error that [`identify`](Self::identify) returns.
    pub fn read_word(&mut self) -> Result<Words, Error> {
        match self.read_configured_word() {
            // The adapter was reset and has lost its settings. The word is requested once more after the adapter has
            // been configured again.
            Err(Error::Adapter(AdapterError::Refused { code: ErrorCode::BAD_ARGUMENT, operation, .. }))
                if operation == Request::SsiRead.operation() =>
            {
                self.read_configured_word()
            }
            taken => taken,
        }
    }

    /// Reads the next word in a series of single requests.
    ///
    /// # Errors
    /// Returns any error that [`identify`](Self::identify) returns.
    pub fn next_word(&mut self) -> Result<Words, Error> {
        let word = self.read_word()?;
        Ok(Words { first: self.station.count(), ..word })
    }

    /// Returns the next words of a stream, which is started if it is not running.
    ///
    /// `period_us` is the interval between words in microseconds. If the adapter does not support it, its shortest
    /// interval is used.
    ///
    /// # Errors
    /// Returns an error of [`identify`](Self::identify) if the stream cannot be started. An error of the adapter ends a
    /// running stream, whereas a cancellation does not.
    pub fn next_words(&mut self, period_us: u32) -> Result<Words, Error> {
        let streamed = StreamKind::Ssi { period_us };
        if self.station.flow.as_ref().is_none_or(|flow| flow.stream_kind() != streamed) {
            self.identify()?;
            self.begin_stream(streamed)?;
        }
        let (clock_settings, clock_hz) =
            self.station.set.unwrap_or((self.station.clock_settings, self.station.clock_settings.clock_hz));
        loop {
            let until = self.now() + CANCEL_CHECK_INTERVAL;
            let Station { line: state, adapter, flow, .. } = &mut *self.station;
            let Some(flow) = flow else { return Err(AdapterError::StreamSilent.into()) };
            let mut host = Adapter { line: &mut self.line, state, adapter };
            let portion = match flow.next(&mut host, until) {
                Ok(portion) => portion,
                Err(failure) => return Err(self.stream_failed(failure.into())),
            };
            if let Some(portion) = portion
                && let StreamData::Ssi(data) = &portion.data
            {
                return Ok(Words::run(&portion, data, clock_settings, clock_hz, period_us));
            }
        }
    }

    /// Stops the running stream, even after a cancellation. Single requests are counted from 0 again.
    ///
    /// # Errors
    /// Returns an error if the adapter fails. In this case, the stream is ended before the next request.
    pub fn stop_word_stream(&mut self) -> Result<(), Error> {
        let Some(flow) = self.station.flow.take() else { return Ok(()) };
        self.station.asked = 0;
        self.station.streamed_until = flow.last().or(self.station.streamed_until);
        let shielded = self.line.ignore_cancellation(true);
        let ended = flow.stop(&mut self.adapter_host());
        self.line.ignore_cancellation(shielded);
        match SampleStream::is_stopped(ended) {
            Ok(true) => Ok(()),
            Ok(false) => {
                self.station.forget_settings();
                Ok(())
            }
            Err(failure) => {
                self.station.flow = Some(flow);
                Err(failure.into())
            }
        }
    }

    /// Switches off the supply of the encoder at the end of a session, unless it is configured to stay on.
    ///
    /// # Errors
    /// Returns an error if the adapter fails.
    pub fn switch_off_after_session(&mut self) -> Result<(), Error> {
        if !self.station.adapter.must_switch_supply_off() {
            return Ok(());
        }
        self.line.ignore_cancellation(true);
        self.stop_word_stream()?;
        Ok(self.adapter_host().switch_off_after_session()?)
    }

    fn now(&self) -> Moment {
        self.line.now()
    }

    fn adapter_host(&mut self) -> Adapter<'_, 'a> {
        Adapter { line: &mut self.line, state: &mut self.station.line, adapter: &mut self.station.adapter }
    }

    fn switch_on(&mut self) -> Result<(), Error> {
        let Some(Supply { millivolt, measured: None }) = self.station.supply else { return Ok(()) };
        let measured =
            self.with_retries(|master| master.adapter_host().switch_supply_on(Supply::with_voltage(millivolt)))?;
        self.station.supply = Some(Supply { millivolt, measured: Some(measured) });
        Ok(self.line.wait(Supply::POWER_UP)?)
    }

    /// Sends the settings for reading SSI words to the adapter if they have changed. The clock is limited to `fastest`.
    /// Returns the actual clock frequency in hertz.
    fn set_clocks(&mut self, fastest: u32) -> Result<u32, Error> {
        let clock_settings = self.station.clock_settings;
        if let Some((_, clock_hz)) = self.station.set.filter(|(own, _)| *own == clock_settings) {
            return Ok(clock_hz);
        }
        let ClockSettings { clocks, clock_hz, pause_us } = clock_settings;
        let clock_hz = clock_hz.min(fastest);
        let request = Request::SsiConfig { clocks, clock_hz, pause_us, flags: SsiFlags::FALLING_EDGE };
        self.station.set = None;
        let answered = self.with_retries(|master| master.adapter_host().send_request(&request))?;
        let Reply::SsiConfig { clock_hz } = answered.reply else {
            return Err(unexpected_reply(&request, &answered.reply));
        };
        self.station.set = Some((clock_settings, clock_hz));
        Ok(clock_hz)
    }

    fn read_configured_word(&mut self) -> Result<Words, Error> {
        let Identity { clock_settings, clock_hz, .. } = self.identify()?;
        let taken = self.with_retries(Self::read_single_word);
        let (word, at) = taken.map_err(|error| self.handle_possible_reset(error))?;
        Ok(Words::single(at, word, clock_settings, clock_hz))
    }

    fn read_single_word(&mut self) -> Result<(u64, Moment), Failure> {
        let answered = self.adapter_host().send_request(&Request::SsiRead)?;
        let Reply::SsiRead { t_us, raw } = answered.reply else {
            return Err(AdapterError::unexpected_reply(Request::SsiRead.operation(), &answered.reply).into());
        };
        Ok((raw, self.station.adapter.local_time_of(t_us, &answered)))
    }

    fn begin_stream(&mut self, streamed: StreamKind) -> Result<(), Error> {
        let after = self.station.streamed_until;
        let mut may_run = false;
        let flow = self.with_retries(|master| {
            if std::mem::replace(&mut may_run, true) {
                master.adapter_host().send_request(&Request::SsiStream { period_us: 0 })?;
            }
            SampleStream::start(&mut master.adapter_host(), streamed, after)
        });
        self.station.flow = Some(flow.map_err(|error| self.handle_possible_reset(error))?);
        Ok(())
    }

    /// Calls `once` until a reply arrives or no attempt is left. The operation must be idempotent.
    fn with_retries<T>(&mut self, mut once: impl FnMut(&mut Self) -> Result<T, Failure>) -> Result<T, Error> {
        let longest = 2 * (REQUEST_RETRY_TIMEOUT + self.station.line.margin);
        let mut tries = 0;
        loop {
            tries += 1;
            let failure = match once(self) {
                Ok(answer) => {
                    self.station.line.clear_error();
                    return Ok(answer);
                }
                Err(failure) => failure,
            };
            let is_silent = matches!(failure, Failure::Adapter(AdapterError::Silent));
            if is_silent
                && self.station.adapter.has_received()
                && self.line.may_retry(&mut self.station.line, tries, longest)
            {
                continue;
            }
            return Err(failure.into());
        }
    }

    /// Marks the adapter as not configured after an error other than a cancellation, because it may have been reset.
    fn handle_possible_reset(&mut self, error: Error) -> Error {
        if error != Error::Cancelled {
            self.station.forget_settings();
        }
        error
    }

    /// Handles a stream failure, and stops the stream in the adapter if possible.
    fn stream_failed(&mut self, error: Error) -> Error {
        if error != Error::Cancelled && self.stop_word_stream().is_err() {
            // Identifying the adapter again sends HELLO, which ends all streams.
            self.station.forget_adapter();
        }
        error
    }
}

fn unexpected_reply(request: &Request, reply: &Reply) -> Error {
    AdapterError::unexpected_reply(request.operation(), reply).into()
}
