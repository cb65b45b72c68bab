//! Host side of the open adapter for all buses (reference "bridge"). A request is repeated once if no reply with its
//! sequence number arrives. Stream data that arrive before the reply are dropped. `flow` handles all other stream data.

mod drift;
pub(crate) mod flow;
mod power;
mod serial_link;
mod skew;
mod tap;

use std::time::Duration;

use power::SupplyState;

use crate::bits::MaskedBytes;
use crate::buses::bridge::protocol::{
    BodyError, Capabilities, ErrorCode, Hello, Message, Operation, Packet, REQUEST_RETRY_TIMEOUT, Receiver, Reply,
    Request,
};
use crate::expected::Quantity;
use crate::link::line::{LineError, LineState, SerialLine};
use crate::parameter::WholeNumbers;
use crate::units::{Moment, SupplyVoltage};

pub use flow::Chunk;
pub use power::SupplyAfterSession;
pub(crate) use power::log_supply_failure;
pub use serial_link::{AdapterSerialLink, DeviceLine, LineSupply, MAX_TIMEOUT_MS};
pub use tap::{AdapterStreamError, StreamRequest, StreamTap, StreamingAdapter};

/// BiSS time-out in microseconds. An encoder needs 18 µs to notice the end of a frame. See manual, table 3.
pub(crate) const BISS_TIME_OUT_US: u16 = 20;

/// Clock frequencies that may be requested. An adapter uses the nearest one that it supports.
pub(crate) const CLOCK: WholeNumbers<u32> = WholeNumbers(Quantity::Hertz, 80_000..=10_000_000);

/// Extra time to wait for an overdue reply while the adapter keeps sending other data.
const OTHER_DATA_TIME: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, Default)]
pub struct AdapterState {
    receiver: Receiver,
    next_seq: u8,
    hello: Option<Hello>,
    has_received_bytes: bool,
    clocks: ClockOffsetBounds,
    power: SupplyState,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AdapterError {
    /// The adapter has not replied to a request and its repetition.
    #[error("the adapter does not answer")]
    Silent,
    #[error("the adapter uses version {got} of the bridge protocol, but this program uses version {expected}")]
    Version { expected: u8, got: u8 },
    #[error("the adapter {name} does not support BiSS")]
    NoBiss { name: String },
    #[error("the adapter {name} does not support SSI")]
    NoSsi { name: String },
    #[error("the adapter {name} cannot sample analogue signals")]
    NoAnalog { name: String },
    #[error("the adapter {name} has no serial line")]
    NoUart { name: String },
    #[error("the adapter {name} cannot supply an encoder")]
    NoSupply { name: String },
    /// The supply voltage exceeds the limit of the encoder, so the supply was switched off again.
    #[error("the adapter supplied {measured} mV instead of {given} mV; the encoder tolerates {greatest} mV")]
    Overvoltage {
        /// Requested voltage in millivolts.
        given: u16,
        measured: u16,
        /// Highest supply voltage of the encoder in millivolts.
        greatest: u16,
    },
    #[error("the adapter no longer sends data")]
    StreamSilent,
    /// The sample numbers of the stream have started again from 0.
    #[error("the adapter has restarted")]
    Restarted,
    /// Stream data do not conform to this version of the protocol.
    #[error("the data from the adapter cannot be decoded: {cause}")]
    Data { cause: BodyError },
    #[error("the adapter refuses operation 0x{:02X} with code {}: {text}", operation.byte(), code.byte())]
    Refused { operation: Operation, code: ErrorCode, text: String },
    /// The reply does not conform to this version of the protocol.
    #[error("the reply of the adapter to operation 0x{:02X} cannot be decoded: {cause}", operation.byte())]
    Reply { operation: Operation, cause: BodyError },
    #[error("the adapter answers operation 0x{:02X} with operation 0x{:02X}", requested.byte(), got.byte())]
    Other { requested: Operation, got: Operation },
}

#[derive(Debug)]
pub(crate) enum Failure {
    Adapter(AdapterError),
    Line(LineError),
}

impl AdapterError {
    /// Creates the error for a reply to an operation that was not requested.
    pub fn unexpected_reply(requested: Operation, reply: &Reply) -> Self {
        AdapterError::Other { requested, got: reply.operation() }
    }
}

impl From<AdapterError> for Failure {
    fn from(error: AdapterError) -> Self {
        Failure::Adapter(error)
    }
}

impl From<LineError> for Failure {
    fn from(error: LineError) -> Self {
        Failure::Line(error)
    }
}

/// A reply, with the local times between which the adapter created it.
pub(crate) struct TimedReply {
    pub(crate) reply: Reply,
    sent_at: Moment,
    received_at: Moment,
}

impl AdapterState {
    /// Returns the identity of the adapter, or `None` if it has not been read yet.
    pub const fn identity(&self) -> Option<&Hello> {
        self.hello.as_ref()
    }

