//! Single exchanges over the configuration pin. An exchange sends a request and receives bytes until the reply is
//! complete or the time limit expires. Bytes outside a frame are skipped, and a frame with a gap of 20 ms is abandoned.
//! The echo is recognised by its length, because no reply has this length. See sections 1 and 2 of the UBICOM
//! reference.

use std::time::Duration;

use super::{AttemptResult, ExchangeError, Master, WriteReaction};
use crate::bits::{ByteOrder, MaskedBytes};
use crate::buses::ubicom::protocol::{
    BYTE_TIME_OUT, Frame, NODE, PositionWord, Receiver, Reply, Request, WriteReply, character_bits,
};
use crate::devices::biss::procedures::error::{ReplyDamage, RequestedItem, requested_register};
use crate::devices::biss::procedures::position::PositionReading;
use crate::devices::biss::procedures::{Echo, Error};
use crate::devices::biss::protocol::RegisterAddress;
use crate::link::line::MAX_UNEXPECTED_BYTES;
use crate::units::Moment;

/// Length in bytes of the longest frame, the reply to 03h.
const LONGEST_FRAME: usize = PositionWord::BYTES + Frame::OVERHEAD;
/// Time after the reply time-out in which late bytes may arrive. Bytes that still arrive later are noise.
const NOISE: Duration = Duration::from_secs(1);

struct TimedReply {
    reply: Reply,
    at: Moment,
}

struct ReceivedBytes {
    receiver: Receiver,
    sent: Vec<u8>,
    /// The first bytes received, for the trace.
    raw: Vec<u8>,
    bytes: usize,
    echo_heard: bool,
    damage: Option<ReplyDamage>,
}

