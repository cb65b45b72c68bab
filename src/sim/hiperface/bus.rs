//! The line between the host's UART and the encoders: every character with its start and end, in time order. It adds
//! the converter's echo, noise, and what happens when two talk at a time or with different settings. It has no meaning
//! of its own for a single byte; half duplex and pull-ups: manual, "Parameterkanal".

use std::collections::VecDeque;
use std::time::Duration;

use fastrand::Rng;

use super::config::Config;
use super::encoder::{Encoder, Heard};
use crate::protocol::hiperface::LineSettings;
use crate::sim::{ByteDevice, Faults};
use crate::units::CharacterFormat;
use crate::units::{Moment, Parity};

/// A line with one or several encoders, seen from the host. Made of a [`Config`].
#[derive(Clone)]
pub struct Bus {
    encoders: Vec<Encoder>,
    faults: Faults,
    rng: Rng,
    echo: bool,
    host: CharacterFormat,
    /// The host's UART has sent everything then.
    host_done: Moment,
    now: Moment,
    /// Characters that encoders are going to hear, by their start.
    to_encoders: VecDeque<Travelling>,
    /// Characters that the host is going to receive, by their end.
    to_host: VecDeque<Travelling>,
    talks: Vec<Talk>,
    inbox: Vec<u8>,
}

/// Who drives the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Talker {
    Host,
    Encoder(usize),
}

#[derive(Clone, Copy)]
struct Travelling {
    talker: Talker,
    start: Moment,
    end: Moment,
    byte: u8,
    /// The parity bit that was sent belongs to this byte.
    parity_fits: bool,
    format: CharacterFormat,
}

/// Somebody drives the line from `start` to `end`.
#[derive(Clone, Copy, Debug)]
struct Talk {
    talker: Talker,
    start: Moment,
    end: Moment,
}

/// What happens next; of events at the same moment the first of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    EncoderActs(usize),
    EncodersHear,
    HostReceives,
}

impl Bus {
    /// More than the slowest character takes: a talk that ended before touches no character still under way.
    const LONGEST_CHARACTER: Duration = Duration::from_millis(20);

    /// The virtual line as `config` wants it. Its encoders got their power long ago.
    pub fn new(config: &Config) -> Self {
        Bus {
            encoders: (0..config.encoders).map(|index| Encoder::new(config, index)).collect(),
            faults: config.faults.clone(),
            rng: Rng::with_seed(config.seed),
            echo: config.echo,
            host: CharacterFormat::FACTORY,
            host_done: Moment::START,
            now: Moment::START,
            to_encoders: VecDeque::new(),
            to_host: VecDeque::new(),
            talks: Vec::new(),
            inbox: Vec::new(),
        }
    }

    /// The encoders, in the order of their first addresses.
    pub fn encoders(&self) -> &[Encoder] {
        &self.encoders
    }

    /// One encoder, 0 first.
    pub fn encoder(&self, index: usize) -> Option<&Encoder> {
        self.encoders.get(index)
    }

    /// One encoder, to turn its shaft or to warm it.
    pub fn encoder_mut(&mut self, index: usize) -> Option<&mut Encoder> {
        self.encoders.get_mut(index)
    }

    /// Other faults from now on: a cable that was mended, or one that breaks only now.
    pub fn set_faults(&mut self, faults: &Faults) {
        self.faults = faults.clone();
        for encoder in &mut self.encoders {
            encoder.set_faults(faults.clone());
        }
    }

    /// Power of all encoders goes and comes back at `now`.
    pub fn power_cycle(&mut self, now: Moment) {
        self.advance(now);
        for encoder in &mut self.encoders {
            encoder.power_cycle(self.now);
        }
        // Who is without power says nothing more.
        let now = self.now;
        let is_sent = |character: &Travelling| character.talker == Talker::Host || character.start < now;
        self.to_encoders.retain(is_sent);
        self.to_host.retain(is_sent);
    }

    fn advance(&mut self, to: Moment) {
        while let Some((at, event)) = self.next_event().filter(|(at, _)| *at <= to) {
            self.now = self.now.max(at);
            match event {
                Event::EncoderActs(index) => self.let_encoder_act(index, at),
                Event::EncodersHear => self.let_encoders_hear(),
                Event::HostReceives => self.let_host_receive(),
            }
        }
        self.now = self.now.max(to);
        let now = self.now;
        self.talks.retain(|talk| talk.end + Self::LONGEST_CHARACTER > now);
    }

