//! The serial line of an adapter as a byte stream. A frame is sent when its reply is awaited, because the adapter sends
//! and receives in one transfer and does not listen in between.

use std::sync::Arc;
use std::time::Duration;

use super::power::SupplyAfterSession;
use super::{Adapter, AdapterError, AdapterState, Failure};
use crate::buses::bridge::protocol::{Capabilities, ErrorCode, Reply, Request};
use crate::link::line::{LineError, LineState, SerialLine};
use crate::link::{ByteLink, CancelToken, Clock, Ctx, LinkError, LinkErrorKind, Trace};
use crate::units::{CharacterFormat, Moment, Parity, SupplyVoltage};

/// Silence after which the adapter considers a reply complete, in bits. HIPERFACE allows 44 bits within a frame.
const IDLE_BITS: u64 = 55;
/// Longest time for which the firmware waits for a reply, in milliseconds.
pub const MAX_TIMEOUT_MS: u64 = 2_000;
/// Time from the last transfer until the supply is switched off, because an encoder may still be storing values. The
/// manual does not state how long this takes (`U`).
const STORE_TIME: Duration = Duration::from_secs(1);

/// Properties of the line between an adapter and a device.
#[derive(Clone, Copy, Debug)]
pub struct DeviceLine {
    pub format: CharacterFormat,
    /// Additional time allowed for late replies from the adapter.
    pub margin: Duration,
    /// Length of the longest reply of the device in characters.
    pub max_reply: usize,
}

/// Supply of the encoder by the adapter.
#[derive(Clone, Copy, Debug)]
pub struct LineSupply {
    pub voltage: SupplyVoltage,
    /// Time from power-on until the encoder replies.
    pub power_up: Duration,
}

/// A device on the serial line of an adapter. The adapter is identified and configured before the first frame.
pub struct AdapterSerialLink {
    wire: Box<dyn ByteLink>,
    clock: Arc<dyn Clock>,
    /// Port or host of the adapter.
    target: String,
    line: LineState,
    adapter: AdapterState,
    /// Length of the longest reply of the device in characters.
    max_reply: usize,
    supply: Option<LineSupply>,
    /// Whether the supply has been switched on since the adapter was identified.
    is_supplied: bool,
    format: CharacterFormat,
    /// Format that the adapter uses, or `None` if it is not configured.
    configured: Option<CharacterFormat>,
    /// Frame whose transfer has not begun.
    unsent: Vec<u8>,
    /// Time of the first start bit of the last reply.
    reply_start: Option<Moment>,
    last_transfer: Option<Moment>,
}

impl AdapterSerialLink {
    /// Creates a connection through an adapter that has not been identified.
    pub fn new(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        target: &str,
        DeviceLine { format, margin, max_reply }: DeviceLine,
        (supply, after): (Option<LineSupply>, SupplyAfterSession),
    ) -> Self {
        let mut adapter = AdapterState::default();
        adapter.set_supply_after_session(after);
        AdapterSerialLink {
            wire,
            clock,
            target: target.to_owned(),
            line: LineState::new(margin),
            adapter,
            max_reply,
            supply,
            is_supplied: false,
            format,
            configured: None,
            unsent: Vec::new(),
            reply_start: None,
            last_transfer: None,
        }
    }

    /// Runs one exchange with the adapter. Cancellation takes effect between exchanges, never within one.
    fn with_adapter<T>(
        &mut self,
        work: impl FnOnce(&mut Adapter<'_, '_>) -> Result<T, Failure>,
    ) -> Result<T, LinkError> {
        let (cancel, mut trace) = (CancelToken::default(), Trace::default());
        let ctx = Ctx { wire: &mut *self.wire, clock: &*self.clock, cancel: &cancel, trace: &mut trace };
        let mut line = SerialLine::new(ctx);
        let mut adapter = Adapter { line: &mut line, state: &mut self.line, adapter: &mut self.adapter };
        work(&mut adapter).map_err(|failure| match failure {
            Failure::Line(LineError::Link(error)) => error,
            // Neither occurs, because nothing is cancelled here and packets require no silence between them.
            Failure::Line(LineError::Cancelled | LineError::NeverSilent) => self.error(AdapterError::Silent),
            Failure::Adapter(error) => self.error(error),
        })
    }

    fn error(&self, cause: AdapterError) -> LinkError {
        LinkError::new(self.target.clone(), LinkErrorKind::Other(cause.to_string()))
    }