impl Master<'_> {
    pub(super) fn read_pin_once(&mut self, address: RegisterAddress) -> AttemptResult<u8> {
        let order = self.station.order.unwrap_or(ByteOrder::LowFirst);
        self.read_register_once(address.global_number(), order)
    }

    /// Sends a request whose reply reveals the byte order of register numbers.
    pub(super) fn probe_byte_order_once(&mut self) -> AttemptResult<u8> {
        self.read_register_once(Request::PROBE_REGISTER, ByteOrder::LowFirst)
    }

    fn read_register_once(&mut self, register: u16, order: ByteOrder) -> AttemptResult<u8> {
        Ok(match self.exchange(Request::Read { register }, order)? {
            Ok(TimedReply { reply: Reply::Value(value), .. }) => Ok(value),
            Ok(TimedReply { reply, .. }) => {
                return Err(Error::unexpected_reply(RequestedItem::Read(requested_register(register)), &reply));
            }
            Err(trouble) => Err(trouble),
        })
    }

    pub(super) fn write_pin_once(&mut self, address: RegisterAddress, value: u8) -> AttemptResult<WriteReaction> {
        let order = self.station.order.unwrap_or(ByteOrder::LowFirst);
        Ok(match self.exchange(Request::Write { register: address.global_number(), value }, order)? {
            Ok(TimedReply { reply: Reply::Written(WriteReply::Acknowledged), .. }) => Ok(WriteReaction::Yes),
            Ok(TimedReply { reply: Reply::Written(WriteReply::Refused), .. }) => Ok(WriteReaction::No(None)),
            Ok(TimedReply { reply, .. }) => {
                return Err(Error::unexpected_reply(RequestedItem::Write(address, value), &reply));
            }
            Err(trouble) => Err(trouble),
        })
    }

    pub(super) fn read_pin_position_once(&mut self) -> AttemptResult<PositionReading> {
        let (word, at) = match self.exchange(Request::POSITION, ByteOrder::LowFirst)? {
            Ok(TimedReply { reply: Reply::Position(word), at }) => (word, at),
            Ok(TimedReply { reply, .. }) => return Err(Error::unexpected_reply(RequestedItem::Position, &reply)),
            Err(trouble) => return Ok(Err(trouble)),
        };
        let layout = self.station.frame_layout();
        let Some(reading) = layout.decode_position(word) else {
            let (multiturn, singleturn) = (layout.multiturn_bits(), layout.singleturn_bits());
            return Err(Error::TooWide { word: word.to_u64(), multiturn, singleturn });
        };
        let is_split_known = self.station.is_split_known();
        Ok(Ok(PositionReading { is_split_known, ..PositionReading::new(at, &reading, &layout) }))
    }

    pub(super) fn max_pin_exchange_duration(&self) -> Duration {
        self.time_of_characters(2 * LONGEST_FRAME) + self.station.timeout + self.station.line.margin
    }

    fn time_of_characters(&self, count: usize) -> Duration {
        let format = self.station.format;
        format.baud.duration_of_bits(character_bits(format) * count as u64)
    }

    fn exchange(&mut self, request: Request, order: ByteOrder) -> AttemptResult<TimedReply> {
        self.line.begin_exchange(&mut self.station.line, BYTE_TIME_OUT)?;
        let frame = request.emit(order);
        let sent_at = self.now();
        self.station.line.mark_sent(sent_at);
        self.line.send(&frame, MaskedBytes::unmasked(&frame), sent_at)?;
        let deadline = sent_at + self.max_pin_exchange_duration();
        let received = ReceivedBytes {
            receiver: Receiver::new(NODE),
            sent: frame,
            raw: Vec::new(),
            bytes: 0,
            echo_heard: false,
            damage: None,
        };
        self.receive_reply(request, received, deadline)
    }

    fn receive_reply(
        &mut self,
        request: Request,
        mut received: ReceivedBytes,
        deadline: Moment,
    ) -> AttemptResult<TimedReply> {
        let gap = BYTE_TIME_OUT + self.station.line.margin;
        let mut last_at = self.now();
        let mut portion = Vec::new();
        loop {
            let under_way = received.receiver.is_waiting();
            // A frame that started in time may end later.
            let until = if under_way { self.now() + gap } else { deadline };
            portion.clear();
            self.line.receive(until, &mut portion)?;
            if portion.is_empty() && !under_way {
                return Ok(Err(self.finish_unanswered_exchange(received)));
            }
            if self.now() > deadline + NOISE {
                return Err(Error::NeverSilent);
            }
            if !portion.is_empty() {
                last_at = self.now();
            }
            received.bytes += portion.len();
            received.raw.extend(portion.iter().take(MAX_UNEXPECTED_BYTES.saturating_sub(received.raw.len())));
            received.receiver.push(&portion);
            let next = if portion.is_empty() { Receiver::handle_silence } else { Receiver::next_frame };
            while let Some(frame) = next(&mut received.receiver) {
                if let Some(reply) = self.match_reply(request, &frame, &mut received) {
                    let at = last_at - self.time_of_characters(frame.len());
                    self.record_reply(&received, &frame, at);
                    self.line.show(at, MaskedBytes::unmasked(&frame));
                    return Ok(Ok(TimedReply { reply, at }));
                }
            }
        }
    }

    fn match_reply(&self, request: Request, frame: &[u8], received: &mut ReceivedBytes) -> Option<Reply> {
        if frame == received.sent {
            received.echo_heard = true;
            return None;
        }
        // The receiver returns whole frames only.
        let parsed = Reply::parse(&Frame::parse(frame).ok()?, request.command());
        match parsed {
            // Bytes before the echo belong to a reply to an earlier request.
            Ok(_) if self.station.line.echo == Echo::On && !received.echo_heard => {
                received.damage = Some(ReplyDamage::Echo)
            }
            Ok(reply) => return Some(reply),
            Err(error) => received.damage = Some(ReplyDamage::Reply(error)),
        }
        None
    }

    fn record_reply(&mut self, received: &ReceivedBytes, reply: &[u8], at: Moment) {
        let state = &mut self.station.line;
        state.mark_replied();
        state.record_answer_start(at);
        state.echo.record_echo(received.echo_heard);
        if received.receiver.skipped_count() > 0 || received.damage.is_some() {
            // The checksum of this reply is correct, but the line has damaged other bytes.
            state.damaged += 1;
            state.quality.damaged += 1;
            self.station.noisy = true;
            let before = received.raw.windows(reply.len()).position(|window| window == reply);
            let before = received.raw.get(..before.unwrap_or(received.raw.len())).unwrap_or_default();
            self.line.show(at, MaskedBytes::unmasked(before.strip_prefix(&*received.sent).unwrap_or(before)));
        }
    }

    fn finish_unanswered_exchange(&mut self, received: ReceivedBytes) -> ExchangeError {
        let broken = received.raw.strip_prefix(&*received.sent).unwrap_or(&received.raw);
        let echo = if received.echo_heard { received.sent.len() } else { 0 };
        let bytes = received.bytes.saturating_sub(echo);
        let now = self.now();
        self.line.show(now, MaskedBytes::unmasked(broken));
        match received.damage {
            Some(damage) => ExchangeError::Damage(damage),
            None if bytes > 0 => ExchangeError::Damage(ReplyDamage::NoFrame { bytes }),
            None => ExchangeError::Silence { echo_heard: received.echo_heard },
        }
    }
}
