//! The configuration pin: UBICOM on a half-duplex line, byte for byte, with its faults. Chosen here (`U`): the encoder
//! answers a millisecond after the last byte; what it does not understand it does not answer; what comes while it works
//! or talks is lost.

use std::collections::VecDeque;
use std::time::Duration;

use fastrand::Rng;

use super::config::Config;
use super::encoder::Encoder;
use crate::protocol::biss::{ByteOrder, RegisterAddress};
use crate::protocol::ubicom::{
    BYTE_TIME_OUT, CHARACTER_BITS, FORMAT, Frame, NODE, PositionWord, Receiver, Reply, Request, Written,
};
use crate::sim::{ByteDevice, Faults};
use crate::units::{CharacterFormat, Moment};

/// The line with its encoder, seen from the host. Made of a [`Config`].
#[derive(Clone)]
pub struct Port {
    encoder: Encoder,
    receiver: Receiver,
    order: ByteOrder,
    echo: bool,
    faults: Faults,
    rng: Rng,
    host: CharacterFormat,
    now: Moment,
    /// The host's UART has sent everything then.
    host_done: Moment,
    /// Bytes by the moment in which they have arrived.
    to_encoder: VecDeque<(Moment, u8)>,
    to_host: VecDeque<(Moment, u8)>,
    /// When the encoder heard the last byte of a frame that is not complete.
    heard: Option<Moment>,
    work: Option<Work>,
    /// Until then the encoder drives the line.
    talks_until: Moment,
    frames: u32,
    inbox: Vec<u8>,
}

/// A request that the encoder is working on.
#[derive(Clone, Copy)]
struct Work {
    ends: Moment,
    request: Request,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    EncoderAnswers,
    EncoderHears,
    FrameEnds,
    HostReceives,
}

impl Port {
    const PROCESSING: Duration = Duration::from_millis(1);

    /// The virtual line as `config` wants it.
    pub fn new(config: &Config) -> Self {
        Port {
            encoder: Encoder::new(config),
            receiver: Receiver::new(NODE),
            order: config.order,
            echo: config.echo,
            faults: config.faults.clone(),
            rng: Rng::with_seed(config.seed),
            host: FORMAT,
            now: Moment::START,
            host_done: Moment::START,
            to_encoder: VecDeque::new(),
            to_host: VecDeque::new(),
            heard: None,
            work: None,
            talks_until: Moment::START,
            frames: 0,
            inbox: Vec::new(),
        }
    }

    /// The encoder.
    pub const fn encoder(&self) -> &Encoder {
        &self.encoder
    }

    /// The encoder, to turn its shaft or to warm it.
    pub const fn encoder_mut(&mut self) -> &mut Encoder {
        &mut self.encoder
    }

    /// Other faults of the line from now on: a cable that was mended, or one that breaks only now.
    pub fn set_faults(&mut self, faults: &Faults) {
        self.faults = faults.clone();
    }

    fn advance(&mut self, to: Moment) {
        while let Some((at, event)) = self.next_event().filter(|(at, _)| *at <= to) {
            self.now = self.now.max(at);
            match event {
                Event::EncoderAnswers => self.answer(at),
                Event::EncoderHears => self.hear(),
                Event::FrameEnds => self.end_frame(at),
                Event::HostReceives => {
                    let byte = self.to_host.pop_front().map(|(_, byte)| byte);
                    self.inbox.extend(byte);
                }
            }
        }
        self.now = self.now.max(to);
    }

    fn next_event(&self) -> Option<(Moment, Event)> {
        let answering = self.work.map(|work| (work.ends, Event::EncoderAnswers));
        let hearing = self.to_encoder.front().map(|(at, _)| (*at, Event::EncoderHears));
        let ending = self.heard.map(|at| (at + BYTE_TIME_OUT, Event::FrameEnds));
        let receiving = self.to_host.front().map(|(at, _)| (*at, Event::HostReceives));
        [answering, hearing, ending, receiving].into_iter().flatten().min()
    }

