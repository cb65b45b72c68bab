//! The encoder supply provided by an adapter, and whether it is on or off after a session (issue 22.16).

use std::time::Duration;

use encoder_studio::buses::bridge::procedures::SupplyAfterSession::{AsFound, Off, On};
use encoder_studio::devices::biss::jobs::{BissJob, JobError};
use encoder_studio::units::SupplyVoltage;

use super::hands::{TestOperator, data};
use super::support::{Bench, at};

fn has_power(bench: &Bench) -> bool {
    bench.encoder(|encoder, _| encoder.has_power())
}

#[test]
fn session_leaves_supply_as_configured() {
    let mut bench = Bench::supplied(AsFound);
    // The supply before a session, the setting for its end, and whether the supply is on afterwards.
    for (found, after, left) in
        [(false, AsFound, false), (false, On, true), (true, AsFound, true), (true, Off, false), (false, Off, false)]
    {
        assert_eq!(has_power(&bench), found, "{after:?}");
        bench = bench.reconnected_with_supply(after);
        bench.run(BissJob::Status).unwrap();
        assert!(has_power(&bench), "{after:?}");
        bench.session.restore_state();
        assert_eq!(has_power(&bench), left, "{found} {after:?}");
    }
}

/// A supply that streaming has switched on is switched off again. One that was already on stays on (issue 22.16).
#[test]
fn signal_streaming_restores_supply() {
    let volts = SupplyVoltage { least: 4_750, nominal: 5_000, greatest: 12_500 };
    let mut bench = Bench::supplied(On);
    assert!(bench.stream_signals(Some(volts)) && !has_power(&bench));
    assert!(!bench.stream_signals(None) && !has_power(&bench));
    bench.run(BissJob::Status).unwrap();
    bench.session.restore_state();
    assert!(has_power(&bench));
    assert!(bench.stream_signals(Some(volts)) && has_power(&bench), "it was on before");
    assert!(bench.stream_signals(None) && has_power(&bench));
}

/// A session that sends no requests, or whose link does not control the supply, leaves the supply unchanged.
#[test]
fn session_switches_off_only_its_supply() {
    let mut bench = Bench::supplied(On);
    bench.run(BissJob::Status).unwrap();
    bench.session.restore_state();
    let mut other = bench.reconnected();
    other.run(BissJob::Status).unwrap();
    other.session.restore_state();
    bench.reconnected_with_supply(AsFound).session.restore_state();
    assert!(has_power(&bench));
}

/// Power is switched off only when a store is complete. An encoder that another host has put into a mode keeps its
/// power.
#[test]
fn keeps_power_during_store_and_mode() {
    let mut bench = Bench::supplied(AsFound);
    bench.change(data()).unwrap();
    let before = bench.now();
    bench.session.restore_state();
    assert!(!has_power(&bench) && bench.now() - before > Duration::from_millis(900), "{:?}", bench.now() - before);
    let mut bench = Bench::supplied(AsFound);
    bench.change(data()).unwrap();
    bench.encoder(|encoder, now| {
        assert!(encoder.write(now, at("0x6B"), 0x2A) && encoder.write(now, at("0x6A"), 1));
    });
    bench.session.restore_state();
    assert!(has_power(&bench), "it may calibrate");
}

/// An encoder that never answers keeps its power, because it may still be calibrating for an earlier session (issue
/// 22.16).
#[test]
fn silent_encoder_keeps_power() {
    let mut bench = Bench::with_switched_supply("line=open", AsFound);
    bench.run(BissJob::Status).unwrap_err();
    bench.session.restore_state();
    assert!(has_power(&bench));
    let mut bench = Bench::with_switched_supply("line=open", Off);
    bench.run(BissJob::Status).unwrap_err();
    bench.session.restore_state();
    assert!(has_power(&bench), "that it may be cut off is not said by a link");
}

/// If an interrupted write leaves the encoder unable to return to operation, it keeps its power until the return
/// succeeds.
#[test]
fn encoder_outside_operation_keeps_power() {
    let mut whole = Bench::supplied(AsFound);
    let prepared = whole.prepare(data()).unwrap();
    let begins = whole.tap().sent.len();
    let mut hands = TestOperator::on(&whole);
    whole.commit(&prepared, &mut hands).unwrap();
    let frames = whole.tap().sent.len() - begins;
    let mut kept = 0;
    for part in 0..12 {
        let mut bench = Bench::supplied(AsFound);
        let prepared = bench.prepare(data()).unwrap();
        let cut = bench.tap().sent.len() + frames * part / 12;
        bench.tap().mute_from = Some(cut);
        let mut hands = TestOperator::on(&bench);
        let error = *bench.commit(&prepared, &mut hands).unwrap_err();
        bench.tap().mute_from = None;
        let unknown =
            matches!(&error, JobError::Interrupted { interrupted, .. } if interrupted.end_state.standing.is_some());
        bench.session.restore_state();
        assert_eq!(has_power(&bench), unknown, "cut in part {part}: {error}");
        if unknown {
            kept += 1;
            bench.return_to_operation().unwrap();
            bench.session.restore_state();
            assert!(!has_power(&bench), "cut in part {part}");
        }
    }
    assert!(kept > 0);
}
