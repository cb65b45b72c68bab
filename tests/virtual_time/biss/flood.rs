//! A job uses limited memory and time even if noise arrives at a high rate.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::biss::jobs::{Biss, BissJob};
use encoder_studio::devices::biss::procedures::Station;
use encoder_studio::link::{ByteLink, Clock, LinkError, VirtualClock};
use encoder_studio::store::Store;
use encoder_studio::units::{CharacterFormat, Moment};
use encoder_studio::worker::{Event, JobId, Session};

use super::support::Transport;
use crate::support::{MARGIN, folder};

/// A link that receives 512,000 bytes per second for some time after each request.
struct Flood {
    clock: Arc<VirtualClock>,
    lasts: Duration,
    until: Moment,
    portion: [u8; 512],
}

impl ByteLink for Flood {
    fn send(&mut self, _: &[u8]) -> Result<(), LinkError> {
        self.until = self.clock.now() + self.lasts;
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        if self.clock.now() >= self.until {
            self.clock.sleep_until(until);
            return Ok(());
        }
        self.clock.sleep_until(self.clock.now() + Duration::from_millis(1));
        into.extend(self.portion);
        Ok(())
    }

    fn set_format(&mut self, _: CharacterFormat) -> Result<(), LinkError> {
        Ok(())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

/// The trace keeps a limited number of noise bytes, and the job ends even if the noise does not (issue 22.11).
#[test]
fn noise_flood_takes_bounded_memory_and_time() {
    for (way, noise) in [
        (Transport::ConfigPin, 0x55),
        (Transport::ConfigPin, 0x80),
        (Transport::Adapter, 0x55),
        (Transport::Adapter, 0),
    ] {
        for lasts in [300, 900, 3_600_000] {
            let (clock, folder) = (Arc::<VirtualClock>::default(), folder());
            // The noise consists of invalid packets that are properly terminated.
            let mut portion = [noise; 512];
            portion[511] = 0;
            let lasts = Duration::from_millis(lasts);
            let link = Flood { clock: clock.clone(), lasts, until: Moment::START, portion };
            let mut session: Session<Biss> = Session::from_connection(
                Box::new(link),
                clock.clone(),
                Station::new(way, MARGIN),
                Store::at_root(folder.path()),
                None,
            );
            let longest = Arc::<Mutex<usize>>::default();
            let seen = longest.clone();
            session.add_watcher(move |entry| {
                let mut longest = seen.lock().unwrap();
                *longest = entry.bytes.len().max(*longest);
            });
            let end = session.run(JobId::default(), BissJob::Status, &mut |_| {});
            assert!(matches!(end, Event::Failed(..)), "{way:?} {noise:02X} {lasts:?}: {end:?}");
            let longest = *longest.lock().unwrap();
            assert!(longest <= 4_096, "{way:?} {noise:02X} {lasts:?}: {longest} bytes in one line of the trace");
            assert!(
                clock.now() < Moment::START + Duration::from_secs(25),
                "{way:?} {noise:02X} {lasts:?}: {:?}",
                clock.now()
            );
        }
    }
}
