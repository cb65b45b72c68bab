//! Tests of the handshake, gear, preset, zero shift and speed (references 3, 4 and 7).

use super::*;

#[test]
fn worked_reference_example_matches() {
    let mut master = Master::with("stale=1&position=5000&steps=8192&revolutions=1");
    let steps = [
        (0x0000_0000, [0x0000_1388, 0x0000_1388]),
        (0x0200_00FF, [0x0000_1388, 0xC200_00FF]),
        (0x0400_0001, [0xC200_00FF, 0xC400_0001]),
        (0x0600_0003, [0xC400_0001, 0xC600_0003]),
        (0x0800_0000, [0xC600_0003, 0xC800_0000]),
        // Disc position 5000 of 8192 is step 155.6 of 255.
        (0x8000_0000, [0xC800_0000, 155]),
        (0x0000_0000, [155, 155]),
        (0x4000_0000, [155, 0]),
        (0x0000_0000, [0, 0]),
    ];
    for (out, expected) in steps {
        master.write(out);
        assert_eq!([master.read(), master.read()], expected, "{out:08X}");
    }
    assert_eq!(
        (master.encoder.store_count(), master.encoder.mode()),
        (4, crate::devices::interbus::protocol::EncoderMode::Position)
    );
}

#[test]
fn busy_words_last_configured_time() {
    let mut master = Master::with("busy=20&stale=2&position=7&steps=8192&revolutions=1");
    master.write(0x0200_0168);
    let words: Vec<u32> = (0..5)
        .map(|_| {
            let word = master.read();
            master.wait(5);
            word
        })
        .collect();
    assert_eq!(words, [7, 7, 0xC000_0000, 0xC000_0000, 0xC200_0168]);
    // Cycles also elapse without readings.
    master.write(0x0200_00B4);
    master.wait(10);
    assert_eq!(master.read(), 0xC000_0000);
    master.wait(10);
    assert_eq!(master.read(), 0xC200_00B4);
    // A position is available immediately after the old words.
    master.write(0x8000_0000);
    assert_eq!([master.read(), master.read()], [0xC200_00B4, 0xC200_00B4]);
    assert_eq!(master.read() >> 31, 0);
}

#[test]
fn position_scaling_matches_reference() {
    // Steps, turns, disc position and resulting position.
    let cases = [
        (255, 1, 0, 0),
        (255, 1, 4095, 127),
        (255, 1, 8191, 254),
        (255, 1, 8192, 0),
        (360, 1, 4096, 180),
        (360, 1, 12345, 182),
        (1000, 10, 24676, 301),
        (1000, 10, 24676 + 81920, 301),
        (1000, 10, -1, 999),
    ];
    for (steps, turns, place, position) in cases {
        // The turns are set first, because this number of steps requires them.
        let mut master = Master::with("steps=1&revolutions=1");
        master.put(&[0x0400_0000 | turns, 0x0200_0000 | steps, 0x8000_0000, 0]);
        assert_eq!(master.position(place), position, "{steps} steps, {turns} turns, place {place}");
    }
}

#[test]
fn out_of_range_values_change_nothing() {
    let mut master = Master::with("steps=8192&revolutions=1");
    let wrong = [0x0200_2001, 0x0200_0000, 0x0400_0000, 0x0400_1001, 0x0600_0002, 0x0600_0005, 0x0800_2000];
    for word in wrong {
        master.exchange(&[(word, 0x8200_0000), (0x8000_0000, 0x0000_1456), (0, 0x0000_1456)]);
    }
    assert_eq!(
        (master.encoder.store_count(), master.encoder.memory()),
        (3, &config("steps=8192&revolutions=1").memory)
    );
    // More turns allow more steps. With these steps, fewer turns are then rejected.
    master.exchange(&[(0x0400_0002, 0xC400_0002), (0x0200_4000, 0xC200_4000), (0x0400_0001, 0x8200_0000)]);
    master.exchange(&[(0x0800_3FFF, 0xC800_3FFF), (0x0A00_3FFF, 0xCA00_3FFF), (0x0600_0004, 0xC600_0004)]);
}

#[test]
fn rejects_undocumented_codes() {
    let mut master = Master::with("position=0");
    for code in [6, 8, 9, 10, 11, 12, 13, 14, 15] {
        master.exchange(&[(code << 25, 0x8400_0000), (0x8000_0000, 0), (0, 0)]);
    }
    // Words without a meaning have no effect.
    for word in [0x0009_2021, 0x2041_0000, 0x2080_0009, 0x2040_0002, 0x2020_0000, 0xA000_0000] {
        master.exchange(&[(word, 0), (0, 0)]);
    }
    assert_eq!(master.encoder.store_count(), 3);
    // Outside position mode, the word of a parameter is unknown.
    master.exchange(&[(0x2040_0001, 0), (0x0200_0168, 0x8400_0000), (0x8000_0000, 0)]);
}

#[test]
fn only_run_edge_ends_parameterisation() {
    let mut master = Master::with("position=9&steps=8192&revolutions=1");
    master.exchange(&[(0x0600_0003, 0xC600_0003), (0, 0xC600_0003), (0x4000_0000, 0xC600_0003)]);
    master.exchange(&[(0x2021_0000, 0xC600_0003), (0x2080_0001, 0xC600_0003)]);
    assert_eq!(master.encoder.store_count(), 3);
    master.exchange(&[(0x8000_0000, 9), (0x0600_0003, 0xC600_0003), (0x8000_0000, 9)]);
    assert_eq!(master.encoder.store_count(), 5);
}

