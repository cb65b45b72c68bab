//! The line between the host's UART and the encoders. It transmits characters in time order, each with its start and
//! end time, and simulates the converter's echo, noise, collisions and mismatched settings. Bytes are not interpreted.
//! For half duplex and pull-ups, see the manual, "Parameterkanal".

use std::time::Duration;

use fastrand::Rng;

use super::config::Config;
use super::encoder::{Encoder, ReceivedCharacter};
use crate::devices::hiperface::protocol::LineSettings;
use crate::sim::SimulatedFaults;
use crate::sim::line::{LineConditions, SerialCharacter, TransitQueue, VirtualLine};
use crate::units::{CharacterFormat, Moment, Parity};

/// A line with one or more encoders, as seen by the host. It is created from a [`Config`].
#[derive(Clone)]
pub struct Bus {
    encoders: Vec<Encoder>,
    echo: bool,
    wires: LineConditions,
    /// Characters in transit to the encoders, by start time.
    to_encoders: TransitQueue<CharacterInTransit>,
    /// Characters in transit to the host, by end time.
    to_host: TransitQueue<CharacterInTransit>,
    drive_periods: Vec<LineDrivePeriod>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LineDriver {
    Host,
    Encoder(usize),
}

#[derive(Clone, Copy)]
struct CharacterInTransit {
    talker: LineDriver,
    character: SerialCharacter,
    format: CharacterFormat,
}

/// A period during which a device drives the line.
#[derive(Clone, Copy, Debug)]
struct LineDrivePeriod {
    talker: LineDriver,
    start: Moment,
    end: Moment,
}

/// The next event on the line. If several events are simultaneous, the variant listed first takes precedence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Event {
    EncoderActs(usize),
    EncodersHear,
    HostReceives,
}

impl Bus {
    /// Upper limit for the duration of a character. A transmission that ended longer ago than this cannot overlap a
    /// character in transit.
    const LONGEST_CHARACTER: Duration = Duration::from_millis(20);

    /// Creates the line described by `config`. Its encoders have been on for a long time.
    pub fn new(config: &Config) -> Self {
        Bus {
            encoders: (0..config.encoders).map(|index| Encoder::new(config, index)).collect(),
            echo: config.echo,
            wires: LineConditions::new(&config.faults, config.seed, CharacterFormat::FACTORY),
            to_encoders: TransitQueue::default(),
            to_host: TransitQueue::default(),
            drive_periods: Vec::new(),
        }
    }

    pub fn encoders(&self) -> &[Encoder] {
        &self.encoders
    }

    pub fn encoder(&self, index: usize) -> Option<&Encoder> {
        self.encoders.get(index)
    }

    /// Returns a mutable reference to an encoder, for example to change its speed or temperature.
    pub fn encoder_mut(&mut self, index: usize) -> Option<&mut Encoder> {
        self.encoders.get_mut(index)
    }

    pub fn set_faults(&mut self, faults: &SimulatedFaults) {
        self.wires.faults = faults.clone();
        for encoder in &mut self.encoders {
            encoder.set_faults(faults.clone());
        }
    }

    pub fn power_cycle(&mut self, now: Moment) {
        self.advance_to(now);
        for encoder in &mut self.encoders {
            encoder.power_cycle(self.wires.now);
        }
        // An encoder without power stops sending.
        let now = self.wires.now;
        let is_sent = |own: &CharacterInTransit| own.talker == LineDriver::Host || own.character.start < now;
        self.to_encoders.retain(is_sent);
        self.to_host.retain(is_sent);
    }

    fn execute_encoder_action(&mut self, index: usize, at: Moment) {
        let Some(transmission) = self.encoders.get_mut(index).and_then(|encoder| encoder.run_due_action(at)) else {
            return;
        };
        if let Some(format) = transmission.settings.character_format() {
            self.drive(LineDriver::Encoder(index), transmission.start, format, &transmission.bytes);
        }
    }