    fn hear(&mut self) {
        let Some((at, byte)) = self.to_encoder.pop_front() else { return };
        if self.work.is_some() || at <= self.talks_until || !self.encoder.answers(at) {
            (self.receiver, self.heard) = (Receiver::new(NODE), None);
            return;
        }
        self.receiver.push(&[byte]);
        while let Some(frame) = self.receiver.next_frame() {
            self.take(at, &frame);
        }
        self.heard = self.receiver.is_waiting().then_some(at);
    }

    fn end_frame(&mut self, at: Moment) {
        self.heard = None;
        while let Some(frame) = self.receiver.silence() {
            self.take(at, &frame);
        }
    }

    /// A whole frame has come. Only one request is worked on at a time.
    fn take(&mut self, at: Moment, frame: &[u8]) {
        let silent = self.faults.silent_after().is_some_and(|frames| frames <= self.frames);
        self.frames = self.frames.saturating_add(1);
        let request = Frame::parse(frame).ok().and_then(|frame| Request::parse(&frame, self.order).ok());
        if let Some(request) = request.filter(|_| !silent && self.work.is_none()) {
            self.work = Some(Work { ends: at + Self::PROCESSING + self.faults.delay(), request });
        }
    }

    fn answer(&mut self, at: Moment) {
        let Some(Work { request, .. }) = self.work.take() else { return };
        let reply = match request {
            Request::Read { register } => RegisterAddress::from_global(register)
                .and_then(|address| self.encoder.read(at, address))
                .map(Reply::Value),
            Request::Write { register, value } => {
                let accepted = RegisterAddress::from_global(register)
                    .is_some_and(|address| self.encoder.write(at, address, value));
                Some(Reply::Written(if accepted { Written::Acknowledged } else { Written::Refused }))
            }
            Request::Position { argument: 0x01 } => {
                let layout = self.encoder.layout().clone();
                self.encoder.reading(at).map(|reading| Reply::Position(PositionWord::of(&reading, &layout)))
            }
            Request::Position { .. } => None,
        };
        // A write that cost the encoder its power is not answered any more.
        if let Some(reply) = reply.filter(|_| self.encoder.has_power()) {
            self.talks_until = self.drive(at, &reply.emit(), true);
        }
    }

    /// Puts bytes on the line and gives the moment when the last one is through.
    fn drive(&mut self, start: Moment, bytes: &[u8], from_encoder: bool) -> Moment {
        let format = if from_encoder { FORMAT } else { self.host };
        let character = format.baud.time_of_bits(CHARACTER_BITS);
        let mut end = start;
        for byte in bytes {
            let passage = self.faults.passage(&mut self.rng, *byte);
            if let Some(extra) = passage.inserted {
                end = end + character;
                self.carry(end, extra, from_encoder);
            }
            end = end + character;
            if let Some(carried) = passage.carried {
                self.carry(end, carried.byte, from_encoder);
            }
            if self.echo && !from_encoder {
                // The echo comes from the converter itself: the line's noise is not in it.
                self.receive(end, *byte);
            }
        }
        end
    }

    fn carry(&mut self, at: Moment, byte: u8, from_encoder: bool) {
        // Between different settings no byte is read as it was sent.
        let byte = if self.host == FORMAT { byte } else { self.rng.u8(..0x80) };
        if from_encoder {
            self.receive(at, byte);
        } else {
            self.to_encoder.push_back((at, byte));
        }
    }

    fn receive(&mut self, at: Moment, byte: u8) {
        let place = self.to_host.partition_point(|(other, _)| *other <= at);
        self.to_host.insert(place, (at, byte));
    }
}

impl ByteDevice for Port {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.advance(now);
        if !bytes.is_empty() {
            self.host_done = self.drive(self.now.max(self.host_done), bytes, false);
        }
    }

    fn poll(&mut self, now: Moment) -> Vec<u8> {
        self.advance(now);
        std::mem::take(&mut self.inbox)
    }

    fn poll_at(&self) -> Option<Moment> {
        if self.inbox.is_empty() { self.next_event().map(|(at, _)| at) } else { Some(self.now) }
    }

    fn set_host_format(&mut self, now: Moment, format: CharacterFormat) {
        self.advance(now);
        self.host = format;
    }

    fn connect(&mut self, now: Moment) {
        self.advance(now);
        self.inbox.clear();
        self.encoder.connect(self.now);
    }
}
