//! Tests of the virtual encoder from the perspective of a host, in virtual time. All expected bytes are literals and
//! never calculated by the code under test.

mod at_adapter;
mod commands;
mod faults;
mod line;
mod power_up;

use std::time::Duration;

use super::*;
use crate::bits::{hex, parse_hex};
use crate::devices::hiperface::protocol::LineSettings;
use crate::sim::ByteDevice;
use crate::units::{CharacterFormat, Moment};

/// A host that receives until the line is idle, and then waits for the dead time.
struct Host {
    bus: Bus,
    now: Moment,
}

/// Duration of a character at 9600 8E1.
const CHARACTER: Duration = Duration::from_nanos(1_145_833);

fn ms(milliseconds: f64) -> Duration {
    Duration::from_secs_f64(milliseconds / 1000.0)
}

impl Host {
    fn new(config: &Config) -> Self {
        Host { bus: Bus::new(config), now: Moment::START }
    }

    /// Creates a host for the virtual encoder described by the query of a `sim:` link.
    fn with(query: &str) -> Self {
        let pair = |item: &str| item.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
        let pairs: Vec<_> = query.split('&').filter_map(pair).collect();
        Self::new(&Config::from_pairs(&pairs).unwrap())
    }

    fn send(&mut self, request: &str) {
        self.bus.on_bytes(self.now, &parse_hex(request).unwrap());
    }

    /// Receives until the line is idle. Returns the bytes in hexadecimal, and the time of the last byte.
    fn receive(&mut self) -> (String, Moment) {
        let (mut bytes, mut last) = (Vec::new(), self.now);
        while let Some(at) = self.bus.poll_at() {
            self.now = self.now.max(at);
            let arrived = self.bus.poll(at);
            if !arrived.is_empty() {
                last = at;
            }
            bytes.extend(arrived);
        }
        (hex(&bytes), last)
    }

    fn ask(&mut self, request: &str) -> String {
        self.send(request);
        let (reply, _) = self.receive();
        self.wait(ms(20.0));
        reply
    }

    #[track_caller]
    fn expect(&mut self, request: &str, reply: &str) {
        assert_eq!(self.ask(request), reply, "reply to {request}");
    }

    /// Returns the time from the first bit of the request to the last bit of the reply.
    fn duration(&mut self, request: &str) -> Duration {
        let start = self.now;
        self.send(request);
        let (_, last) = self.receive();
        self.wait(ms(20.0));
        last.duration_since(start)
    }

    fn wait(&mut self, duration: Duration) {
        self.now = self.now + duration;
    }

    fn set_format(&mut self, settings: u8) {
        self.bus.set_host_format(self.now, LineSettings::from_byte(settings).character_format().unwrap());
    }

    fn encoder(&self) -> &Encoder {
        self.bus.encoder(0).unwrap()
    }

    fn encoder_mut(&mut self) -> &mut Encoder {
        self.bus.encoder_mut(0).unwrap()
    }
}

/// Returns the settings of an encoder with eight blocks of memory and no fields, as in the manual's example.
fn blank() -> Config {
    let mut config = Config::default();
    config.model.user_blocks = 8;
    config.model.name_plate = &[];
    config
}
