//! The host side of the line, which retries requests, reads back written values, and reads values twice if necessary.
//! Single exchanges are implemented in [`ubicom`] and [`bus`].
//!
//! A read is attempted at most five times within at most eight seconds. A write is never repeated without checking its
//! effect.

mod bus;
mod stream;
mod supply;
mod ubicom;

use std::sync::Arc;
use std::time::Duration;

use bus::NoFrame;

use super::error::{ReplyDamage, RequestedItem, requested_register};
use super::position::PositionReading;
use super::{Error, Station, Transport};
use crate::buses::ubicom::protocol::{BYTE_TIME_OUT, Request, byte_order_from_reply};
use crate::devices::biss::protocol::{Description, RegisterAddress};
use crate::link::Ctx;
use crate::link::line::{MAX_ATTEMPTS, SerialLine};
use crate::units::Moment;

/// Number of missing replies after which a register is considered nonexistent, provided that another register replies.
/// A single reply may be lost to interference.
const MAX_MISSING_REPLIES: u32 = 3;

/// The host side of the line to a BiSS encoder, for either transport.
pub struct Master<'a> {
    line: SerialLine<'a>,
    station: &'a mut Station,
}

/// The reason why an exchange produced no reply.
enum ExchangeError {
    /// Nothing arrived, except possibly the echo.
    Silence {
        echo_heard: bool,
    },
    Damage(ReplyDamage),
    NoFrame(NoFrame),
}

/// Result of an attempt. The outer error is final. After the inner error, the exchange may be retried.
type AttemptResult<T> = Result<Result<T, ExchangeError>, Error>;

enum WriteReaction {
    Yes,
    /// The encoder rejected the value. The register still holds the given value, which is `None` if this connection
    /// cannot read it back.
    No(Option<u8>),
}

