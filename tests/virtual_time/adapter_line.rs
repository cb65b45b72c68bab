//! A HIPERFACE encoder on the serial line of the virtual adapter.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::buses::bridge::procedures::{AdapterSerialLink, DeviceLine, SupplyAfterSession};
use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::hiperface::jobs::{Hiperface, HiperfaceJob, HiperfaceOutput};
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::protocol::EncoderTypes;
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::link::{Clock, SimLink, VirtualClock};
use encoder_studio::store::Store;
use encoder_studio::worker::Session;

use crate::support::{MARGIN, folder};

fn session(settings: &[(&str, &str)]) -> (Session<Hiperface>, Arc<VirtualClock>, tempfile::TempDir) {
    let (clock, folder, station) = (Arc::new(VirtualClock::default()), folder(), Station::new(MARGIN));
    let pairs: Vec<_> = settings.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let adapter = Adapter::from_pairs(&pairs, attachable_kinds()).unwrap();
    let wire = SimLink::connect(Arc::new(Mutex::new(adapter)), clock.clone());
    let line = DeviceLine { format: station.format, margin: MARGIN, max_reply: 134 };
    let supply = (None, SupplyAfterSession::AsFound);
    let link = AdapterSerialLink::new(Box::new(wire), clock.clone(), "test", line, supply);
    let store = Store::at_root(folder.path());
    let session = Session::new(Box::new(link), clock.clone(), station, store, EncoderTypes::built_in(), true);
    (session, clock, folder)
}

/// At one revolution per second, the shaft turns 4096 steps per second. The adapter timestamps the first start bit of a
/// reply, so the delay over USB does not affect the time of a position.
#[test]
fn position_uses_adapter_time() {
    let (mut session, clock, _folder) = session(&[("uart", "hiperface"), ("rpm", "60")]);
    let mut position = || {
        let HiperfaceOutput::Position(reading) = session.run_inline(HiperfaceJob::Position(None)).unwrap() else {
            panic!("not a position")
        };
        (reading.at.since_start().as_secs_f64(), f64::from(reading.raw))
    };
    let (began, first) = position();
    for pause in [3, 17, 101, 250] {
        clock.sleep_until(clock.now() + Duration::from_millis(pause));
        let (at, raw) = position();
        assert!((raw - first - 4096.0 * (at - began)).abs() <= 2.0, "{raw} at {at} s after {first} at {began} s");
    }
}

#[test]
fn rejects_adapter_without_serial_line() {
    let (mut session, _clock, _folder) = session(&[]);
    let error = session.run_inline(HiperfaceJob::Position(None)).unwrap_err().to_string();
    assert!(error.contains("virtual adapter has no serial line"), "{error}");
}
