//! Single exchanges through an adapter on the bus. An exchange reads a frame, or accesses a register by bank and
//! address. The selected bank is remembered until an exchange fails or the encoder may have restarted unnoticed.

use std::time::Duration;

use super::{AttemptResult, ExchangeError, Master, WriteReaction};
use crate::buses::bridge::procedures::{Adapter, AdapterError, BISS_TIME_OUT_US, Failure, TimedReply};
use crate::buses::bridge::protocol::{BissStatus, Capabilities, ErrorCode, REQUEST_RETRY_TIMEOUT, Reply, Request};
use crate::devices::biss::procedures::error::{Error, ReplyDamage, RequestedItem};
use crate::devices::biss::procedures::position::PositionReading;
use crate::devices::biss::procedures::station::Bus;
use crate::devices::biss::protocol::{FrameError, RegisterAddress};
use crate::link::line::LineError;
use crate::units::Moment;

/// Slave number of the only encoder on the line.
const SLAVE: u8 = 0;
/// Time after a reply within which the encoder cannot restart unnoticed. A restart takes 500 ms (data sheet, 02:0Eh).
const BANK_CACHE_TIME: Duration = Duration::from_millis(200);
/// Pause between two attempts. The adapter reports a missing encoder immediately, so there would be no pause otherwise.
const RETRY_PAUSE: Duration = Duration::from_millis(20);
/// Number of consecutive frames with a wrong checksum after which noise is ruled out as the cause. The number is not
/// documented (`U`).
const MAX_WRONG_FRAMES: u32 = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum NoFrame {
    NoAcknowledge,
    StuckLow,
    StuckHigh,
}

impl<'a> Master<'a> {
    pub(super) fn adapter_host(&mut self) -> Adapter<'_, 'a> {
        Adapter { line: &mut self.line, state: &mut self.station.line, adapter: &mut self.station.adapter }
    }

    /// Prepares the bus with the known frame widths. See [`ensure_bus_ready_for`](Self::ensure_bus_ready_for).
    pub(super) fn ensure_bus_ready(&mut self) -> Result<(), Error> {
        let layout = self.station.frame_layout();
        self.ensure_bus_ready_for(layout.data_bits(), layout.crc_bits())
    }

    /// Identifies the adapter, switches the encoder's supply on if requested, and configures the bus.
    pub(super) fn ensure_bus_ready_for(&mut self, data_bits: u8, crc_bits: u8) -> Result<(), Error> {
        self.stop_frame_stream()?;
        self.adapter_host().read_identity()?;
        let Some(hello) = self.station.adapter.identity() else { return Err(AdapterError::Silent.into()) };
        if !hello.capabilities.contains(Capabilities::BISS) {
            return Err(AdapterError::NoBiss { name: hello.name.clone() }.into());
        }
        let fastest = hello.max_clock_hz;
        // The bus is configured first, because a frame shows whether the encoder already has power.
        self.configure_bus(fastest, data_bits, crc_bits)?;
        self.switch_on()?;
        self.configure_bus(fastest, data_bits, crc_bits)
    }

    fn configure_bus(&mut self, fastest: u32, data_bits: u8, crc_bits: u8) -> Result<(), Error> {
        let bus = Bus { clock_hz: self.station.clock_hz.min(fastest), data_bits, crc_bits };
        if self.station.bus == Some(bus) {
            return Ok(());
        }
        let timeout_us = BISS_TIME_OUT_US;
        let request = Request::BissConfig { clock_hz: bus.clock_hz, data_bits, crc_bits, timeout_us };
        let answered = self.adapter_host().send_request(&request)?;
        let Reply::BissConfig { clock_hz } = answered.reply else {
            return Err(AdapterError::unexpected_reply(request.operation(), &answered.reply).into());
        };
        (self.station.bus, self.station.actual_clock_hz) = (Some(bus), Some(clock_hz));
        self.station.good_frames = false;
        Ok(())
    }

    /// Selects the bank of a register, unless it is already selected.
    pub(super) fn select_bank(&mut self, address: RegisterAddress) -> Result<(), Error> {
        let Some(bank) = address.bank() else { return Ok(()) };
        self.request_with_retries(RequestedItem::Write(RegisterAddress::BANK_SELECT, bank), |master| {
            master.select_bank_once(address)
        })
    }

