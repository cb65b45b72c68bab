//! Tests of how jobs, runs and steps start and end (reference, section 3).

use proptest::prelude::*;

use super::*;
use crate::devices::hiperdrive::protocol::State;

/// The start sequence and its status words match sections 3 and 9 of the reference. At 35 rpm, acceleration and braking
/// take 0.1 s each and together cover 0.0583 turns, so 2.5 turns take 0.2 + (2.5 − 0.0583) / 0.58333 s = 4.386 s.
#[test]
fn published_start_sequence_works() {
    let mut bench = Bench::single();
    for (control, status) in [(0x0000, 0x2A30), (0x0400, 0x2A31), (0x0401, 0x2A33), (0x0409, 0x2A37), (0x0439, 0x2A37)]
    {
        assert_eq!(format!("{:04X}", bench.word(control)), format!("{status:04X}"), "{control:04X}");
    }
    bench.out[FIRST].target = 163_840;
    assert_eq!(bench.word(0x0479), 0x1A37);
    let took = 30 + bench.until(0x3E37);
    assert!((4370..=4420).contains(&took), "{took} ms");
    assert_eq!((bench.position(), bench.actual(FIRST).speed), (163_840, 0));
    // The next job has another target and an inverted bit 6.
    bench.out[FIRST].target = -65_536;
    assert_eq!(bench.word(0x0439), 0x0A37);
    bench.until(0x2E37);
    assert_eq!(bench.position(), -65_536);
    // Bit 6 without a change starts nothing.
    bench.out[FIRST].target = 0;
    assert_eq!(bench.word(0x0439), 0x2E37);
    assert_eq!(bench.word(0x0000), 0x2A30);
}

/// While the word stays the same, the drive passes through one state after another. A word with reserved bits has no
/// effect.
#[test]
fn control_word_advances_as_far_as_possible() {
    let mut bench = Bench::single();
    assert_eq!(bench.word(0x0409), 0x2A37);
    assert_eq!(bench.word(0x2000), 0x2A37);
    assert_eq!(bench.word(0x0400), 0x2A31);
}

/// A stop discards a job within a tenth of a second, whereas a pause keeps it. The drive moves at the requested speed.
#[test]
fn stops_and_pauses_jobs() {
    let mut bench = Bench::single();
    bench.out[FIRST].speed = 50;
    bench.start(655_360);
    bench.run(500);
    // 50 % of 35 rpm, in tenths of rpm.
    assert_eq!(bench.actual(FIRST).speed, 175);
    bench.out[FIRST].control = 0x0459;
    bench.run(200);
    let paused = bench.actual(FIRST);
    assert_eq!((paused.status.to_u16(), paused.speed), (0x3A37, 0));
    bench.run(500);
    assert_eq!(bench.position(), paused.position);
    assert_eq!(bench.word(0x0479), 0x1A37, "it goes on");
    bench.run(500);
    bench.out[FIRST].control = 0x0469;
    bench.run(200);
    let stopped = bench.actual(FIRST);
    assert_eq!((stopped.status.to_u16(), stopped.speed), (0x3A37, 0));
    // Bit 4 is set again, and bit 6 has the acknowledged level.
    bench.out[FIRST].control = 0x0479;
    bench.run(500);
    assert_eq!(bench.position(), stopped.position);
}

/// Any control word that disables operation ends the motion (reference, section 3).
#[test]
fn disabling_operation_ends_motion() {
    for control in [0x0401, 0x0400, 0x0000, 0x0008] {
        let mut bench = Bench::single();
        bench.start(655_360);
        bench.run(300);
        bench.out[FIRST].control = control;
        bench.run(200);
        let actual = bench.actual(FIRST);
        assert_eq!((actual.speed, actual.status.to_u16() & 0x2004), (0, 0x2000), "{control:04X}");
        // Enabling operation again does not start a motion.
        bench.words(&[0x0400, 0x0401, 0x0409]);
        assert_eq!(bench.position(), actual.position, "{control:04X}");
    }
}

/// A motion starts only with a nonzero speed and torque (reference, sections 3 and 9).
#[test]
fn start_needs_speed_and_torque() {
    for (speed, torque) in [(0, 100), (100, 0)] {
        let mut bench = Bench::single();
        bench.enable();
        (bench.out[FIRST].speed, bench.out[FIRST].torque, bench.out[FIRST].target) = (speed, torque, 65_536);
        assert_eq!(bench.words(&[0x0439, 0x0479]), 0x2A37);
        assert_eq!((bench.position(), bench.error()), (0, ErrorCode::NONE));
    }
}