    /// Identifies the adapter, switches the supply on, and sets the format of the line.
    fn configure(&mut self) -> Result<(), LinkError> {
        if self.configured == Some(self.format) {
            return Ok(());
        }
        let (format, supply) = (self.format, self.supply.filter(|_| !self.is_supplied));
        let parity = match format.parity {
            Parity::None => 0,
            Parity::Odd => 1,
            Parity::Even => 2,
        };
        let request = Request::UartConfig { baud: format.baud.bits_per_second(), parity, turnaround_us: 0 };
        self.with_adapter(|adapter| {
            adapter.read_identity()?;
            if let Some(hello) = adapter.adapter.identity()
                && !hello.capabilities.contains(Capabilities::UART)
            {
                return Err(AdapterError::NoUart { name: hello.name.clone() }.into());
            }
            if let Some(LineSupply { voltage, power_up }) = supply {
                adapter.switch_supply_on(voltage)?;
                adapter.line.wait(power_up)?;
            }
            match adapter.send_request(&request)?.reply {
                Reply::UartConfig { .. } => Ok(()),
                other => Err(AdapterError::unexpected_reply(request.operation(), &other).into()),
            }
        })?;
        (self.configured, self.is_supplied) = (Some(format), true);
        Ok(())
    }

    /// Sends the frame and returns the reply, which is empty if the device did not reply before `until`.
    fn transfer(&mut self, until: Moment) -> Result<Vec<u8>, LinkError> {
        self.configure()?;
        let tx = std::mem::take(&mut self.unsent);
        let character = self.format.character_time();
        let duration_of = |count: usize| character.saturating_mul(u32::try_from(count).unwrap_or(u32::MAX));
        let sending = duration_of(tx.len());
        let timeout = until.duration_since(self.clock.now() + sending).min(Duration::from_millis(MAX_TIMEOUT_MS));
        let idle = self.format.baud.duration_of_bits(IDLE_BITS);
        let longest = sending + timeout + duration_of(self.max_reply) + idle;
        let microseconds = |duration: Duration| u32::try_from(duration.as_micros()).unwrap_or(u32::MAX);
        let request = Request::UartTransfer { timeout_us: microseconds(timeout), idle_us: microseconds(idle), tx };
        self.last_transfer = Some(self.clock.now());
        let transferred = self.with_adapter(|adapter| {
            // The request is not repeated, because the device may already have executed it.
            let answered = match adapter.request_within(&request, longest) {
                Ok(Some(answered)) => answered,
                // The device is silent, or the reply was damaged. An adapter that no longer replies is an error.
                Ok(None) => {
                    adapter.adapter.forget_identity();
                    adapter.read_identity()?;
                    return Ok(None);
                }
                Err(Failure::Adapter(AdapterError::Refused { code: ErrorCode::NO_REPLY, .. })) => {
                    return Ok(Some((None, Vec::new())));
                }
                Err(failure) => return Err(failure),
            };
            let Reply::UartTransfer { t_us, rx } = &answered.reply else {
                return Err(AdapterError::unexpected_reply(request.operation(), &answered.reply).into());
            };
            let start = adapter.adapter.local_time_of(*t_us, &answered);
            Ok(Some((Some(start), rx.clone())))
        })?;
        if transferred.is_none() {
            // A restarted adapter has lost its settings, and its supply is off.
            (self.configured, self.is_supplied) = (None, false);
        }
        let (start, rx) = transferred.unwrap_or_default();
        self.reply_start = start.filter(|_| !rx.is_empty());
        self.last_transfer = Some(self.clock.now());
        Ok(rx)
    }
}

impl ByteLink for AdapterSerialLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        if !self.unsent.is_empty() {
            // No reply to the last frame was awaited, so the frame has not been sent yet.
            self.transfer(self.clock.now())?;
        }
        self.unsent.extend(bytes);
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        if !self.unsent.is_empty() {
            let reply = self.transfer(until)?;
            if !reply.is_empty() {
                into.extend(reply);
                return Ok(());
            }
        }
        if self.clock.now() < until {
            self.wire.check_connection()?;
            self.clock.sleep_until(until);
        }
        Ok(())
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.send(&[])?;
        self.format = format;
        Ok(())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection()
    }

    fn reply_start(&self) -> Option<Moment> {
        self.reply_start
    }

    fn restore_state(&mut self) -> Result<(), LinkError> {
        if !self.adapter.must_switch_supply_off() {
            return Ok(());
        }
        if let Some(at) = self.last_transfer {
            self.clock.sleep_until(at + STORE_TIME);
        }
        self.with_adapter(|adapter| adapter.switch_off_after_session())
    }
}