    fn select_bank_once(&mut self, address: RegisterAddress) -> AttemptResult<()> {
        let Some(bank) = address.bank() else { return Ok(Ok(())) };
        let now = self.now();
        let fresh = |(own, at): (u8, Moment)| own == bank && now.duration_since(at) < BANK_CACHE_TIME;
        if self.station.bank.is_some_and(fresh) {
            return Ok(Ok(()));
        }
        Ok(match self.write_register_once(RegisterAddress::BANK_SELECT, bank)? {
            Ok(reads) if reads == bank => Ok(()),
            Ok(_) => return Err(Error::NoSuchRegister { address }),
            Err(trouble) => Err(trouble),
        })
    }

    pub(super) fn read_bus_once(&mut self, address: RegisterAddress) -> AttemptResult<u8> {
        if let Err(trouble) = self.select_bank_once(address)? {
            return Ok(Err(trouble));
        }
        let request = Request::BissRegisterRead { slave: SLAVE, address: address.address() };
        let answered = self.adapter_host().send_request(&request).map(Some);
        let value = match self.handle_register_reply(answered)? {
            Ok(Reply::BissRegisterRead { value }) => value,
            Ok(reply) => return Err(AdapterError::unexpected_reply(request.operation(), &reply).into()),
            Err(trouble) => return Ok(Err(trouble)),
        };
        if address == RegisterAddress::BANK_SELECT {
            self.station.bank = Some((value, self.now()));
        }
        Ok(Ok(value))
    }

    pub(super) fn write_bus_once(&mut self, address: RegisterAddress, value: u8) -> AttemptResult<WriteReaction> {
        Ok(match self.write_register_once(address, value)? {
            Ok(reads) if reads == value => Ok(WriteReaction::Yes),
            // A command register may be cleared as soon as the command is executed (`U`). The result can be read from
            // the status register.
            Ok(0) if self.station.is_command_register(address) => Ok(WriteReaction::Yes),
            Ok(reads) => Ok(WriteReaction::No(Some(reads))),
            Err(trouble) => Err(trouble),
        })
    }

    /// Writes a register without retries, and returns the value read back.
    fn write_register_once(&mut self, address: RegisterAddress, value: u8) -> AttemptResult<u8> {
        let request = Request::BissRegisterWrite { slave: SLAVE, address: address.address(), value };
        let answered = self.adapter_host().request_once(&request);
        let reads = match self.handle_register_reply(answered)? {
            Ok(Reply::BissRegisterWrite { value }) => value,
            Ok(reply) => return Err(AdapterError::unexpected_reply(request.operation(), &reply).into()),
            Err(trouble) => return Ok(Err(trouble)),
        };
        if address == RegisterAddress::BANK_SELECT {
            self.station.bank = Some((reads, self.now()));
        }
        Ok(Ok(reads))
    }

    /// Evaluates the reply to a register request and updates the cached bank.
    fn handle_register_reply(&mut self, answered: Result<Option<TimedReply>, Failure>) -> AttemptResult<Reply> {
        let trouble = match answered {
            Ok(Some(answered)) => {
                let now = self.now();
                self.station.bank = self.station.bank.map(|(bank, _)| (bank, now));
                return Ok(Ok(answered.reply));
            }
            Ok(None) => ExchangeError::Silence { echo_heard: false },
            Err(Failure::Adapter(AdapterError::Refused { code: ErrorCode::NO_REPLY, .. })) => {
                ExchangeError::Silence { echo_heard: false }
            }
            Err(Failure::Adapter(AdapterError::Refused { code: ErrorCode::INVALID_REPLY, .. })) => {
                ExchangeError::Damage(ReplyDamage::ControlFrame)
            }
            Err(failure) => {
                self.handle_possible_reset(&failure);
                return Err(failure.into());
            }
        };
        self.station.bank = None;
        Ok(Err(trouble))
    }

    /// Discards the settings that the adapter may have lost in a reset. After a cancellation, only the bank and the bus
    /// settings are discarded.
    fn handle_possible_reset(&mut self, failure: &Failure) {
        if matches!(failure, Failure::Line(LineError::Cancelled)) {
            (self.station.bank, self.station.bus) = (None, None);
        } else {
            self.station.forget_settings();
        }
    }