impl<'a> Master<'a> {
    /// Creates the host side of the line for one job. Its time limit starts now.
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        station.line.begin_job();
        // The encoder may have restarted since the last job.
        station.bank = None;
        Master { line: SerialLine::new(ctx), station }
    }

    pub fn station(&mut self) -> &mut Station {
        self.station
    }

    /// Returns the description of the encoder's registers.
    ///
    /// # Errors
    /// Returns [`Error::NotIdentified`] if the encoder has not been identified yet.
    pub fn description(&self) -> Result<Arc<Description>, Error> {
        self.station.description.clone().ok_or(Error::NotIdentified)
    }

    pub fn now(&self) -> Moment {
        self.line.now()
    }

    /// Waits for the given duration, or until the job is cancelled.
    ///
    /// # Errors
    /// Returns [`Error::Cancelled`] if the job is cancelled.
    pub fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        Ok(self.line.wait(duration)?)
    }

    /// Runs `work` without reacting to cancellation, for steps that return the device to a safe state.
    pub fn run_uncancellable<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.ignore_cancellation(true);
        let result = work(self);
        self.ignore_cancellation(before);
        result
    }

    /// Sets whether cancellation is ignored. Returns the previous setting.
    pub(super) fn ignore_cancellation(&mut self, ignore: bool) -> bool {
        self.line.ignore_cancellation(ignore)
    }

    /// Runs `work`, which may retry reads for up to `patience` while the encoder is silent.
    pub fn with_reply_timeout<T>(&mut self, patience: Duration, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.line.retry_time.replace(patience);
        let result = work(self);
        self.line.retry_time = before;
        result
    }

    /// Runs `work`, in which every register must yield the same value twice. Used for values that will be stored.
    pub fn run_double_checked<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.station.reads_twice, true);
        let result = work(self);
        self.station.reads_twice = before;
        result
    }

    /// Reads a register. If any data was damaged on the line in this session, the register must yield the same value
    /// twice.
    ///
    /// # Errors
    /// Returns an error if every attempt fails, the register does not exist, or the user cancels.
    pub fn read(&mut self, address: RegisterAddress) -> Result<u8, Error> {
        self.ensure_ready()?;
        let requested = RequestedItem::Read(address);
        match self.read_confirmed(requested, |master| master.read_once(address)) {
            Err(Error::NoReply { .. }) if self.is_single_register_silent(address)? => {
                Err(Error::NoSuchRegister { address })
            }
            Err(failed) if self.station.transport == Transport::Adapter => Err(self.diagnose_line(failed)),
            result => result,
        }
    }

    /// Reads consecutive registers by their global addresses, across bank boundaries.
    ///
    /// # Errors
    /// Returns [`Error::OutOfRange`] if the range extends beyond the last address, or an error of [`read`](Self::read).
    pub fn read_consecutive(&mut self, start: RegisterAddress, count: usize) -> Result<Vec<u8>, Error> {
        let none = || Error::OutOfRange { start, count };
        let count_16 = u16::try_from(count).map_err(|_| none())?;
        let end = start.global_number().checked_add(count_16).ok_or_else(none)?;
        let place = |global| RegisterAddress::from_global(global).ok_or_else(none);
        let places = (start.global_number()..end).map(place).collect::<Result<Vec<_>, _>>()?;
        places.into_iter().map(|address| self.read(address)).collect()
    }

    /// Writes a register. If no reply confirms the value, the register is read back, provided that this proves
    /// anything. The write is repeated only if the value was not accepted.
    ///
    /// # Errors
    /// Returns [`Error::Refused`] if the encoder rejects the value. Returns [`Error::Unclear`] if it remains unknown
    /// whether the value was accepted, for example in a command register. Returns another error if the value was not
    /// accepted after five attempts. If [`Error::Cancelled`] is returned, nothing was written.
    pub fn write(&mut self, address: RegisterAddress, value: u8) -> Result<(), Error> {
        self.ensure_ready()?;
        let requested = RequestedItem::Write(address, value);
        let unclear = |cause| Error::Unclear { address, value, cause: Box::new(cause) };
        let mut tries = 0;
        loop {
            tries += 1;
            if self.station.transport == Transport::Adapter {
                self.select_bank(address)?;
            }
            if address != RegisterAddress::BANK_SELECT {
                self.station.written_at = Some(self.now());
            }
            let trouble = match self.write_once(address, value).map_err(|error| match error {
                Error::Link(_) | Error::NeverSilent => unclear(error),
                error => error,
            })? {
                Ok(WriteReaction::Yes) => {
                    self.station.line.clear_error();
                    return Ok(());
                }
                Ok(WriteReaction::No(reads)) => {
                    self.station.line.clear_error();
                    return Err(Error::Refused { address, value, reads });
                }
                Err(trouble) => trouble,
            };
            let failed = self.retries_exhausted(requested, tries, &trouble);
            let failure = self.prepare_retry(tries, trouble, failed.clone());
            if !self.station.is_readback_conclusive(address) {
                return Err(unclear(failed));
            }
            // After this point, the result must be determined even after a cancellation.
            match self.run_uncancellable(|master| master.read(address)) {
                Ok(reads) if reads == value => return Ok(()),
                Ok(_) => failure?,
                Err(cause) => return Err(unclear(cause)),
            }
        }
    }

    /// Reads the position.
    ///
    /// # Errors
    /// Returns [`Error::TooWide`] if the position does not fit the widths, or another error if every attempt fails or
    /// the user cancels.
    pub fn position(&mut self) -> Result<PositionReading, Error> {
        if self.station.transport == Transport::ConfigPin {
            return self.request_with_retries(RequestedItem::Position, |master| master.read_pin_position_once());
        }
        self.ensure_ready()?;
        match self.request_with_retries(RequestedItem::Position, |master| master.read_bus_position_once()) {
            Err(failed @ Error::Damaged { cause: ReplyDamage::Frame(_), .. }) => self.recheck_frame_widths(failed),
            result => result,
        }
    }

    /// Reads a frame with the given widths through an adapter. The frame is right-justified, and its checksum has not
    /// been verified.
    pub(super) fn read_frame(&mut self, data_bits: u8, crc_bits: u8) -> Result<u64, Error> {
        self.ensure_bus_ready_for(data_bits, crc_bits)?;
        self.request_with_retries(RequestedItem::Position, |master| master.read_frame_once()).map(|(raw, _)| raw)
    }

    fn read_once(&mut self, address: RegisterAddress) -> AttemptResult<u8> {
        match self.station.transport {
            Transport::ConfigPin => self.read_pin_once(address),
            Transport::Adapter => self.read_bus_once(address),
        }
    }

    fn write_once(&mut self, address: RegisterAddress, value: u8) -> AttemptResult<WriteReaction> {
        match self.station.transport {
            Transport::ConfigPin => self.write_pin_once(address, value),
            Transport::Adapter => self.write_bus_once(address, value),
        }
    }

    /// Prepares the first access: determines the byte order of register numbers, or configures the bus.
    fn ensure_ready(&mut self) -> Result<(), Error> {
        match self.station.transport {
            Transport::Adapter => self.ensure_bus_ready(),
            Transport::ConfigPin if self.station.order.is_some() => Ok(()),
            Transport::ConfigPin => self.probe_byte_order(),
        }
    }

    fn probe_byte_order(&mut self) -> Result<(), Error> {
        let requested = RequestedItem::Read(requested_register(Request::PROBE_REGISTER));
        let answer = self.read_confirmed(requested, |master| master.probe_byte_order_once())?;
        let order = byte_order_from_reply(answer).ok_or(Error::OrderUnknown { answer })?;
        self.station.order = Some(order);
        Ok(())
    }

    /// Sends a request that changes nothing in the encoder, and retries it if the line fails.
    fn request_with_retries<T>(
        &mut self,
        requested: RequestedItem,
        mut once: impl FnMut(&mut Self) -> AttemptResult<T>,
    ) -> Result<T, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            match once(self)? {
                Ok(answer) => {
                    self.station.line.clear_error();
                    return Ok(answer);
                }
                Err(trouble) => {
                    let failed = self.retries_exhausted(requested, tries, &trouble);
                    self.prepare_retry(tries, trouble, failed)?;
                }
            }
        }
    }

    /// Sends a request like [`request_with_retries`](Self::request_with_retries). If any data was damaged on the line
    /// before, the same reply must arrive twice.
    fn read_confirmed(
        &mut self,
        requested: RequestedItem,
        mut once: impl FnMut(&mut Self) -> AttemptResult<u8>,
    ) -> Result<u8, Error> {
        let mut value = self.request_with_retries(requested, &mut once)?;
        for _ in 0..MAX_ATTEMPTS {
            if !self.station.requires_double_read() {
                return Ok(value);
            }
            let again = self.request_with_retries(requested, &mut once)?;
            if again == value {
                return Ok(value);
            }
            value = again;
        }
        Err(Error::Damaged { requested, tries: MAX_ATTEMPTS, cause: ReplyDamage::Inconsistent })
    }

    fn retries_exhausted(&self, requested: RequestedItem, tries: u32, trouble: &ExchangeError) -> Error {
        match trouble {
            ExchangeError::Silence { echo_heard } => Error::NoReply { requested, tries, echo_heard: *echo_heard },
            ExchangeError::Damage(cause) => Error::Damaged { requested, tries, cause: cause.clone() },
            ExchangeError::NoFrame(cause) => self.missing_frame_error(*cause, tries),
        }
    }

    /// Prepares the line for another attempt, or returns the error `failed` if no attempts are left.
    fn prepare_retry(&mut self, tries: u32, trouble: ExchangeError, failed: Error) -> Result<(), Error> {
        self.station.noisy |= matches!(trouble, ExchangeError::Damage(_));
        let quality = &mut self.station.line.quality;
        match trouble {
            ExchangeError::Silence { .. } => quality.unanswered += 1,
            ExchangeError::Damage(_) | ExchangeError::NoFrame(_) => quality.damaged += 1,
        }
        let longest = match self.station.transport {
            Transport::ConfigPin => self.max_pin_exchange_duration(),
            Transport::Adapter => self.max_bus_exchange_duration(),
        };
        if !self.line.may_retry(&mut self.station.line, tries, longest) {
            return Err(failed);
        }
        match trouble {
            // No pause is required, because late packets are recognised by their numbers.
            ExchangeError::Damage(ReplyDamage::Frame(_)) => {}
            _ if self.station.transport == Transport::Adapter => self.pause()?,
            ExchangeError::Silence { .. } => {
                self.line.receive_late_bytes(&mut self.station.line, tries, BYTE_TIME_OUT)?
            }
            // By this time, the encoder has discarded an incomplete frame.
            _ => self.station.line.quiet_until = self.now() + BYTE_TIME_OUT,
        }
        Ok(())
    }

    /// Returns whether this register stays silent although the bank selection register replies. Both are read
    /// repeatedly. The test is skipped while the encoder may be silent for a long time.
    fn is_single_register_silent(&mut self, address: RegisterAddress) -> Result<bool, Error> {
        if address == RegisterAddress::BANK_SELECT || self.line.retry_time.is_some() {
            return Ok(false);
        }
        for _ in 0..MAX_MISSING_REPLIES {
            let answers = self.read_once(RegisterAddress::BANK_SELECT)?.is_ok();
            if !answers || !matches!(self.read_once(address)?, Err(ExchangeError::Silence { .. })) {
                return Ok(false);
            }
            match self.station.transport {
                Transport::ConfigPin => self.line.receive_late_bytes(&mut self.station.line, 1, BYTE_TIME_OUT)?,
                Transport::Adapter => self.pause()?,
            }
        }
        Ok(true)
    }
}
