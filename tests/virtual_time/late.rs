//! A connection that is slower than expected. A reply must never be taken for the reply to the next request.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::hiperface::jobs::{HiperfaceJob, HiperfaceOutput};
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::protocol::EncoderTypes;
use encoder_studio::link::{ByteLink, Clock, Direction, LinkError, SimLink, VirtualClock};
use encoder_studio::store::Store;
use encoder_studio::units::{CharacterFormat, Moment};
use encoder_studio::worker::Session;

use crate::support::bus;

/// A link that delays all replies of the encoder.
struct Slow {
    line: SimLink,
    clock: Arc<VirtualClock>,
    delay: Duration,
    on_the_way: VecDeque<(Moment, Vec<u8>)>,
}

impl ByteLink for Slow {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.line.send(bytes)
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        loop {
            let now = self.clock.now();
            if self.on_the_way.front().is_some_and(|(due, _)| *due <= now) {
                into.extend(self.on_the_way.pop_front().unwrap().1);
                return Ok(());
            }
            if now >= until {
                return Ok(());
            }
            let next = self.on_the_way.front().map_or(until, |(due, _)| until.min(*due));
            let mut bytes = Vec::new();
            self.line.receive(next, &mut bytes)?;
            if !bytes.is_empty() {
                self.on_the_way.push_back((self.clock.now() + self.delay, bytes));
            }
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.line.set_format(format)
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.line.check_connection()
    }
}

#[test]
fn late_reply_is_not_next_reply() {
    for delay in [0, 60, 110, 150, 300, 700] {
        // At one turn per second, the position of the previous request lies outside the range through which the shaft
        // has turned since.
        let bus = Arc::new(Mutex::new(bus("rpm=60")));
        let clock = Arc::new(VirtualClock::default());
        let line = SimLink::connect(bus.clone(), clock.clone());
        let delay = Duration::from_millis(delay);
        let slow = Slow { line, clock: clock.clone(), delay, on_the_way: VecDeque::new() };
        let folder = tempfile::tempdir().unwrap();
        let station = Station::new(Duration::from_millis(100));
        let (store, types) = (Store::at_root(folder.path()), EncoderTypes::built_in());
        let mut session = Session::new(Box::new(slow), clock.clone(), station, store, types, true);
        let sent = Arc::new(Mutex::new(Moment::START));
        let last = sent.clone();
        session.add_watcher(move |entry| {
            if entry.direction == Direction::Sent {
                *last.lock().unwrap() = entry.at;
            }
        });
        let mut read = 0;
        for _ in 0..12 {
            if let Ok(HiperfaceOutput::Position(reading)) = session.run_inline(HiperfaceJob::Position(None)) {
                read += 1;
                let place = |at| bus.lock().unwrap().encoders()[0].position(at);
                let (from, to) = (place(*sent.lock().unwrap()), place(clock.now()));
                assert!((from..=to).contains(&reading.raw), "{delay:?}: {} not in {from}..={to}", reading.raw);
            }
        }
        assert!(read >= 10, "{delay:?}: only {read} of 12 positions");
    }
}
