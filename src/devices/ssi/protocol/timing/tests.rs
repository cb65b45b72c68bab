//! Tests of the times in the reference, sections 1 and 5.

use super::*;
use crate::devices::ssi::protocol::Families;

fn reads(clocks: u8, clock_hz: f64, pause_us: u64) -> ReadConditions {
    ReadConditions {
        clocks,
        clock_hz,
        pause: Duration::from_micros(pause_us),
        cable_metres: None,
        synchronous: false,
        any_steps: false,
    }
}

fn times(key: &str) -> Times {
    Families::built_in().find_by_key(key).unwrap().times
}

/// Without a family, tm is 15 to 25 µs, the clock is at most 2 MHz, and the cable table of all SSI encoders applies. 33
/// bits at 400 kHz take 82.5 µs. The interval between positions is unknown (reference section 1).
#[test]
fn any_encoder_uses_general_times() {
    let reads = ReadConditions { cable_metres: Some(80.0), ..reads(33, 400e3, 20) };
    let timing = Times::for_any_encoder(&reads);
    assert_eq!(timing.burst, Duration::from_nanos(82_500));
    assert_eq!(timing.cycle, Duration::from_nanos(102_500));
    assert_eq!(timing.monoflop, (Duration::from_micros(15), Duration::from_micros(25)));
    assert_eq!((timing.cable_hz, timing.age), (Some(300_000), None));
    let short = Warning::PauseShort { least: Duration::from_micros(25) };
    assert_eq!(timing.warnings, [Warning::CableClock { most_hz: 300_000 }, short]);
    let fast = ReadConditions { clock_hz: 2.5e6, pause: Duration::from_micros(30), cable_metres: None, ..reads };
    let synchronous = ReadConditions { synchronous: true, ..fast };
    let too_fast = Warning::EncoderClock { most_hz: 2_000_000 };
    assert_eq!(Times::for_any_encoder(&fast).warnings, [too_fast]);
    assert_eq!(Times::for_any_encoder(&synchronous).warnings, [Warning::SynchronousUnknown, too_fast]);
}

/// The durations are from reference section 1, "Duration (bits/f)".
#[test]
fn bursts_match_reference() {
    let table = [(25, 400e3, 62_500), (25, 1e6, 25_000), (25, 1.5e6, 16_667), (33, 400e3, 82_500)];
    for (clocks, clock_hz, nanoseconds) in table {
        let timing = times("afm60").calculate_timing(&reads(clocks, clock_hz, 100));
        assert_eq!(timing.burst, Duration::from_nanos(nanoseconds), "{clocks} at {clock_hz}");
    }
    // 33 bits at 400 kHz and a tm of 25 µs take 107.5 µs.
    let timing = times("afm60").calculate_timing(&reads(33, 400e3, 100));
    assert_eq!(timing.least_pause, Duration::from_micros(25));
    assert_eq!(timing.monoflop, (Duration::from_micros(15), Duration::from_micros(25)));
    assert!((timing.most_reads_hz - 1e6 / 107.5).abs() < 1e-6, "{}", timing.most_reads_hz);
}

#[test]
fn cable_lengths_match_manual() {
    let table =
        [(49.9, Some(400_000)), (50.0, Some(300_000)), (150.0, Some(200_000)), (399.0, Some(100_000)), (400.0, None)];
    for (metres, most_hz) in table {
        let timing =
            times("afm60").calculate_timing(&ReadConditions { cable_metres: Some(metres), ..reads(25, 150e3, 100) });
        assert_eq!(timing.cable_hz, most_hz, "{metres} m");
        let warned = timing.warnings.iter().any(|it| matches!(it, Warning::CableClock { .. } | Warning::CableLong));
        assert_eq!(warned, most_hz.is_none_or(|most| most < 150_000), "{metres} m");
    }
}

/// The limits are from reference section 5.
#[test]
fn family_timing_limits_cause_warnings() {
    let warnings = |key: &str, reads: &ReadConditions| times(key).calculate_timing(reads).warnings;
    let micros = Duration::from_micros;
    let ahm = reads(27, 400e3, 200);
    let behind = |reads: ReadConditions| ReadConditions { synchronous: true, ..reads };
    assert_eq!(warnings("ahm36", &ahm), []);
    assert_eq!(warnings("ahm36", &reads(27, 400e3, 600_001)), [Warning::PauseLong { most: micros(600_000) }]);
    // 27 bits at 2 MHz take 13.5 µs. With a pause of 30 µs, a frame is read every 43.5 µs, but a new position is
    // available only every 125 µs.
    assert_eq!(warnings("ahm36", &reads(27, 2e6, 30)), [Warning::Repeats { update: micros(125) }]);
    assert_eq!(warnings("ahm36", &behind(reads(27, 400e3, 100))), [Warning::PauseShort { least: micros(150) }]);
    assert_eq!(warnings("atm60", &behind(reads(25, 1.6e6, 300))), [Warning::EncoderClock { most_hz: 1_500_000 }]);
    let odd = ReadConditions { any_steps: true, ..behind(reads(25, 400e3, 180)) };
    assert_eq!(warnings("atm60", &odd), [Warning::PauseShort { least: micros(200) }]);
    assert_eq!(warnings("afs60", &behind(reads(21, 400e3, 100))), [Warning::NoSynchronous]);
    assert_eq!(warnings("afs60", &reads(21, 2.1e6, 100)), [Warning::EncoderClock { most_hz: 2_000_000 }]);
    // A clock level may last at most 15 µs, which is half a period at 33.3 kHz.
    assert!(matches!(warnings("afs60", &reads(21, 33e3, 100))[..], [Warning::ClockSlow { .. }]));
    assert_eq!(warnings("afs60", &reads(21, 34e3, 100)), []);
}

#[test]
fn computes_position_age() {
    let micros = |all: f64| Duration::from_secs_f64(all * 1e-6);
    // 25 clocks at 500 kHz take 50 µs.
    let burst = reads(25, 500e3, 300);
    let behind = ReadConditions { synchronous: true, ..burst };
    assert_eq!(times("atm60").calculate_timing(&burst).age, Some((micros(55.0), micros(200.0))));
    let tm = times("atm60").calculate_timing(&behind).monoflop;
    assert_eq!(tm, (micros(150.0), micros(150.0)), "synchronous");
    let any_steps = ReadConditions { any_steps: true, ..burst };
    assert_eq!(times("atm60").calculate_timing(&any_steps).age, Some((micros(55.0), micros(250.0))));
    assert_eq!(
        times("atm60").calculate_timing(&behind).age,
        Some((micros(400.0), micros(400.0))),
        "that of the burst before"
    );
    assert_eq!(
        times("ahm36").calculate_timing(&behind).age,
        Some((micros(330.0), micros(330.0))),
        "taken 20 µs behind the burst"
    );
    assert_eq!(times("ttk70").calculate_timing(&burst).age, None);
}
