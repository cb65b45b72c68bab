//! Process data behind a Modbus/TCP gateway. Two input registers contain the IN word, and two holding registers contain
//! the OUT word.
//!
//! Each request has a separate number, so a late reply is never mistaken for the next one. Every request may be
//! repeated, because writing an OUT word twice has the same effect as writing it once.

use std::time::Duration;

use rmodbus::client::ModbusRequest;
use rmodbus::{ModbusProto, guess_response_frame_len};

use super::LinkParameters;
use super::data::ProcessData;
use super::error::{Exception, ReplyDamage, RequestedItem};
use super::station::Station;
use super::{Error, KnownState};
use crate::bits::MaskedBytes;
use crate::devices::interbus::protocol::WordOrder;
use crate::link::Ctx;
use crate::link::line::{LineState, SerialLine};
use crate::units::Moment;

/// Number of unanswered attempts after which a gateway is considered lost.
const MAX_UNANSWERED: u32 = 3;
const MAX_ATTEMPTS: u32 = 5;
/// Pause after a rejection before the request is repeated.
const BUSY_PAUSE: Duration = Duration::from_millis(200);
/// Silence required after bytes that are not a frame. The next byte then starts a new frame.
const RESYNC_SILENCE: Duration = Duration::from_millis(50);
/// Interval at which cancellation is checked.
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(50);
/// Length of the header before the function code, in bytes: transaction number, protocol, length and unit.
const HEADER: usize = 7;
/// Length in bytes of the shortest frame, which is a rejection.
const MIN_FRAME_LEN: usize = HEADER + 2;
/// Bit of the function code that marks a rejection.
const EXCEPTION_BIT: u8 = 0x80;

/// Access to one encoder through its gateway, for the duration of one job.
pub struct Gateway<'a> {
    line: SerialLine<'a>,
    link: LinkParameters,
    recorded: bool,
    state: State<'a>,
    /// Last OUT word written in this job, or `None` if the reply to the write was lost.
    written: Option<u32>,
}

/// State of the gateway that outlives a job.
struct State<'a> {
    line: &'a mut LineState,
    next: &'a mut u16,
    waiting: &'a mut Vec<u8>,
    silent: &'a mut bool,
}

enum ExchangeError {
    Silence,
    Damage(ReplyDamage),
    Exception(Exception),
}

/// A complete frame, or the bytes that do not form one and what is wrong with them.
type FrameResult = Result<Vec<u8>, (ReplyDamage, Vec<u8>)>;

impl<'a> Gateway<'a> {
    /// Creates the gateway for one job. Also returns what is known about the encoder behind it.
    pub(super) fn new(ctx: Ctx<'a>, station: &'a mut Station) -> (Self, &'a mut KnownState) {
        let Station { link, recorded, line, next, waiting, silent, known } = station;
        let (link, recorded) = (*link, *recorded);
        line.begin_job();
        *silent = false;
        let state = State { line, next, waiting, silent };
        let gateway = Gateway { line: SerialLine::new(ctx), link, recorded, state, written: None };
        (gateway, known)
    }

