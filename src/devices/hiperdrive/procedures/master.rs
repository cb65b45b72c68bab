//! Host side of explicit messages (reference, section 7). Each connection has one session. Replies are matched to
//! requests by a number in the context field. Late replies are skipped and counted.
//!
//! A read without a reply is repeated. A request that sets a value is sent once, and if its reply is lost, the value is
//! read back. TCP keeps the order, so the device handles this read after the lost request.

mod connection;
mod refusal;

use std::time::Duration;

pub use connection::OpenedConnection;

use super::error::{ErrorReply, LateReplyError, ReplyDamage, RequestedItem, WrongLength};
use super::{Error, Station};
use crate::bits::MaskedBytes;
use crate::buses::ethernet_ip::protocol::{
    Body, Command, EncapsulationStatus, Frame, GeneralStatus, Identity as IdentityObject, Item, ItemList, Receiver,
    Reply, Request,
};
use crate::devices::hiperdrive::protocol::drive_parameter::{ACKNOWLEDGE, CONTROL, REFERENCE, RESET, SERVICE, TARGET};
use crate::devices::hiperdrive::protocol::{
    ParameterAccess, ParameterNumber, ParameterRow, STORE_TIME, Topology, Travel, Value, ValueError,
};
use crate::link::Ctx;
use crate::link::line::{MAX_ATTEMPTS, SerialLine};
use crate::units::Moment;

/// Pause after bytes that do not form a frame. The next byte is expected to start a new frame.
const RESYNC_PAUSE: Duration = Duration::from_millis(50);
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(50);
/// Margin added to the time that the manual gives for a long operation.
const REPLY_TIME_MARGIN: Duration = Duration::from_millis(500);

/// Host side of the explicit messages to a device, for the duration of one job.
pub struct Master<'a> {
    line: SerialLine<'a>,
    station: &'a mut Station,
}

enum ExchangeError {
    Silence,
    Damage(ReplyDamage),
    Status(EncapsulationStatus),
}

impl<D: Into<ReplyDamage>> From<D> for ExchangeError {
    fn from(damage: D) -> Self {
        ExchangeError::Damage(damage.into())
    }
}

/// Whether a request may be repeated without checking its effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RetryPolicy {
    Always,
    /// The request is sent once. `takes` is the time limit for the reply, or `None` for the usual time limit.
    Never {
        takes: Option<Duration>,
    },
}

/// Policy for requests that are sent once, with the usual time limit.
const SEND_ONCE: RetryPolicy = RetryPolicy::Never { takes: None };

impl<'a> Master<'a> {
    pub fn new(ctx: Ctx<'a>, station: &'a mut Station) -> Self {
        station.line.begin_job();
        Master { line: SerialLine::new(ctx), station }
    }

    pub fn now(&self) -> Moment {
        self.line.now()
    }

    pub fn station(&self) -> &Station {
        self.station
    }

    pub(super) fn set_topology(&mut self, topology: Topology) {
        self.station.known.topology = Some(topology);
    }

    pub(super) fn remember_device(&mut self, category: &str, serial_number: &str) {
        self.station.identified = Some((category.to_owned(), serial_number.to_owned()));
    }