    fn deliver_to_encoders(&mut self) {
        let Some((_, travelling)) = self.to_encoders.pop() else { return };
        let collides = self.has_collision(&travelling);
        let SerialCharacter { start, end, byte, flipped } = travelling.character;
        for (index, encoder) in self.encoders.iter_mut().enumerate() {
            // While an encoder sends, it receives only its own bytes.
            if travelling.talker == LineDriver::Encoder(index) {
                continue;
            }
            let Some(format) = encoder.active_settings_at(start).and_then(LineSettings::character_format) else {
                continue;
            };
            let clean = !collides && format == travelling.format;
            let byte = if clean { byte } else { garbage_byte(&mut self.wires.rng) };
            // Without a parity bit, a flipped bit is not detected.
            let intact = clean && (!flipped || format.parity == Parity::None);
            encoder.handle_input(ReceivedCharacter { start, end, byte, intact });
        }
    }

    fn deliver_to_host(&mut self) {
        let Some((_, travelling)) = self.to_host.pop() else { return };
        // With the usual driver setting, bytes with a wrong parity bit are passed on unchanged.
        let clean = !self.has_collision(&travelling) && travelling.format == self.wires.host;
        let byte = if clean { travelling.character.byte } else { garbage_byte(&mut self.wires.rng) };
        self.wires.inbox.push(byte);
    }

    /// Transmits bytes one character after another, and returns the end time of the last character.
    fn drive(&mut self, talker: LineDriver, start: Moment, format: CharacterFormat, bytes: &[u8]) -> Moment {
        let sent = self.wires.send(start, format.character_time(), bytes);
        let on_the_way = |character: SerialCharacter| CharacterInTransit { talker, character, format };
        for heard in sent.heard.into_iter().map(on_the_way) {
            if talker != LineDriver::Host {
                self.to_host.insert(heard.character.end, heard);
            }
            if talker == LineDriver::Host || self.encoders.len() > 1 {
                self.to_encoders.insert(heard.character.start, heard);
            }
        }
        if self.echo && talker == LineDriver::Host {
            let echo = sent.own.into_iter().map(on_the_way);
            echo.for_each(|own| self.to_host.insert(own.character.end, own));
        }
        let now = self.wires.now;
        self.drive_periods.retain(|talk| talk.end + Self::LONGEST_CHARACTER > now);
        self.drive_periods.push(LineDrivePeriod { talker, start, end: sent.end });
        sent.end
    }

    /// Returns whether another device drives the line during this character.
    fn has_collision(&self, CharacterInTransit { talker, character, .. }: &CharacterInTransit) -> bool {
        let other = |talk: &&LineDrivePeriod| talk.talker != *talker;
        self.drive_periods.iter().filter(other).any(|talk| talk.start < character.end && character.start < talk.end)
    }
}

/// Returns the byte that a receiver outputs for an unreadable character. It is never an address byte, so it cannot
/// start a frame.
fn garbage_byte(rng: &mut Rng) -> u8 {
    rng.u8(0x80..0xFF)
}

impl VirtualLine for Bus {
    type Event = Event;

    fn line_conditions(&self) -> &LineConditions {
        &self.wires
    }

    fn wires_mut(&mut self) -> &mut LineConditions {
        &mut self.wires
    }

    fn next_event(&self) -> Option<(Moment, Event)> {
        let acting =
            |(index, encoder): (usize, &Encoder)| Some((encoder.next_action_time()?, Event::EncoderActs(index)));
        let hearing = self.to_encoders.next_due().map(|at| (at, Event::EncodersHear));
        let receiving = self.to_host.next_due().map(|at| (at, Event::HostReceives));
        self.encoders.iter().enumerate().filter_map(acting).chain(hearing).chain(receiving).min()
    }

    fn schedule_event(&mut self, at: Moment, event: Event) {
        match event {
            Event::EncoderActs(index) => self.execute_encoder_action(index, at),
            Event::EncodersHear => self.deliver_to_encoders(),
            Event::HostReceives => self.deliver_to_host(),
        }
    }

    fn transmit_from_host(&mut self, start: Moment, bytes: &[u8]) -> Moment {
        self.drive(LineDriver::Host, start, self.wires.host, bytes)
    }

    fn supply_power(&mut self, now: Moment) {
        for encoder in &mut self.encoders {
            encoder.connect(now);
        }
    }
}
