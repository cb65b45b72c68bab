//! Tests of an adapter's encoder supply, from the perspective of a host. The wires are simulated.

#![allow(clippy::unwrap_used, clippy::indexing_slicing, clippy::panic)]

mod model;

use bridge_codec::{AdapterStatus, Capabilities, ErrorCode, Hello, Message, Reply, Request, SupplyFaults};
use model::{Bench, refusal};

const OFF: Request = Request::Supply { on: false, millivolt: 0 };

fn on(millivolt: u16) -> Request {
    Request::Supply { on: true, millivolt }
}

fn hello(bench: &mut Bench) -> Hello {
    match bench.ask(&Request::Hello) {
        Message::Reply(Reply::Hello(hello)) => hello,
        other => panic!("{other:?}"),
    }
}

fn status(bench: &mut Bench) -> AdapterStatus {
    match bench.ask(&Request::Status) {
        Message::Reply(Reply::Status(status)) => status,
        other => panic!("{other:?}"),
    }
}

#[test]
fn supply_stays_on_between_requests() {
    let mut bench = Bench::new();
    assert!(!hello(&mut bench).capabilities.contains(Capabilities::SUPPLY_ON) && !bench.model().is_supplied);
    let supplied = Reply::Supply { on: true, millivolt: 8_050, milliampere: 0 };
    assert_eq!(bench.ask(&on(8_000)), Message::Reply(supplied));
    assert!(bench.model().is_supplied);
    // HELLO, a disconnection of the host and an hour of waiting change nothing.
    assert!(hello(&mut bench).capabilities.contains(Capabilities::SUPPLY_ON));
    bench.adapter.handle_host_disconnect();
    bench.run(3_600_000_000);
    assert!(bench.model().is_supplied);
    assert_eq!(status(&mut bench).input_millivolt, 8_050);
    assert_eq!(bench.ask(&OFF), Message::Reply(Reply::Supply { on: false, millivolt: 0, milliampere: 0 }));
    assert!(!bench.model().is_supplied && !hello(&mut bench).capabilities.contains(Capabilities::SUPPLY_ON));
}

#[test]
fn rejects_unrequested_voltage() {
    let mut bench = Bench::new();
    for (requested, connected, is_good) in [
        (8_000, 8_800, true),
        (8_000, 8_801, false),
        (8_000, 7_200, true),
        (8_000, 7_199, false),
        (5_000, 12_000, false),
        (12_000, 0, false),
        (4_499, 4_499, false),
        (15_001, 15_001, false),
    ] {
        bench.model().input_millivolt = connected;
        let answer = bench.ask(&on(requested));
        assert_eq!(bench.model().is_supplied, is_good, "{requested} at {connected}");
        if !is_good {
            assert_eq!(refusal(answer).1, ErrorCode::BAD_ARGUMENT);
        }
        bench.ask(&OFF);
    }
}

#[test]
fn overload_switches_supply_off() {
    let mut bench = Bench::new();
    bench.model().has_fault = true;
    bench.run(1_000);
    assert_eq!(status(&mut bench).faults, SupplyFaults::NONE, "nothing was on");
    bench.model().has_fault = false;
    bench.ask(&on(8_000));
    bench.model().has_fault = true;
    bench.run(1_000);
    assert!(!bench.model().is_supplied);
    bench.model().has_fault = false;
    bench.run(1_000_000);
    assert!(!bench.model().is_supplied, "it stays off");
    assert_eq!(status(&mut bench).faults, SupplyFaults::OVERLOAD);
    bench.ask(&on(8_000));
    assert!(bench.model().is_supplied);
    assert_eq!(status(&mut bench).faults, SupplyFaults::NONE);
}