    /// Sets what happens to the encoder supply after the session.
    pub fn set_supply_after_session(&mut self, after: SupplyAfterSession) {
        self.power.after = after;
    }

    /// Discards the identity, so that it is read again before the next use. The state of the encoder supply is kept,
    /// since HELLO does not change it.
    pub(crate) fn forget_identity(&mut self) {
        *self = AdapterState { power: self.power, ..AdapterState::default() };
    }

    /// Returns whether the encoder had power before the session, or `None` if this is unknown.
    pub(crate) const fn was_supplied_at_start(&self) -> Option<bool> {
        self.power.was_on
    }

    /// Sets whether the encoder had power before the session.
    pub(crate) const fn set_supplied_at_start(&mut self, is_supplied: bool) {
        self.power.was_on = Some(is_supplied);
    }

    /// Returns whether the supply must be switched off at the end of the session.
    pub(crate) fn must_switch_supply_off(&self) -> bool {
        self.power.must_switch_off()
    }

    /// Returns whether the adapter has sent any bytes, including damaged ones.
    pub(crate) const fn has_received(&self) -> bool {
        self.has_received_bytes
    }

    /// Converts the adapter time `t_us`, in microseconds, to local time. `answered` is the reply that contains `t_us`.
    pub(crate) fn local_time_of(&mut self, t_us: u64, answered: &TimedReply) -> Moment {
        self.clocks.local_time_of(t_us, answered.sent_at, answered.received_at)
    }
}

/// Host side of the adapter for the duration of one exchange.
pub(crate) struct Adapter<'m, 'a> {
    pub(crate) line: &'m mut SerialLine<'a>,
    pub(crate) state: &'m mut LineState,
    pub(crate) adapter: &'m mut AdapterState,
}

impl Adapter<'_, '_> {
    /// Reads the identity of the adapter. This is done only once per session, because it ends all streams. The supply
    /// is left unchanged.
    ///
    /// # Errors
    /// Returns [`AdapterError::Version`] if the adapter uses another version of the protocol, or another [`Failure`] if
    /// the exchange fails.
    pub(crate) fn read_identity(&mut self) -> Result<(), Failure> {
        if self.adapter.hello.is_none() {
            // The empty packet terminates a packet that another host may have sent only in part.
            let answered = self.send_with_retry(&Request::Hello, &[0])?;
            let Reply::Hello(hello) = answered.reply else {
                return Err(AdapterError::unexpected_reply(Operation::Hello, &answered.reply).into());
            };
            // Adapters that do not report the state of the supply leave this bit clear.
            if self.adapter.power.was_on.is_none() && hello.capabilities.contains(Capabilities::SUPPLY_ON) {
                self.adapter.power.was_on = Some(true);
            }
            self.adapter.hello = Some(hello);
        }
        Ok(())
    }