    pub(super) fn read_bus_position_once(&mut self) -> AttemptResult<PositionReading> {
        let layout = self.station.frame_layout();
        let (raw, at) = match self.read_frame_once()? {
            Ok(frame) => frame,
            Err(trouble) => return Ok(Err(trouble)),
        };
        Ok(match layout.parse(raw) {
            Ok(reading) => {
                self.station.good_frames = true;
                let crc_errors = self.station.take_crc_errors();
                let is_split_known = self.station.is_split_known();
                Ok(PositionReading { crc_errors, is_split_known, ..PositionReading::from_frame(at, &reading, &layout) })
            }
            Err(FrameError::StuckLow) => Err(ExchangeError::NoFrame(NoFrame::StuckLow)),
            Err(FrameError::StuckHigh) => Err(ExchangeError::NoFrame(NoFrame::StuckHigh)),
            Err(cause) => {
                self.station.crc_errors = self.station.crc_errors.saturating_add(1);
                Err(ExchangeError::Damage(ReplyDamage::Frame(cause)))
            }
        })
    }

    pub(super) fn read_frame_once(&mut self) -> AttemptResult<(u64, Moment)> {
        let answered = self.adapter_host().send_request(&Request::BissRead);
        let answered = answered.inspect_err(|failure| self.handle_possible_reset(failure))?;
        let Reply::BissRead { t_us, status, raw } = answered.reply else {
            return Err(AdapterError::unexpected_reply(Request::BissRead.operation(), &answered.reply).into());
        };
        let no_frame = match status {
            BissStatus::OK => {
                let at = self.station.adapter.local_time_of(t_us, &answered);
                return Ok(Ok((raw, at)));
            }
            BissStatus::NO_ACKNOWLEDGE => NoFrame::NoAcknowledge,
            BissStatus::STUCK_LOW => NoFrame::StuckLow,
            BissStatus::STUCK_HIGH => NoFrame::StuckHigh,
            other => return Err(Error::FrameStatus { status: other.byte() }),
        };
        self.station.bank = None;
        Ok(Err(ExchangeError::NoFrame(no_frame)))
    }

    /// Reads more frames if five frames had wrong checksums and no frame has ever been correct. If noise is the cause,
    /// some of the new frames are correct. If the widths are wrong, none of them are.
    pub(super) fn recheck_frame_widths(&mut self, failed: Error) -> Result<PositionReading, Error> {
        if self.station.good_frames {
            return Err(failed);
        }
        for _ in 0..MAX_WRONG_FRAMES {
            match self.read_bus_position_once()? {
                Ok(reading) => return Ok(reading),
                Err(ExchangeError::Damage(ReplyDamage::Frame(_))) => {}
                Err(_) => return Err(failed),
            }
        }
        let layout = self.station.frame_layout();
        Err(Error::WrongWidths {
            frames: self.station.take_crc_errors(),
            data_bits: layout.data_bits(),
            crc_bits: layout.crc_bits(),
        })
    }

    /// Reads a frame after a register access to which no reply came. If this fails as well, the line itself is at
    /// fault.
    pub(super) fn diagnose_line(&mut self, failed: Error) -> Error {
        let Error::NoReply { tries, .. } = failed else { return failed };
        match self.read_frame_once() {
            Ok(Err(ExchangeError::NoFrame(cause))) => self.missing_frame_error(cause, tries),
            _ => failed,
        }
    }

    pub(super) fn missing_frame_error(&self, cause: NoFrame, tries: u32) -> Error {
        let can_switch =
            self.station.adapter.identity().is_some_and(|hello| hello.capabilities.contains(Capabilities::SUPPLY));
        match cause {
            NoFrame::NoAcknowledge => {
                Error::NoAcknowledge { tries, supply_off: can_switch && self.station.supply.is_none() }
            }
            NoFrame::StuckLow => Error::StuckLow { tries },
            NoFrame::StuckHigh => Error::StuckHigh { tries },
        }
    }

    pub(super) fn pause(&mut self) -> Result<(), Error> {
        self.wait(RETRY_PAUSE)
    }

    /// Returns the maximum duration of an exchange with two attempts.
    pub(super) fn max_bus_exchange_duration(&self) -> Duration {
        2 * (REQUEST_RETRY_TIMEOUT + self.station.line.margin)
    }
}