/// A run ends at the end of the range unless it is endless. Clearing bit 12 afterwards would start a job to a stale
/// target, which the word 0400 prevents (reference, section 3).
#[test]
fn leaving_speed_mode_starts_stale_job() {
    let mut bench = Bench::single();
    assert_eq!((bench.write(160, 65_536), bench.write(158, -65_536)), (Ok(()), Ok(())));
    bench.enable();
    assert_eq!(bench.word(0x1419), 0x2A37);
    assert_eq!(bench.word(0x1459), 0x1A37);
    bench.until(0x3A37);
    assert_eq!(bench.position(), 65_536, "the end of the range");
    assert_eq!(bench.words(&[0x1419, 0x1459]), 0x3A37);
    assert_eq!(bench.position(), 65_536, "nowhere to run");
    bench.word(0x1419);
    // ZSW12 is set, bit 6 is clear, and the target 0 is unwanted.
    assert_eq!(bench.word(0x0439), 0x0A37);
    bench.until(0x2E37);
    assert_eq!(bench.position(), 0);
    bench.words(&[0x1409, 0x1449]);
    bench.run(300);
    let running = bench.actual(FIRST);
    assert!(running.speed < 0 && running.status.state() == State::Moving, "{running:?}");
    bench.out[FIRST].control = 0x1409;
    bench.run(200);
    let stopped = bench.position();
    assert_eq!(bench.words(&[0x0400, 0x0401, 0x0409, 0x0439]), 0x2A37);
    assert_eq!(bench.position(), stopped);
    // An endless run continues past the end of the range, which the status reports.
    bench.words(&[0x1439, 0x1479]);
    bench.run(4000);
    let actual = bench.actual(FIRST);
    assert!(actual.position > 65_536 && actual.status.to_u16() & 0x8000 != 0, "{actual:?}");
}

/// Bit 4 does not stop a jog step of 4096 steps, which is 1/16 turn (reference, sections 3 and 5).
#[test]
fn jog_step_runs_to_completion() {
    let mut bench = Bench::single();
    bench.enable();
    bench.word(0x0509);
    bench.out[FIRST].control = 0x0409;
    bench.run(500);
    assert_eq!(bench.position(), 4096);
    bench.word(0x0609);
    bench.run(500);
    assert_eq!(bench.position(), 0);
    assert_eq!((bench.write(170, 65_536), bench.write(172, 10)), (Ok(()), Ok(())));
    bench.word(0x0509);
    bench.run(1000);
    // 10 % of 35 rpm, regardless of the process data.
    assert_eq!(bench.actual(FIRST).speed, 35);
}

/// The drives of a hub are not requested initially. Only a requested drive can move (reference, section 4).
#[test]
fn hub_moves_only_requested_drives() {
    let mut bench = Bench::hub();
    bench.out[1].target = 65_536;
    let both = |bench: &mut Bench, control| {
        (bench.out[0].control, bench.out[1].control) = (control, control);
        bench.run(30);
        [0, 1, 2].map(|drive| bench.actual(drive).status.to_u16())
    };
    assert_eq!(both(&mut bench, 0x0400), [0x2A30, 0x2A30, 0]);
    assert_eq!(bench.write(252, 1), Ok(()));
    assert_eq!(both(&mut bench, 0x0401), [0x2A30, 0x2A33, 0]);
    both(&mut bench, 0x0409);
    both(&mut bench, 0x0439);
    assert_eq!(both(&mut bench, 0x0479), [0x2A30, 0x1A37, 0]);
    bench.run(3000);
    assert_eq!([0, 1].map(|drive| bench.actual(drive).position), [0, 65_536]);
    // While S3 selects a drive, nothing starts.
    bench.station.set_drive_select_switch(bench.now, 2);
    bench.out[1].target = 0;
    both(&mut bench, 0x0439);
    bench.run(500);
    assert_eq!(bench.actual(1).position, 65_536);
}

#[test]
fn motion_is_independent_of_polling_interval() {
    let run = |portions: &[u64]| {
        let mut drive = Drive::new(Variant::new(7), Topology::Adapter, SpindleLoad::default());
        let at = |ms| Moment::START + Duration::from_millis(ms);
        let out = OutputData { control: 0x0479, speed: 80, torque: 50, target: 100_000 };
        drive.command(at(0), out);
        for ms in portions {
            drive.actual_values(at(*ms));
        }
        drive.actual_values(at(1500))
    };
    let whole = run(&[]);
    let fine: Vec<u64> = (0..1500).collect();
    assert_eq!(run(&fine), whole);
    assert_eq!(run(&[3, 700, 699, 1499]), whole);
    assert!(whole.speed == 280 && whole.position > 0, "{whole:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Arbitrary input causes no panic, and no motion beyond the range except in an endless run.
    #[test]
    fn arbitrary_commands_stay_within_limits(
        sent in prop::collection::vec((any::<u16>(), 0u8..=120, 0u8..=120, -200_000i32..200_000, 1u64..400), 1..60)
    ) {
        let mut bench = Bench::single();
        prop_assert_eq!((bench.write(160, 100_000), bench.write(158, -50_000)), (Ok(()), Ok(())));
        for (control, speed, torque, target, ms) in sent {
            // The words are mostly ones that a host might send, and never start an endless run.
            let control = if control & 1 == 0 { control & 0x17FF } else { 0x0409 | control & 0x0270 };
            let control = if control & 0x1020 == 0x1020 { control & !0x0020 } else { control };
            bench.out[FIRST] = OutputData { control, speed, torque, target };
            bench.run(ms);
            let actual = bench.actual(FIRST);
            prop_assert!((-50_000..=100_000).contains(&actual.position), "{:?}", actual);
            prop_assert!(actual.status.is_present() && actual.status.is_plausible());
        }
    }
}