    /// Sends a request and returns the registers in its reply. The request is repeated after errors that may be
    /// temporary.
    fn send_request(&mut self, requested: RequestedItem) -> Result<Vec<u16>, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            let trouble = match self.request_once(requested)? {
                Ok(registers) => {
                    *self.state.silent = false;
                    return Ok(registers);
                }
                Err(trouble) => trouble,
            };
            self.state.line.damaged += 1;
            match trouble {
                ExchangeError::Silence => self.state.line.quality.unanswered += 1,
                ExchangeError::Damage(_) => self.state.line.quality.damaged += 1,
                ExchangeError::Exception(_) => {}
            }
            match trouble {
                ExchangeError::Silence => {
                    if *self.state.silent || tries >= MAX_UNANSWERED {
                        *self.state.silent = true;
                        return Err(Error::NoReply { requested, tries });
                    }
                }
                ExchangeError::Damage(cause) => {
                    if tries >= MAX_ATTEMPTS {
                        return Err(Error::Damaged { requested, tries, cause });
                    }
                }
                ExchangeError::Exception(exception) => {
                    if !exception.is_temporary() || tries >= MAX_ATTEMPTS {
                        return Err(Error::Exception { requested, exception });
                    }
                    self.line.wait(BUSY_PAUSE)?;
                }
            }
        }
    }

    fn request_once(&mut self, requested: RequestedItem) -> Result<Result<Vec<u16>, ExchangeError>, Error> {
        self.line.start()?;
        let number = *self.state.next;
        // The number 0 is skipped, because it is used by devices that ignore the number.
        *self.state.next = number.checked_add(1).unwrap_or(1);
        let Some((request, bytes)) = self.request(requested, number) else {
            return Ok(Err(ExchangeError::Damage(ReplyDamage::Registers)));
        };
        let sent_at = self.line.now();
        self.state.line.mark_sent(sent_at);
        self.line.send(&bytes, MaskedBytes::unmasked(&bytes), sent_at)?;
        let deadline = sent_at + self.link.timeout + self.state.line.margin;
        loop {
            loop {
                match self.next_frame() {
                    Some(Ok(frame)) => {
                        let now = self.line.now();
                        self.line.show(now, MaskedBytes::unmasked(&frame));
                        if self.recorded || frame.get(..2) == Some(&number.to_be_bytes()[..]) {
                            let judged = parse_reply(&request, requested, frame);
                            if !matches!(judged, Err(ExchangeError::Damage(_))) {
                                self.state.line.mark_replied();
                                self.state.line.record_answer_start(now);
                            }
                            return Ok(judged);
                        }
                    }
                    Some(Err((damage, bytes))) => {
                        let now = self.line.now();
                        self.line.show(now, MaskedBytes::unmasked(&bytes));
                        self.line.wait_for_silence(self.state.line, RESYNC_SILENCE)?;
                        return Ok(Err(ExchangeError::Damage(damage)));
                    }
                    None => break,
                }
            }
            let now = self.line.now();
            if now >= deadline {
                return Ok(Err(ExchangeError::Silence));
            }
            self.line.check_cancel()?;
            self.line.receive((now + CANCEL_CHECK_INTERVAL).min(deadline), self.state.waiting)?;
        }
    }

    fn request(&self, requested: RequestedItem, number: u16) -> Option<(ModbusRequest, Vec<u8>)> {
        request(requested, self.link.unit, number, self.link.order)
    }

    /// Removes the next complete frame from the received bytes. If they do not form a frame, discards all of them and
    /// returns them with the error.
    fn next_frame(&mut self) -> Option<FrameResult> {
        let waiting = &mut *self.state.waiting;
        if waiting.len() < HEADER {
            return None;
        }
        let length = guess_response_frame_len(waiting, ModbusProto::TcpUdp).map(usize::from);
        match length {
            Ok(length) if length >= MIN_FRAME_LEN => {
                (waiting.len() >= length).then(|| Ok(waiting.drain(..length).collect()))
            }
            _ => {
                let bytes = std::mem::take(waiting);
                Some(Err((ReplyDamage::NoFrame { bytes: bytes.len() }, bytes)))
            }
        }
    }

    fn read(&mut self, requested: RequestedItem) -> Result<u32, Error> {
        match *self.send_request(requested)?.as_slice() {
            [first, second] => Ok(self.link.order.combine([first, second])),
            _ => Err(Error::Damaged { requested, tries: 1, cause: ReplyDamage::Registers }),
        }
    }
}