    /// Switches the encoder supply on. Returns the measured voltage in millivolts and the current in milliamperes. If
    /// the voltage is too high for the encoder, the supply is switched off again.
    ///
    /// # Errors
    /// Returns [`AdapterError::NoSupply`] or [`AdapterError::Overvoltage`], or another [`Failure`] if the exchange
    /// fails.
    pub(crate) fn switch_supply_on(&mut self, voltage: SupplyVoltage) -> Result<(u16, u16), Failure> {
        if let Some(hello) = self.adapter.identity().filter(|hello| !hello.capabilities.contains(Capabilities::SUPPLY))
        {
            return Err(AdapterError::NoSupply { name: hello.name.clone() }.into());
        }
        let SupplyVoltage { nominal, greatest, .. } = voltage;
        // The supply may be on even if the reply is lost.
        self.adapter.power.is_switched_on = true;
        let answered = self.send_request(&Request::Supply { on: true, millivolt: nominal })?;
        let Reply::Supply { millivolt: measured, milliampere, .. } = answered.reply else {
            return Err(AdapterError::unexpected_reply(Operation::Supply, &answered.reply).into());
        };
        if measured > greatest {
            self.switch_off()?;
            return Err(AdapterError::Overvoltage { given: nominal, measured, greatest }.into());
        }
        Ok((measured, milliampere))
    }

    /// Switches the encoder supply off at the end of a session unless it has to stay on.
    ///
    /// # Errors
    /// Returns an error if the adapter does not switch the supply off.
    pub(crate) fn switch_off_after_session(&mut self) -> Result<(), Failure> {
        if self.adapter.must_switch_supply_off() { self.switch_off() } else { Ok(()) }
    }

    fn switch_off(&mut self) -> Result<(), Failure> {
        self.send_request(&Request::Supply { on: false, millivolt: 0 })?;
        (self.adapter.power.is_switched_on, self.adapter.power.was_on) = (false, Some(false));
        Ok(())
    }

    /// Sends a request, and repeats it once if there is no reply. The request must be idempotent.
    ///
    /// # Errors
    /// Returns an error if there is no reply, or not the expected one.
    pub(crate) fn send_request(&mut self, request: &Request) -> Result<TimedReply, Failure> {
        self.send_with_retry(request, &[])
    }

    fn send_with_retry(&mut self, request: &Request, before: &[u8]) -> Result<TimedReply, Failure> {
        for _ in 0..2 {
            if let Some(answered) = self.exchange(request, before, Duration::ZERO)? {
                return Ok(answered);
            }
        }
        Err(AdapterError::Silent.into())
    }

    /// Sends a request once. Returns `None` if there is no reply.
    ///
    /// # Errors
    /// Returns an error if the reply is not the expected one.
    pub(crate) fn request_once(&mut self, request: &Request) -> Result<Option<TimedReply>, Failure> {
        self.request_within(request, Duration::ZERO)
    }

    /// Sends a request once and allows the adapter up to `duration` to process it. Returns `None` if there is no reply.
    ///
    /// # Errors
    /// Returns an error if the reply is not the expected one.
    fn request_within(&mut self, request: &Request, duration: Duration) -> Result<Option<TimedReply>, Failure> {
        self.exchange(request, &[], duration)
    }

    fn exchange(
        &mut self,
        request: &Request,
        before: &[u8],
        duration: Duration,
    ) -> Result<Option<TimedReply>, Failure> {
        self.line.start()?;
        let seq = self.adapter.next_seq;
        self.adapter.next_seq = seq.wrapping_add(1);
        let bytes = [before, &request.emit(seq).emit()].concat();
        let sent_at = self.line.now();
        self.state.mark_sent(sent_at);
        self.line.send(&bytes, MaskedBytes::unmasked(&bytes), sent_at).map_err(LineError::Link)?;
        let deadline = sent_at + duration + REQUEST_RETRY_TIMEOUT + self.state.margin;
        let mut portion = Vec::new();
        loop {
            let broken = self.adapter.receiver.dropped_count();
            while let Some(packet) = self.adapter.receiver.next_packet() {
                if let Some(reply) = self.match_reply(request, seq, &packet)? {
                    self.state.mark_replied();
                    self.state.record_answer_start(self.line.now());
                    return Ok(Some(TimedReply { reply, sent_at, received_at: self.line.now() }));
                }
            }
            let broken = self.adapter.receiver.dropped_count() - broken;
            self.state.damaged += broken;
            self.state.quality.damaged += broken;
            if let Some(bytes) = self.adapter.receiver.take_damaged_bytes() {
                let now = self.line.now();
                self.line.show(now, MaskedBytes::unmasked(&bytes));
            }
            portion.clear();
            self.line.receive(deadline, &mut portion).map_err(LineError::Link)?;
            if portion.is_empty() {
                self.state.damaged += 1;
                self.state.quality.unanswered += 1;
                return Ok(None);
            }
            self.adapter.has_received_bytes = true;
            self.adapter.receiver.push(&portion);
            if self.line.now() >= deadline + OTHER_DATA_TIME {
                self.state.damaged += 1;
                return Ok(None);
            }
        }
    }