#[test]
fn each_programmed_preset_triggers_once() {
    let mut master = Master::with("steps=360&revolutions=1&position=4096&preset=7");
    master.exchange(&[(0x4000_0000, 180), (0, 180), (0x2021_0006, 0xA000_0000), (0, 180)]);
    master.exchange(&[(0x0800_0064, 0xC800_0064), (0x8000_0000, 180), (0, 180), (0x2021_0006, 0xA000_0001), (0, 180)]);
    master.exchange(&[(0x4000_0000, 100), (0, 100), (0x2021_0006, 0xA000_0000), (0, 100)]);
    // The shaft makes a quarter turn. A second preset word has no effect.
    assert_eq!(master.position(6144), 190);
    master.exchange(&[(0x4000_0000, 190), (0, 190)]);
    // The FRABA preset can be applied repeatedly.
    for place in [0, 6144] {
        master.set_shaft_position(place);
        master.exchange(&[(0x6000_0000, 100), (0x8000_0000, 100), (0, 100)]);
    }
    assert_eq!(master.encoder.store_count(), 4);
}

#[test]
fn every_preset_is_reachable() {
    for (steps, turns, zero_shift) in [(255, 1, 0), (360, 1, 359), (1000, 10, 1), (8191, 1, 5), (33_554_431, 4096, 9)] {
        for preset in [0, 1, steps / 3, steps - 1] {
            let mut master = Master::with(&format!("steps={steps}&revolutions={turns}&rpm=0&position=30000000"));
            master.put(&[0x0A00_0000 | zero_shift, 0x0800_0000 | preset, 0x8000_0000, 0, 0x4000_0000, 0]);
            assert_eq!(master.read(), preset, "{steps} steps over {turns} turns, zero shift {zero_shift}");
        }
    }
}

#[test]
fn reverse_direction_counts_backwards() {
    let mut master = Master::with("steps=360&revolutions=1");
    master.put(&[0x0600_0004, 0x8000_0000, 0]);
    assert_eq!([0, 2048, 4096].map(|place| master.position(place)), [0, 270, 180]);
    assert_eq!(master.encoder.memory().direction(), 4);
}

#[test]
fn zero_shift_moves_position_within_range() {
    let mut master = Master::with("steps=360&revolutions=1&position=4096");
    master.put(&[0x0A00_00C8, 0x8000_0000, 0]);
    // 180 + 200 wraps to 20 of 360 steps, and 180 + 359 wraps to 179. A zero shift of 360 is out of range.
    assert_eq!(master.read(), 20);
    master.put(&[0x0A00_0167, 0x8000_0000, 0]);
    assert_eq!(master.read(), 179);
    master.exchange(&[(0x0A00_0168, 0x8200_0000)]);
}

#[test]
fn word_holds_speed_while_requested() {
    let mut master = Master::with("rpm=1500&position=0&steps=8192&revolutions=1");
    master.exchange(&[(0x2040_0001, 1500), (0x2021_0009, 0xA000_0002), (0, 1500), (0x2040_0000, 0), (0, 0)]);
    master.encoder.motor().set_rpm(-3.0);
    // −3 as a number of 25 bits.
    master.exchange(&[(0x2040_0001, 0x01FF_FFFD), (0x2040_0000, 0)]);
    master.put(&[0x0600_0004, 0x8000_0000, 0]);
    master.exchange(&[(0x2040_0001, 3)]);
}

#[test]
fn older_encoders_report_steps_minus_one() {
    let mut master = Master::with("steps-minus-one=on&revolutions=1&steps=360&position=4096");
    master.exchange(&[(0x2021_0001, 0xA000_0167), (0, 180), (0x2021_000A, 0xA000_0003), (0, 180)]);
    master.exchange(&[(0x0200_00FF, 0xC200_00FF), (0x8000_0000, 128), (0, 128), (0x2021_0001, 0xA000_00FF)]);
    assert_eq!(master.encoder.memory().gear().total_steps(), 256);
}

#[test]
fn factory_reset_keeps_cams() {
    let mut master = Master::with("steps=360&revolutions=1&direction=ccw&preset=5&zero-shift=6&cams=demo");
    let programs = *master.encoder.memory().program(program(2));
    master.exchange(&[(0x0E00_0001, 0x8200_0000), (0x0E00_0000, 0xCE00_0000)]);
    let memory = master.encoder.memory();
    assert_eq!((memory.gear().total_steps(), memory.gear().turns(), memory.direction()), (0x01FF_FFFF, 4096, 3));
    assert_eq!((memory.preset(), memory.zero_shift()), (0, 0));
    assert_eq!(*memory.program(program(2)), programs);
}

#[test]
fn other_classes_ignore_commands() {
    for (class, expected) in [("K1", 0x0FFF), ("K2", 0x0000_5FFE)] {
        let mut master = Master::with(&format!("class={class}&steps=0x2000&revolutions=1"));
        master.set_shaft_position(0x5FFE);
        let expected = if class == "K2" { expected & 0x1FFF } else { expected };
        master.exchange(&[(0, expected), (0x0200_0168, expected), (0x2021_0009, expected), (0x8000_0000, expected)]);
        assert_eq!(master.encoder.store_count(), 3);
    }
}
