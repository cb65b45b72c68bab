//! UBICOM on the configuration pin, a half-duplex line simulated byte by byte, with faults.
//!
//! The manual leaves some details open (`U`). In this model, the encoder replies one millisecond after the last byte
//! and does not reply to invalid requests. Bytes that arrive while it is busy or sending are lost.

use std::time::Duration;

use super::config::Config;
use super::encoder::Encoder;
use crate::bits::ByteOrder;
use crate::buses::ubicom::protocol::{
    BYTE_TIME_OUT, FORMAT, Frame, NODE, Receiver, Reply, Request, WriteReply, character_bits,
};
use crate::devices::biss::protocol::RegisterAddress;
use crate::sim::SimulatedFaults;
use crate::sim::line::{LineConditions, TransitQueue, VirtualLine};
use crate::units::Moment;

/// The line of a virtual encoder as seen by the host, created from a [`Config`].
#[derive(Clone)]
pub struct UbicomPort {
    encoder: Encoder,
    receiver: Receiver,
    order: ByteOrder,
    echo: bool,
    wires: LineConditions,
    /// Bytes that have not reached the encoder yet, with their arrival times.
    to_encoder: TransitQueue<u8>,
    to_host: TransitQueue<u8>,
    /// Time at which the last byte of an incomplete frame arrived at the encoder.
    heard: Option<Moment>,
    work: Option<PendingRequest>,
    /// Time at which the encoder stops driving the line.
    transmits_until: Moment,
    frames: u32,
}

#[derive(Clone, Copy)]
struct PendingRequest {
    ends: Moment,
    request: Request,
}

/// An event on the line. Simultaneous events are handled in the order of these variants.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Event {
    EncoderAnswers,
    EncoderHears,
    FrameEnds,
    HostReceives,
}

impl UbicomPort {
    const PROCESSING: Duration = Duration::from_millis(1);

    pub fn new(config: &Config) -> Self {
        UbicomPort {
            encoder: Encoder::new(config),
            receiver: Receiver::new(NODE),
            order: config.order,
            echo: config.echo,
            wires: LineConditions::new(&config.faults, config.seed, FORMAT),
            to_encoder: TransitQueue::default(),
            to_host: TransitQueue::default(),
            heard: None,
            work: None,
            transmits_until: Moment::START,
            frames: 0,
        }
    }

    pub const fn encoder(&self) -> &Encoder {
        &self.encoder
    }

    pub const fn encoder_mut(&mut self) -> &mut Encoder {
        &mut self.encoder
    }

    /// Replaces the simulated faults of the line and the encoder, but keeps the counts of frames and stores.
    pub fn set_faults(&mut self, faults: &SimulatedFaults) {
        self.wires.faults = faults.clone();
        self.encoder.set_faults(faults);
    }

    fn handle_input(&mut self) {
        let Some((at, byte)) = self.to_encoder.pop() else { return };
        if self.work.is_some() || at <= self.transmits_until || !self.encoder.can_access_registers(at) {
            (self.receiver, self.heard) = (Receiver::new(NODE), None);
            return;
        }
        self.receiver.push(&[byte]);
        while let Some(frame) = self.receiver.next_frame() {
            self.handle_frame(at, &frame);
        }
        self.heard = self.receiver.is_waiting().then_some(at);
    }

    fn handle_line_silence(&mut self, at: Moment) {
        self.heard = None;
        while let Some(frame) = self.receiver.handle_silence() {
            self.handle_frame(at, &frame);
        }
    }

    /// Handles a complete frame. It is ignored while another request is being processed.
    fn handle_frame(&mut self, at: Moment, frame: &[u8]) {
        let silent = self.wires.faults.silent_after().is_some_and(|frames| frames <= self.frames);
        self.frames = self.frames.saturating_add(1);
        let request = Frame::parse(frame).ok().and_then(|frame| Request::parse(&frame, self.order).ok());
        if let Some(request) = request.filter(|_| !silent && self.work.is_none()) {
            self.work = Some(PendingRequest { ends: at + Self::PROCESSING + self.wires.faults.reply_delay(), request });
        }
    }

    fn send_reply(&mut self, at: Moment) {
        let Some(PendingRequest { request, .. }) = self.work.take() else { return };
        let reply = match request {
            Request::Read { register } => RegisterAddress::from_global(register)
                .and_then(|address| self.encoder.read(at, address))
                .map(Reply::Value),
            Request::Write { register, value } => {
                let accepted = RegisterAddress::from_global(register)
                    .is_some_and(|address| self.encoder.write(at, address, value));
                Some(Reply::Written(if accepted { WriteReply::Acknowledged } else { WriteReply::Refused }))
            }
            Request::Position { argument: 0x01 } => {
                let layout = self.encoder.layout().clone();
                self.encoder.position_at(at).map(|reading| Reply::Position(layout.position_word(&reading)))
            }
            Request::Position { .. } => None,
        };
        // The encoder does not reply to a write during which it loses power.
        if let Some(reply) = reply.filter(|_| self.encoder.has_power()) {
            self.transmits_until = self.drive(at, &reply.emit(), true);
        }
    }

    /// Puts bytes on the line, and returns the time at which the last one is complete.
    fn drive(&mut self, start: Moment, bytes: &[u8], from_encoder: bool) -> Moment {
        let format = if from_encoder { FORMAT } else { self.wires.host };
        let sent = self.wires.send(start, format.baud.duration_of_bits(character_bits(format)), bytes);
        for heard in sent.heard {
            // If the serial settings differ, all bytes are received incorrectly.
            let byte = if self.wires.host == FORMAT { heard.byte } else { self.wires.rng.u8(..0x80) };
            let to = if from_encoder { &mut self.to_host } else { &mut self.to_encoder };
            to.insert(heard.end, byte);
        }
        if self.echo && !from_encoder {
            sent.own.iter().for_each(|own| self.to_host.insert(own.end, own.byte));
        }
        sent.end
    }
}

impl VirtualLine for UbicomPort {
    type Event = Event;

    fn line_conditions(&self) -> &LineConditions {
        &self.wires
    }

    fn wires_mut(&mut self) -> &mut LineConditions {
        &mut self.wires
    }

    fn next_event(&self) -> Option<(Moment, Event)> {
        let answering = self.work.map(|work| (work.ends, Event::EncoderAnswers));
        let hearing = self.to_encoder.next_due().map(|at| (at, Event::EncoderHears));
        let ending = self.heard.map(|at| (at + BYTE_TIME_OUT, Event::FrameEnds));
        let receiving = self.to_host.next_due().map(|at| (at, Event::HostReceives));
        [answering, hearing, ending, receiving].into_iter().flatten().min()
    }

    fn schedule_event(&mut self, at: Moment, event: Event) {
        match event {
            Event::EncoderAnswers => self.send_reply(at),
            Event::EncoderHears => self.handle_input(),
            Event::FrameEnds => self.handle_line_silence(at),
            Event::HostReceives => {
                let byte = self.to_host.pop().map(|(_, byte)| byte);
                self.wires.inbox.extend(byte);
            }
        }
    }

    fn transmit_from_host(&mut self, start: Moment, bytes: &[u8]) -> Moment {
        self.drive(start, bytes, false)
    }

    fn supply_power(&mut self, now: Moment) {
        self.encoder.connect(now);
    }
}