    /// Returns the reply in a packet, or `None` if the packet does not answer the request. Late replies have another
    /// sequence number.
    fn match_reply(&mut self, request: &Request, seq: u8, packet: &Packet) -> Result<Option<Reply>, AdapterError> {
        let operation = request.operation();
        let parsed = Message::parse(packet);
        if packet.seq != seq || matches!(parsed, Ok(Message::Data(_))) {
            return Ok(None);
        }
        let now = self.line.now();
        self.line.show(now, MaskedBytes::unmasked(&packet.emit()));
        match parsed {
            Ok(Message::Reply(reply)) if reply.operation() == operation => Ok(Some(reply)),
            Ok(Message::Reply(reply)) => Err(AdapterError::unexpected_reply(operation, &reply)),
            Ok(Message::Error { code, text, .. }) => Err(AdapterError::Refused { operation, code, text }),
            Ok(Message::Data(_)) => Ok(None),
            Err(BodyError::Version { expected, got }) => Err(AdapterError::Version { expected, got }),
            Err(cause) => Err(AdapterError::Reply { operation, cause }),
        }
    }
}

/// Bounds of the offset between the adapter's clock and the local clock in nanoseconds. Each exchange narrows them,
/// because the adapter reads its clock between the request and the reply.
#[derive(Clone, Copy, Debug, Default)]
struct ClockOffsetBounds {
    bounds: Option<(i128, i128)>,
}

impl ClockOffsetBounds {
    fn local_time_of(&mut self, t_us: u64, sent_at: Moment, received_at: Moment) -> Moment {
        let nanoseconds = |moment: Moment| i128::try_from(moment.since_start().as_nanos()).unwrap_or(i128::MAX);
        let own = i128::from(t_us) * 1000;
        let (least, most) = (nanoseconds(sent_at) - own, nanoseconds(received_at) - own);
        let narrowed =
            self.bounds.map(|(low, high)| (low.max(least), high.min(most))).filter(|(low, high)| low <= high);
        // If a clock has drifted or the adapter has restarted, only the last exchange is used.
        let (low, high) = narrowed.unwrap_or((least, most));
        self.bounds = Some((low, high));
        let moment = u64::try_from(own + (low + high) / 2).unwrap_or(0);
        Moment::from_elapsed(std::time::Duration::from_nanos(moment)).clamp(sent_at, received_at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn at(microseconds: u64) -> Moment {
        Moment::from_elapsed(Duration::from_micros(microseconds))
    }

    #[test]
    fn estimates_adapter_clock() {
        let mut clocks = ClockOffsetBounds::default();
        // The local clock is 1000 µs ahead. The request is sent at 2000, the adapter samples at 1100 of its clock,
        // and the reply arrives at 2400.
        assert_eq!(clocks.local_time_of(1100, at(2000), at(2400)), at(2200));
        // The bounds of the offset were 900 to 1300. This exchange yields 995 to 1395, so 995 to 1300 remain.
        assert_eq!(clocks.local_time_of(2005, at(3000), at(3400)), at(2005) + Duration::from_nanos(1_147_500));
        // This exchange yields 950 to 1010, so 995 to 1010 remain.
        assert_eq!(clocks.local_time_of(3000, at(3950), at(4010)), at(3000) + Duration::from_nanos(1_002_500));
        // A slow exchange does not widen the range again.
        assert_eq!(clocks.local_time_of(5000, at(5500), at(9000)), at(5000) + Duration::from_nanos(1_002_500));
        // The adapter has restarted.
        assert_eq!(clocks.local_time_of(10, at(20_000), at(20_100)), at(20_050));
        assert_eq!(clocks.local_time_of(u64::MAX, at(30_000), at(30_100)), at(30_050));
    }
}
