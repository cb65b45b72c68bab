//! Tests of simulated faults: lost replies, late replies and inverted bits.

use super::*;
use crate::sim::SimulatedFaults;

#[test]
fn injects_line_faults() {
    assert_eq!(Host::with("fault=drop:1").ask(Request::Hello), None);
    assert_eq!(Host::with("fault=silent-after:0").ask(Request::Hello), None);
    let mut host = Host::with("fault=silent-after:2");
    host.ask(BISS);
    host.ask(Request::BissStream { period_us: 1000 });
    assert!(!host.stream(100).is_empty());
    assert_eq!(host.ask(Request::Hello), None);
    assert_eq!(host.stream(100), [], "what is silent does not stream");
    host.adapter.set_faults(&SimulatedFaults::default());
    assert!(host.ask(Request::Hello).is_some());
    let mut host = Host::with("fault=delay:50");
    host.send(&Request::Hello);
    assert_eq!(host.adapter.poll_at(), Some(Moment::START + Duration::from_micros(50_250)));
    let mut host = Host::with("fault=flip:0.002&seed=1");
    host.send(&BISS);
    host.send(&Request::BissStream { period_us: 100 });
    host.stream(2_000);
    assert!(host.receiver.dropped_count() > 0);
}