    /// Waits, unless cancelled.
    ///
    /// # Errors
    /// Returns [`Error::Cancelled`] if the job is cancelled.
    pub(super) fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        Ok(self.line.wait(duration)?)
    }

    pub(super) fn check_cancel(&self) -> Result<(), Error> {
        Ok(self.line.check_cancel()?)
    }

    /// Runs `work` to its end, ignoring any cancellation until then. `work` must leave the device in a safe state.
    pub fn run_uncancellable<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.line.ignore_cancellation(true);
        let result = work(self);
        self.line.ignore_cancellation(before);
        result
    }

    /// Reads a parameter.
    ///
    /// # Errors
    /// Returns [`Error::Unknown`], [`Error::WriteOnly`], [`Error::NoPlace`], [`Error::NoDrive`] or [`Error::Refused`]
    /// if the parameter cannot be read, [`Error::Length`] if the number has the wrong length, or another error if the
    /// exchange fails.
    pub fn read(&mut self, number: ParameterNumber) -> Result<Value, Error> {
        let row = number.row().ok_or(Error::Unknown(number))?;
        if row.access == ParameterAccess::Write {
            return Err(Error::WriteOnly { number, name: row.name });
        }
        let requested = RequestedItem::Parameter(number);
        let request = Request::get(number.class(), 1, number.attribute());
        let data = match self.request(requested, &request, RetryPolicy::Always) {
            Err(Error::Refused { refusal, .. }) => return Err(self.find_rejection_reason(requested, number, refusal)?),
            ended => ended?.data,
        };
        row.kind.parse(&data).map_err(|cause| match cause {
            ValueError::Length { expected, got } => WrongLength { number, name: row.name, expected, got }.into(),
            cause => Error::Damaged { requested, tries: 1, cause: cause.into() },
        })
    }

    /// Reads a numeric parameter.
    ///
    /// # Errors
    /// Returns any error that [`read`](Self::read) returns.
    pub fn read_number(&mut self, number: ParameterNumber) -> Result<i64, Error> {
        match self.read(number)? {
            Value::Number(value) => Ok(value),
            Value::Text(_) => Err(Error::Value { number, cause: ValueError::TextForNumber }),
        }
    }

    /// Reads a string parameter.
    ///
    /// # Errors
    /// Returns any error that [`read`](Self::read) returns.
    pub fn read_text(&mut self, number: ParameterNumber) -> Result<String, Error> {
        match self.read(number)? {
            Value::Text(text) => Ok(text),
            Value::Number(_) => Err(Error::Value { number, cause: ValueError::NumberForText }),
        }
    }

    /// Sets a parameter. If the reply is lost, the parameter is read back and set again only if its value has not
    /// changed yet. A parameter that triggers an action is never sent twice.
    ///
    /// # Errors
    /// Returns [`Error::OutOfRange`], [`Error::ReadOnly`] or [`Error::Motion`] without sending anything if the value
    /// must not be set. Returns [`Error::Refuses`] or [`Error::Refused`] if the device rejects the value, or another
    /// error if the exchange fails.
    pub(super) fn set_parameter(&mut self, number: ParameterNumber, wanted: i64) -> Result<(), Error> {
        let row = writable_parameter(number)?;
        // The plan has already checked the travel.
        row.check_value(number, wanted, Travel::UNKNOWN)?;
        let data = row.kind.emit(&Value::Number(wanted)).map_err(|cause| Error::Value { number, cause })?;
        let requested = RequestedItem::Set(number);
        let request = Request::set_attribute(number.class(), 1, number.attribute(), data);
        let once = RetryPolicy::Never { takes: row.write_duration(wanted, self.station.known.topology) };
        let mut tries = 0;
        loop {
            tries += 1;
            match self.request(requested, &request, once) {
                Ok(_) => return Ok(()),
                Err(Error::Refused { refusal, .. }) => {
                    return Err(self.write_rejection_reason(number, wanted, refusal)?);
                }
                Err(error @ (Error::NoReply { .. } | Error::Damaged { .. })) => {
                    if triggers_action(row) || self.run_uncancellable(|master| master.read_number(number))? == wanted {
                        return if triggers_action(row) { Err(error) } else { Ok(()) };
                    }
                    if tries >= MAX_ATTEMPTS {
                        return Err(error);
                    }
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Reads the identity object, which every EtherNet/IP device has.
    ///
    /// # Errors
    /// Returns [`Error::Refused`] if the device rejects the request, or another error if the exchange fails.
    pub fn read_identity_object(&mut self) -> Result<IdentityObject, Error> {
        let requested = RequestedItem::Identity;
        let reply = self.request(requested, &Request::get_all(IdentityObject::CLASS, 1), RetryPolicy::Always)?;
        IdentityObject::parse_all(&reply.data).map_err(|cause| Error::Damaged {
            requested,
            tries: 1,
            cause: cause.into(),
        })
    }

    pub(super) fn read_attribute(
        &mut self,
        requested: RequestedItem,
        class: u16,
        attribute: u16,
    ) -> Result<Vec<u8>, Error> {
        Ok(self.request(requested, &Request::get(class, 1, attribute), RetryPolicy::Always)?.data)
    }

    /// Sets an attribute of the TCP/IP object. The request is sent once. The device stores the attribute before it
    /// replies.
    ///
    /// # Errors
    /// Returns [`Error::Refused`] if the device rejects the request, or another error if the exchange fails.
    pub(super) fn set_attribute(
        &mut self,
        requested: RequestedItem,
        (class, attribute): (u16, u16),
        data: Vec<u8>,
    ) -> Result<(), Error> {
        self.request(
            requested,
            &Request::set_attribute(class, 1, attribute, data),
            RetryPolicy::Never { takes: Some(STORE_TIME) },
        )?;
        Ok(())
    }

    /// Returns how long to wait for the operation that setting a parameter to this value starts.
    pub(super) fn max_wait(&self, number: ParameterNumber, value: i64) -> Duration {
        let takes = number.row().and_then(|row| row.write_duration(value, self.station.known.topology));
        RetryPolicy::Never { takes }.reply_timeout(self.station.link.timeout)
    }

    fn request(&mut self, requested: RequestedItem, request: &Request, repeats: RetryPolicy) -> Result<Reply, Error> {
        self.request_with_items(requested, request, &[], repeats).map(|(reply, _)| reply)
    }

    /// Sends a request to an object, with additional items. Returns the reply and the additional items in it.
    fn request_with_items(
        &mut self,
        requested: RequestedItem,
        request: &Request,
        beside: &[Item],
        repeats: RetryPolicy,
    ) -> Result<(Reply, ItemList), Error> {
        let (reply, items) = self.send_with_retries(requested, repeats, |master| {
            let session = master.session()?;
            let items = ItemList([&[Item::Null, Item::UnconnectedData(request.emit())], beside].concat());
            let body = Body::Data { interface: 0, timeout_s: 0, items };
            let frame = Frame { session, data: body.emit(), ..Frame::unconnected_message(session, [0; 8], Vec::new()) };
            Ok(match master.exchange(frame, repeats)? {
                Ok(frame) => parse_reply(request, &frame),
                Err(trouble) => Err(trouble),
            })
        })?;
        if reply.status == GeneralStatus::OK {
            return Ok((reply, items));
        }
        let Reply { service, status, extended, .. } = reply;
        Err(Error::Refused { requested, refusal: ErrorReply { service, status, extended } })
    }

    /// Returns the session number, opening the session on the first call.
    fn session(&mut self) -> Result<u32, Error> {
        if let Some(session) = self.station.session {
            return Ok(session);
        }
        let frame = self.send_with_retries(RequestedItem::Session, RetryPolicy::Always, |master| {
            master.exchange(Frame::register([0; 8]), RetryPolicy::Always)
        })?;
        self.station.session = Some(frame.session);
        Ok(frame.session)
    }

    /// Ends the session. The device does not reply.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub fn unregister_session(&mut self) -> Result<(), Error> {
        let Some(session) = self.station.session.take() else { return Ok(()) };
        let bytes = Frame::unregister_session(session).emit();
        let now = self.line.now();
        Ok(self.line.send(&bytes, MaskedBytes::unmasked(&bytes), now)?)
    }

    /// Sends a request, and repeats it if the retry policy permits and a repetition is useful.
    fn send_with_retries<T>(
        &mut self,
        requested: RequestedItem,
        repeats: RetryPolicy,
        mut once: impl FnMut(&mut Self) -> Result<Result<T, ExchangeError>, Error>,
    ) -> Result<T, Error> {
        let (mut tries, late) = (0, self.station.late);
        let (usual, within) = (self.station.link.timeout, repeats.reply_timeout(self.station.link.timeout));
        loop {
            tries += 1;
            let trouble = match once(self)? {
                Ok(answer) => {
                    self.station.line.mark_replied();
                    self.station.line.clear_error();
                    return Ok(answer);
                }
                Err(trouble) => trouble,
            };
            match &trouble {
                ExchangeError::Silence => self.station.line.quality.unanswered += 1,
                ExchangeError::Damage(_) => self.station.line.quality.damaged += 1,
                ExchangeError::Status(_) => {}
            }
            let longest = within + self.station.line.margin;
            // The device rejects a session immediately.
            let took = if let ExchangeError::Status(_) = trouble { usual + self.station.line.margin } else { longest };
            let may = self.line.may_retry(&mut self.station.line, tries, took);
            match trouble {
                // The session no longer exists in the device, so it did not execute the request.
                ExchangeError::Status(EncapsulationStatus::NO_SESSION)
                    if may && requested != RequestedItem::Session =>
                {
                    self.station.session = None;
                }
                ExchangeError::Status(status) => return Err(Error::Encapsulation { requested, status }),
                _ if may && repeats == RetryPolicy::Always => {}
                ExchangeError::Silence => {
                    let took = self.station.replies.longest_reply_time();
                    let is_late = self.station.late > late && took >= longest;
                    let late = is_late.then_some(LateReplyError { took, waited: within });
                    return Err(Error::NoReply { requested, tries, late });
                }
                ExchangeError::Damage(cause) => return Err(Error::Damaged { requested, tries, cause }),
            }
        }
    }

    fn trace_unparsed_bytes(&mut self) {
        let (now, rest) = (self.line.now(), self.station.receiver.take_unparsed_bytes());
        self.line.show(now, MaskedBytes::unmasked(&rest));
    }

    /// Sends a frame with a new number in its context field, and waits for the reply with the same number.
    fn exchange(&mut self, mut frame: Frame, repeats: RetryPolicy) -> Result<Result<Frame, ExchangeError>, Error> {
        self.line.start()?;
        let sent_at = self.line.now();
        let takes_long = matches!(repeats, RetryPolicy::Never { takes: Some(_) });
        frame.context = self.station.begin_request(sent_at, takes_long).to_le_bytes();
        let bytes = frame.emit();
        self.station.line.mark_sent(sent_at);
        self.line.send(&bytes, MaskedBytes::unmasked(&bytes), sent_at)?;
        let deadline = sent_at + repeats.reply_timeout(self.station.link.timeout) + self.station.line.margin;
        let mut heard = Vec::new();
        loop {
            loop {
                match self.station.receiver.next_frame() {
                    Ok(Some(answer)) => {
                        let now = self.line.now();
                        self.line.show(now, MaskedBytes::unmasked(&answer.emit()));
                        self.station.record_reply(u64::from_le_bytes(answer.context), now);
                        let recorded = self.station.recorded && answer.command == frame.command;
                        if !recorded && !answer.is_reply_to(&frame) {
                            self.station.late += 1;
                        } else if answer.status == EncapsulationStatus::OK || has_session(&answer) {
                            return Ok(Ok(answer));
                        } else {
                            return Ok(Err(ExchangeError::Status(answer.status)));
                        }
                    }
                    Ok(None) => break,
                    Err(cause) => {
                        self.trace_unparsed_bytes();
                        self.line.wait_for_silence(&mut self.station.line, RESYNC_PAUSE)?;
                        self.station.receiver = Receiver::default();
                        return Ok(Err(cause.into()));
                    }
                }
            }
            let now = self.line.now();
            if now >= deadline {
                let bytes = self.station.receiver.pending_len();
                self.trace_unparsed_bytes();
                self.station.receiver = Receiver::default();
                return Ok(Err(if bytes == 0 { ExchangeError::Silence } else { ReplyDamage::Cut { bytes }.into() }));
            }
            // A request that sets something is always given time for its reply.
            if repeats == RetryPolicy::Always {
                self.line.check_cancel()?;
            }
            heard.clear();
            self.line.receive((now + CANCEL_CHECK_INTERVAL).min(deadline), &mut heard)?;
            self.station.receiver.push(&heard);
        }
    }
}

/// Returns whether an error reply contains the number of an existing session. A stream has a single session. If the
/// reply to the first RegisterSession was lost, the device rejects the second one and returns this number.
fn has_session(answer: &Frame) -> bool {
    answer.command == Command::REGISTER_SESSION
        && answer.status == EncapsulationStatus::UNSUPPORTED
        && answer.session != 0
}

fn parse_reply(request: &Request, frame: &Frame) -> Result<(Reply, ItemList), ExchangeError> {
    let Body::Data { items, .. } = frame.parse_body()? else { return Err(ReplyDamage::Empty.into()) };
    let reply = Reply::parse(items.unconnected_data().ok_or(ReplyDamage::Empty)?)?;
    let services = (request.service.code(), reply.service.code());
    match services {
        (requested, got) if requested == got => Ok((reply, items)),
        (requested, got) => Err(ReplyDamage::Service { requested, got }.into()),
    }
}

/// Returns the table row of a parameter. Returns an error if the parameter must not be set with explicit messages.
fn writable_parameter(number: ParameterNumber) -> Result<&'static ParameterRow, Error> {
    let row = number.row().ok_or(Error::Unknown(number))?;
    match (row.access, row.number) {
        (ParameterAccess::Read, _) => Err(Error::ReadOnly { number, name: row.name }),
        (_, CONTROL..=TARGET) => Err(Error::Motion { number, name: row.name }),
        _ => Ok(row),
    }
}

/// Returns whether setting the parameter triggers an action. Reading it back then proves nothing.
const fn triggers_action(row: &ParameterRow) -> bool {
    matches!(row.number, SERVICE | ACKNOWLEDGE | REFERENCE | RESET)
}

impl RetryPolicy {
    /// Returns the time limit for a reply, without the margin for the line. `timeout` is the usual time limit.
    fn reply_timeout(self, timeout: Duration) -> Duration {
        match self {
            RetryPolicy::Never { takes: Some(takes) } => timeout.max(takes + REPLY_TIME_MARGIN),
            RetryPolicy::Always | RetryPolicy::Never { takes: None } => timeout,
        }
    }
}