    fn next_event(&self) -> Option<(Moment, Event)> {
        let acting = |(index, encoder): (usize, &Encoder)| Some((encoder.acts_at()?, Event::EncoderActs(index)));
        let hearing = self.to_encoders.front().map(|character| (character.start, Event::EncodersHear));
        let receiving = self.to_host.front().map(|character| (character.end, Event::HostReceives));
        self.encoders.iter().enumerate().filter_map(acting).chain(hearing).chain(receiving).min()
    }

    fn let_encoder_act(&mut self, index: usize, at: Moment) {
        let Some(transmission) = self.encoders.get_mut(index).and_then(|encoder| encoder.act(at)) else { return };
        if let Some(format) = transmission.settings.format() {
            self.drive(Talker::Encoder(index), transmission.start, format, &transmission.bytes);
        }
    }

    fn let_encoders_hear(&mut self) {
        let Some(character) = self.to_encoders.pop_front() else { return };
        let collides = self.collides(&character);
        for (index, encoder) in self.encoders.iter_mut().enumerate() {
            // A driver that is on hears only itself.
            if character.talker == Talker::Encoder(index) {
                continue;
            }
            let Some(format) = encoder.settings_at(character.start).and_then(LineSettings::format) else { continue };
            let clean = !collides && format == character.format;
            let byte = if clean { character.byte } else { garbage(&mut self.rng) };
            // Without a parity bit nobody notices a flipped bit.
            let intact = clean && (character.parity_fits || format.parity == Parity::None);
            encoder.hear(Heard { start: character.start, end: character.end, byte, intact });
        }
    }

    fn let_host_receive(&mut self) {
        let Some(character) = self.to_host.pop_front() else { return };
        // The usual driver setting passes bytes with a wrong parity bit on as they are.
        let clean = !self.collides(&character) && character.format == self.host;
        self.inbox.push(if clean { character.byte } else { garbage(&mut self.rng) });
    }

    /// Puts bytes on the line, one character after the other, and gives the moment when the last one is through.
    fn drive(&mut self, talker: Talker, start: Moment, format: CharacterFormat, bytes: &[u8]) -> Moment {
        let mut start_of_next = start;
        for byte in bytes {
            let passage = self.faults.passage(&mut self.rng, *byte);
            if let Some(extra) = passage.inserted {
                let (start, end) = (start_of_next, start_of_next + format.character_time());
                self.carry(Travelling { talker, start, end, byte: extra, parity_fits: true, format });
                start_of_next = end;
            }
            let (start, end) = (start_of_next, start_of_next + format.character_time());
            if let Some(carried) = passage.carried {
                let parity_fits = !carried.flipped;
                self.carry(Travelling { talker, start, end, byte: carried.byte, parity_fits, format });
            }
            if self.echo && talker == Talker::Host {
                // The echo comes from the converter itself: the line's noise is not in it.
                self.carry_to_host(Travelling { talker, start, end, byte: *byte, parity_fits: true, format });
            }
            start_of_next = end;
        }
        self.talks.push(Talk { talker, start, end: start_of_next });
        start_of_next
    }

    fn carry(&mut self, character: Travelling) {
        if character.talker != Talker::Host {
            self.carry_to_host(character);
        }
        if character.talker == Talker::Host || self.encoders.len() > 1 {
            let place = self.to_encoders.partition_point(|other| other.start <= character.start);
            self.to_encoders.insert(place, character);
        }
    }

    fn carry_to_host(&mut self, character: Travelling) {
        let place = self.to_host.partition_point(|other| other.end <= character.end);
        self.to_host.insert(place, character);
    }

    /// Somebody else drives the line while this character is on it.
    fn collides(&self, character: &Travelling) -> bool {
        self.talks
            .iter()
            .any(|talk| talk.talker != character.talker && talk.start < character.end && character.start < talk.end)
    }
}

/// What a receiver makes of a character that it cannot read. Never an address byte, so that no frame begins with it.
fn garbage(rng: &mut Rng) -> u8 {
    rng.u8(0x80..0xFF)
}

impl ByteDevice for Bus {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.advance(now);
        if !bytes.is_empty() {
            self.host_done = self.drive(Talker::Host, self.now.max(self.host_done), self.host, bytes);
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
        for encoder in &mut self.encoders {
            encoder.connect(self.now);
        }
    }
}
