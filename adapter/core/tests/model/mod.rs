//! A model of the wires with an encoder, a virtual clock and a host. Some items are used by only one of the tests.

#![allow(dead_code)]

use std::collections::VecDeque;

use adapter_core::{Adapter, Bus, Clocking, Correction, Frame, FrameWords, Identity, UartSetting};
use bridge_codec::{Capabilities, ErrorCode, Message, Packet, Receiver, Request, RestartReason};

/// Model of the wires to an encoder, whose values are functions of time.
pub(crate) struct Model {
    pub(crate) now_us: u64,
    pub(crate) clocking: Option<Clocking>,
    /// Interval and start time of the running stream, in microseconds.
    pub(crate) stream: Option<(u32, u64)>,
    /// SSI word as a function of the time in microseconds.
    pub(crate) ssi: fn(u64) -> u64,
    /// The four levels before the data of a BiSS frame.
    pub(crate) biss_head: u64,
    pub(crate) biss: fn(u64) -> u64,
    /// Control bits of the encoder and of the host.
    pub(crate) cds: VecDeque<bool>,
    pub(crate) cdm: Vec<bool>,
    /// Start time of the conversions, and whether one was missed.
    pub(crate) conversions: Option<u64>,
    pub(crate) has_overrun: bool,
    /// Converted value as a function of the input and the time in microseconds.
    pub(crate) input: fn(u32, u64) -> u16,
    /// Voltage at the input of the supply switch, state of the switch, and whether it reports a fault.
    pub(crate) input_millivolt: u16,
    pub(crate) is_supplied: bool,
    pub(crate) has_fault: bool,
    /// Characters sent, end of their transmission, and the reply with its delay.
    pub(crate) sent: Vec<u32>,
    pub(crate) sent_us: u64,
    pub(crate) reply: Vec<u32>,
    pub(crate) reply_delay_us: u64,
    /// Start times of all frames outside streams, in microseconds.
    pub(crate) frames: Vec<u64>,
}

impl Model {
    fn bits(&self) -> u8 {
        match self.clocking.unwrap() {
            Clocking::Ssi(setting) => setting.clocks,
            Clocking::Biss(setting) => setting.sampled_bits(),
        }
    }

    fn words(&self, t_us: u64, cds: bool) -> FrameWords {
        let value = match self.clocking.unwrap() {
            Clocking::Ssi(_) => u128::from((self.ssi)(t_us)),
            Clocking::Biss(setting) => {
                u128::from(self.biss_head | u64::from(cds)) << setting.bits | u128::from((self.biss)(t_us))
            }
        };
        split(value, self.bits())
    }
}

/// Splits a frame into words, starting with the first bit.
fn split(value: u128, bits: u8) -> FrameWords {
    let mut words = [0; 3];
    for at in 0..usize::from(bits) {
        let bit = (value >> (usize::from(bits) - 1 - at)) as u32 & 1;
        words[at / 32] = words[at / 32] << 1 | bit;
    }
    FrameWords(words)
}

impl Bus for Model {
    const CAPACITY: u32 = 1024;

    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn wait_until(&mut self, t_us: u64) {
        self.now_us = self.now_us.max(t_us);
    }

    fn select(&mut self, clocking: Clocking) {
        assert_eq!(self.stream, None, "the clock is changed during a stream");
        self.clocking = Some(clocking);
    }

    fn frame(&mut self, cdm: bool) -> Frame {
        assert_eq!(self.stream, None, "a frame during a stream");
        self.cdm.push(cdm);
        let cds = self.cds.pop_front().unwrap_or(false);
        let (t_us, words) = (self.now_us, self.words(self.now_us, cds));
        self.frames.push(t_us);
        self.now_us += 40;
        Frame { t_us, words }
    }

    fn start(&mut self, period_us: u32) -> u64 {
        self.stream = Some((period_us, self.now_us + 100));
        self.now_us + 100
    }

    fn stop(&mut self) {
        self.stream = None;
    }

    fn received(&self) -> u32 {
        let (period, start) = self.stream.unwrap();
        let frames = if self.now_us < start { 0 } else { (self.now_us - start) / u64::from(period) + 1 };
        (frames * u64::from(FrameWords::count(self.bits()))) as u32
    }

    const CONVERSIONS: u32 = 16_384;

    fn start_conversions(&mut self) -> u64 {
        assert_eq!(self.conversions, None, "the conversions run");
        self.has_overrun = false;
        self.conversions = Some(self.now_us);
        self.now_us
    }

    fn stop_conversions(&mut self) {
        self.conversions = None;
    }

    fn converted(&self) -> u32 {
        ((self.now_us - self.conversions.unwrap()) / 2) as u32
    }

    fn conversion(&self, number: u32) -> u16 {
        let behind = self.converted().wrapping_sub(number);
        assert!((1..=Self::CONVERSIONS).contains(&behind), "conversion {number} is not kept");
        (self.input)(number % 5, self.conversions.unwrap() + 2 * u64::from(number))
    }