fn request(requested: RequestedItem, unit: u8, number: u16, order: WordOrder) -> Option<(ModbusRequest, Vec<u8>)> {
    let mut request = ModbusRequest::new_tcp_udp(unit, number);
    let mut bytes = Vec::new();
    let made = match requested {
        RequestedItem::Input { register } => request.generate_get_inputs(register, 2, &mut bytes),
        RequestedItem::Output { register } => request.generate_get_holdings(register, 2, &mut bytes),
        RequestedItem::Write { register, word } => {
            request.generate_set_holdings_bulk(register, &order.registers(word), &mut bytes)
        }
    };
    made.ok().map(|()| (request, bytes))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GatewayFault {
    /// The frame is not a valid reply to the request.
    Broken(ReplyDamage),
    Refused(Exception),
}

/// Returns what is wrong with a received frame in the trace, given the request before it. Returns `None` if the frame
/// answers this request or, by its number, an earlier one.
pub fn find_fault(sent: &[u8], received: &[u8], order: WordOrder) -> Option<GatewayFault> {
    let broken = |damage| Some(GatewayFault::Broken(damage));
    let length = guess_response_frame_len(received, ModbusProto::TcpUdp).map(usize::from);
    if received.len() < MIN_FRAME_LEN || length != Ok(received.len()) {
        return broken(ReplyDamage::NoFrame { bytes: received.len() });
    }
    let (number, unit, requested) = request_in_frame(sent, order)?;
    let (request, _) = request(requested, unit, number, order)?;
    match parse_reply(&request, requested, received.to_vec()) {
        Err(ExchangeError::Damage(damage)) => broken(damage),
        Err(ExchangeError::Exception(exception)) => Some(GatewayFault::Refused(exception)),
        Ok(_) | Err(ExchangeError::Silence) => None,
    }
}

/// Returns the transaction number, the unit and the content of a request in the trace.
fn request_in_frame(sent: &[u8], order: WordOrder) -> Option<(u16, u8, RequestedItem)> {
    let [number_high, number_low, _, _, _, _, unit, function, high, low, ..] = *sent else { return None };
    let register = u16::from_be_bytes([high, low]);
    let requested = match (function, word_in_frame(true, sent, order)) {
        (4, _) => RequestedItem::Input { register },
        (3, _) => RequestedItem::Output { register },
        (_, Some(FrameWord::Out(word))) => RequestedItem::Write { register, word },
        _ => return None,
    };
    Some((u16::from_be_bytes([number_high, number_low]), unit, requested))
}

/// Parses the reply to a request. The transaction number of the reply is ignored.
fn parse_reply(
    request: &ModbusRequest,
    requested: RequestedItem,
    mut frame: Vec<u8>,
) -> Result<Vec<u16>, ExchangeError> {
    let [_, _, ..] = frame.as_slice() else { return Err(ExchangeError::Damage(ReplyDamage::Registers)) };
    // The number in a recorded reply belongs to the recorded request.
    frame.splice(..2, request.tr_id.to_be_bytes());
    let (unit, function) = (frame.get(HEADER - 1).copied(), frame.get(HEADER).copied());
    let (Some(unit), Some(function)) = (unit, function) else {
        return Err(ExchangeError::Damage(ReplyDamage::Registers));
    };
    if unit != request.unit_id {
        return Err(ExchangeError::Damage(ReplyDamage::Unit { requested: request.unit_id, got: unit }));
    }
    // Rejections are parsed here, because the crate changes the codes 0Ah and 0Bh and takes every other function for a
    // rejection.
    if function == requested.function_code() | EXCEPTION_BIT {
        return Err(ExchangeError::Exception(Exception::new(frame.get(HEADER + 1).copied().unwrap_or(0))));
    }
    if function != requested.function_code() {
        return Err(ExchangeError::Damage(ReplyDamage::Function {
            requested: requested.function_code(),
            got: function,
        }));
    }
    let body = frame.get(HEADER + 1..).unwrap_or_default();
    let mut registers: Vec<u16> = Vec::new();
    let fits = match requested {
        RequestedItem::Input { .. } | RequestedItem::Output { .. } => {
            matches!(body, [4, _, _, _, _]) && request.parse_u16(&frame, &mut registers).is_ok()
        }
        RequestedItem::Write { register, .. } => {
            let [high, low] = register.to_be_bytes();
            body == [high, low, 0, 2] && request.parse_ok(&frame).is_ok()
        }
    };
    if fits { Ok(registers) } else { Err(ExchangeError::Damage(ReplyDamage::Registers)) }
}

impl ProcessData for Gateway<'_> {
    fn run_cycle(&mut self, out: u32) -> Result<u32, Error> {
        if self.written != Some(out) {
            // The word may have been written even if its reply is lost.
            self.written = None;
            self.send_request(RequestedItem::Write { register: self.link.output, word: out })?;
            self.written = Some(out);
        }
        self.line.wait(self.link.cycle)?;
        self.input()
    }

    fn input(&mut self) -> Result<u32, Error> {
        self.read(RequestedItem::Input { register: self.link.input })
    }

    fn output(&mut self) -> Result<Option<u32>, Error> {
        match self.read(RequestedItem::Output { register: self.link.output }) {
            Ok(word) => Ok(Some(word)),
            Err(Error::Exception { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn now(&self) -> Moment {
        self.line.now()
    }

    fn wait(&mut self, duration: Duration) -> Result<(), Error> {
        Ok(self.line.wait(duration)?)
    }

    fn ignore_cancellation(&mut self, ignore: bool) -> bool {
        self.line.ignore_cancellation(ignore)
    }
}

/// The process data word of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameWord {
    Out(u32),
    In(u32),
}

/// Returns the process data word in a frame of the trace, or `None` if there is none.
pub fn word_in_frame(sent: bool, frame: &[u8], order: WordOrder) -> Option<FrameWord> {
    match (sent, frame.get(HEADER..)?) {
        (true, [16, _, _, 0, 2, 4, a, b, c, d]) => Some(FrameWord::Out(word_from_bytes(order, [*a, *b, *c, *d]))),
        (false, [4, 4, a, b, c, d]) => Some(FrameWord::In(word_from_bytes(order, [*a, *b, *c, *d]))),
        _ => None,
    }
}

fn word_from_bytes(order: WordOrder, [a, b, c, d]: [u8; 4]) -> u32 {
    order.combine([u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])])
}
