//! A link between a session and a virtual line, with faults at chosen requests.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::link::{ByteLink, Clock, LinkError, LinkErrorKind, SimLink};
use encoder_studio::sim::ByteDevice;
use encoder_studio::units::{CharacterFormat, Moment};

/// A fault that affects one request.
#[derive(Clone, Debug)]
pub(crate) enum Fault {
    /// The request does not arrive.
    LoseRequest,
    /// The reply does not arrive.
    LoseReply,
    /// The request arrives twice.
    RepeatRequest,
    /// The reply arrives twice.
    RepeatReply,
    /// One bit of the request is inverted.
    FlipRequest { byte: usize, bit: u8 },
    /// One bit of the reply is inverted.
    FlipReply { byte: usize, bit: u8 },
    /// The reply is cut off after this number of bytes.
    CutReply(usize),
    /// These bytes arrive before the reply.
    Garbage(Vec<u8>),
    /// The previous reply arrives again before the reply to this request.
    StaleReply,
    /// The request is echoed before the reply.
    Echo,
    /// The reply is delayed by this time.
    LateReply(Duration),
    /// From this request on, nothing arrives in either direction.
    Silence,
    /// From this request on, the link is lost.
    Lost,
    /// The device briefly loses power before the request arrives.
    PowerLoss,
}

/// The faults of a link by request number, starting at 0, and the number of requests so far.
#[derive(Default)]
pub(crate) struct Schedule {
    pub(crate) faults: BTreeMap<usize, Fault>,
    /// Number of requests sent over the link.
    pub(crate) sent: usize,
    /// Callback before each request is sent.
    on_request: Option<Box<dyn FnMut() + Send>>,
    is_silent: bool,
    is_lost: bool,
}

impl Schedule {
    pub(crate) fn with(faults: BTreeMap<usize, Fault>) -> Self {
        Schedule { faults, ..Schedule::default() }
    }

    /// Returns a schedule without faults that calls a function before each request.
    pub(crate) fn observed(on_request: impl FnMut() + Send + 'static) -> Self {
        Schedule { on_request: Some(Box::new(on_request)), ..Schedule::default() }
    }
}

pub(crate) struct FaultyLink {
    line: SimLink,
    clock: Arc<dyn Clock>,
    schedule: Arc<Mutex<Schedule>>,
    cut_power: Box<dyn FnMut(Moment) + Send>,
    /// Fault of the latest request.
    fault: Option<Fault>,
    reply: Vec<u8>,
    arriving: VecDeque<(Moment, u8)>,
}

impl FaultyLink {
    /// Connects to a device. `cut_power` interrupts its supply.
    pub(crate) fn new(
        device: Arc<Mutex<dyn ByteDevice>>,
        clock: Arc<dyn Clock>,
        schedule: Arc<Mutex<Schedule>>,
        cut_power: impl FnMut(Moment) + Send + 'static,
    ) -> Self {
        let line = SimLink::connect(device, clock.clone());
        let (cut_power, arriving) = (Box::new(cut_power), VecDeque::new());
        FaultyLink { line, clock, schedule, cut_power, fault: None, reply: Vec::new(), arriving }
    }

    fn arrive(&mut self, at: Moment, bytes: &[u8]) {
        self.arriving.extend(bytes.iter().map(|byte| (at, *byte)));
    }

    /// Passes one byte of the reply on.
    fn pass(&mut self, now: Moment, mut byte: u8) {
        let place = self.reply.len();
        self.reply.push(byte);
        let mut at = now;
        match &self.fault {
            Some(Fault::LoseReply) => return,
            Some(Fault::CutReply(length)) if place >= *length => return,
            Some(Fault::FlipReply { byte: flipped, bit }) if place == *flipped => byte ^= 1 << bit,
            Some(Fault::LateReply(delay)) => at = now + *delay,
            _ => {}
        }
        if !self.schedule.lock().unwrap().is_silent {
            self.arrive(at, &[byte]);
        }
    }
}

impl ByteLink for FaultyLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let now = self.clock.now();
        let last = std::mem::take(&mut self.reply);
        // The remaining bytes of a repeated reply arrive with the next request.
        if matches!(self.fault, Some(Fault::RepeatReply)) {
            self.arrive(now, &last);
        }
        self.fault = {
            let mut schedule = self.schedule.lock().unwrap();
            if let Some(on_request) = &mut schedule.on_request {
                on_request();
            }
            let number = schedule.sent;
            schedule.sent += 1;
            let fault = schedule.faults.remove(&number);
            schedule.is_silent |= matches!(fault, Some(Fault::Silence));
            schedule.is_lost |= matches!(fault, Some(Fault::Lost));
            fault
        };
        self.check_connection()?;
        let mut bytes = bytes.to_vec();
        match &self.fault {
            Some(Fault::LoseRequest) => return Ok(()),
            Some(Fault::RepeatRequest) => bytes.extend(bytes.clone()),
            Some(Fault::FlipRequest { byte, bit }) => {
                let place = byte % bytes.len();
                bytes[place] ^= 1 << bit;
            }
            Some(Fault::Garbage(garbage)) => {
                let garbage = garbage.clone();
                self.arrive(now, &garbage);
            }
            Some(Fault::StaleReply) => self.arrive(now, &last),
            Some(Fault::Echo) => self.arrive(now, &bytes),
            Some(Fault::PowerLoss) => (self.cut_power)(now),
            _ => {}
        }
        if self.schedule.lock().unwrap().is_silent {
            return Ok(());
        }
        self.line.send(&bytes)
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let before = into.len();
        loop {
            self.check_connection()?;
            let now = self.clock.now();
            while self.arriving.front().is_some_and(|(at, _)| *at <= now) {
                into.extend(self.arriving.pop_front().map(|(_, byte)| byte));
            }
            if into.len() > before || now >= until {
                return Ok(());
            }
            let next = self.arriving.front().map_or(until, |(at, _)| (*at).min(until));
            let mut heard = Vec::new();
            self.line.receive(next, &mut heard)?;
            let now = self.clock.now();
            for byte in heard {
                self.pass(now, byte);
            }
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.line.set_format(format)
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        match self.schedule.lock().unwrap().is_lost {
            true => Err(LinkError::new("test", LinkErrorKind::Lost)),
            false => Ok(()),
        }
    }
}