    fn has_overrun(&self) -> bool {
        self.has_overrun
    }

    fn supply_millivolt(&mut self) -> u16 {
        self.input_millivolt
    }

    fn switch_supply(&mut self, on: bool) {
        self.is_supplied = on;
    }

    fn has_supply_fault(&mut self) -> bool {
        self.has_fault
    }

    fn configure_uart(&mut self, _: UartSetting) {}

    /// Each character takes one millisecond.
    fn begin_transfer(&mut self, characters: &[u32]) {
        self.sent = characters.to_vec();
        self.sent_us = self.now_us + 1_000 * characters.len() as u64;
    }

    fn has_sent(&mut self) -> bool {
        self.now_us >= self.sent_us
    }

    fn first_edge_us(&mut self) -> Option<u64> {
        let edge = self.sent_us + self.reply_delay_us;
        (!self.reply.is_empty() && self.now_us >= edge).then_some(edge)
    }

    fn received_characters(&mut self) -> usize {
        let since = self.now_us.saturating_sub(self.sent_us + self.reply_delay_us);
        self.reply.len().min((since / 1_000) as usize)
    }

    fn received_character(&mut self, at: usize) -> u32 {
        self.reply[at]
    }

    fn end_transfer(&mut self) {}

    fn word(&self, number: u32) -> u32 {
        let behind = self.received().wrapping_sub(number);
        assert!((1..=Self::CAPACITY).contains(&behind), "word {number} is not kept");
        let (period, start) = self.stream.unwrap();
        let words = u32::from(FrameWords::count(self.bits()));
        // Streams of the tests are shorter than 2³² words.
        let t_us = start + u64::from(number / words) * u64::from(period);
        self.words(t_us, false).0[(number % words) as usize]
    }
}

/// An adapter with its host.
pub(crate) struct Bench {
    pub(crate) adapter: Adapter<Model>,
    receiver: Receiver,
    seq: u8,
}

impl Bench {
    pub(crate) fn new() -> Self {
        let model = Model {
            now_us: 1_000,
            clocking: None,
            stream: None,
            ssi: |t_us| t_us & 0x1FF_FFFF,
            biss_head: 0b1010,
            biss: |_| 0x024_6980_00CF,
            cds: VecDeque::new(),
            cdm: Vec::new(),
            conversions: None,
            input_millivolt: 8_050,
            is_supplied: false,
            has_fault: false,
            sent: Vec::new(),
            sent_us: 0,
            reply: Vec::new(),
            reply_delay_us: 3_000,
            has_overrun: false,
            input: |_, _| 2048,
            frames: Vec::new(),
        };
        let identity = Identity {
            name: "Model",
            serial: "M1".to_owned(),
            firmware: "1.2",
            capabilities: Capabilities::SSI
                .union(Capabilities::BISS)
                .union(Capabilities::BISS_REGISTERS)
                .union(Capabilities::ANALOG)
                .union(Capabilities::ANALOG_SKEW)
                .union(Capabilities::UART)
                .union(Capabilities::SUPPLY)
                .union(Capabilities::STATUS),
            restart: RestartReason::WATCHDOG,
            corrections: [Correction::NONE; 2],
        };
        Bench { adapter: Adapter::new(model, identity), receiver: Receiver::default(), seq: 0 }
    }

    pub(crate) fn model(&mut self) -> &mut Model {
        self.adapter.bus_mut()
    }

    /// Advances the clock by a number of microseconds and returns the messages sent by the adapter.
    pub(crate) fn run(&mut self, us: u64) -> Vec<Message> {
        self.model().now_us += us;
        self.adapter.poll();
        self.fetch().iter().map(|packet| Message::parse(packet).unwrap()).collect()
    }

    pub(crate) fn fetch(&mut self) -> Vec<Packet> {
        let now_us = self.model().now_us;
        while !self.adapter.outbox().pending().is_empty() {
            let bytes = self.adapter.outbox().pending().to_vec();
            self.adapter.outbox().consume(bytes.len(), now_us);
            self.receiver.push(&bytes);
        }
        std::iter::from_fn(|| self.receiver.next_packet()).collect()
    }

    /// Sends a request and returns the message with its sequence number.
    pub(crate) fn ask(&mut self, request: &Request) -> Message {
        self.seq = self.seq.wrapping_add(1);
        let packet = request.emit(self.seq);
        self.adapter.receive(&packet.emit());
        let answers = self.fetch();
        let [answer] = answers.as_slice() else { panic!("{request:?}: {answers:?}") };
        assert_eq!(answer.seq, self.seq);
        Message::parse(answer).unwrap()
    }
}

/// Returns the operation and the error code of a rejection.
pub(crate) fn refusal(message: Message) -> (u8, ErrorCode) {
    match message {
        Message::Error { op, code, .. } => (op, code),
        other => panic!("{other:?}"),
    }
}
