//! Tests of cam programs (references 5 and 7).

use super::*;
use crate::devices::interbus::protocol::{Cam, StartupMode, Value};

/// Settings with two disc steps per position step.
const SETTINGS: &str = "steps=4096&revolutions=1&position=200";

fn at(position: i32) -> i32 {
    position * 2
}

fn outputs(master: &mut Master, position: i32) -> u32 {
    master.set_shaft_position(at(position));
    master.read() & 0xFF
}

#[test]
fn manual_cam_example_matches() {
    let mut master = Master::with(SETTINGS);
    master.exchange(&[
        (0x2080_0001, 0xE080_0001),
        (0x4600_0015, 0xC600_0015),
        (0x6600_0213, 0xE600_0213),
        (0x2040_0008, 0xE040_0008),
        // Bits 24..8 contain position 100 (64h), and cam 3 is on from 21 to 531.
        (0x8000_0000, 0x0000_6408),
    ]);
    assert_eq!([20, 21, 531, 532].map(|position| outputs(&mut master, position)), [0, 8, 8, 0]);
    let expected = Cam { start: Value::new(0x15).unwrap(), stop: Value::new(0x213).unwrap() };
    let kept = master.encoder.stored().program(program(1));
    assert_eq!((kept.cams[3], kept.mask, master.encoder.store_count()), (Some(expected), 8, 4));
}

#[test]
fn cam_states_match_reference() {
    let mut master = Master::with(SETTINGS);
    // Cam 0 is on from 15 to 213. Cam 1 is on from 100 to 20, across the end of the range.
    master.put(&[0x2080_0002, 0x4000_000F, 0x6000_00D5, 0x4200_0064, 0x6200_0014, 0x2040_0003, 0x8000_0000]);
    let cases = [(14, 2), (15, 3), (20, 3), (21, 1), (5, 2), (50, 1), (99, 1), (100, 3), (213, 3), (214, 2), (4095, 2)];
    for (position, expected) in cases {
        assert_eq!(outputs(&mut master, position), expected, "{position}");
    }
    // Only the cams in the mask are active.
    master.put(&[0x2040_0001, 0x8000_0000]);
    assert_eq!(outputs(&mut master, 5), 0);
}

/// As in the reference, the position is 1ABCDEFh with cam 5 on. With the largest gear, a position step is about one
/// disc step.
#[test]
fn shift_selects_window_position_bits() {
    let cases = [(0, 0x01CD_EF20), (4, 0x00BC_DE20), (8, 0x01AB_CD20), (25, 0x0000_0020)];
    for (shift, expected) in cases {
        let mut master = Master::with("cams=none");
        master.put(&[0x2080_0001, 0x4A00_0000, 0x6BFF_FFFE, 0x2040_0020, 0x2010_0000 | shift, 0x8000_0000]);
        // The gear has 1FFFFFFh steps for 2000000h disc positions and has dropped one step here, so this is disc
        // position 1ABCDEFh + 1.
        assert_eq!(master.position(0x1AB_CDF0), expected, "{shift}");
    }
}

#[test]
fn rejects_invalid_edges_and_cams() {
    let mut master = Master::with(SETTINGS);
    master.put(&[0x2080_0001, 0x4000_0001, 0x8000_0000]);
    let position = 0x0000_6400;
    let cases = [
        (0x4600_1000, 0x9800_0004),
        (0x6600_1000, 0x9800_0004),
        (0x5000_0000, 0x8400_0000),
        (0x7E00_0000, 0x8400_0000),
        (0x2040_0100, 0x8200_0000),
        (0x2010_001A, 0x8200_0000),
        (0x0200_0168, 0x8400_0000),
        (0x2020_0050, 0xA400_0000),
        (0x2020_0018, 0xA400_0000),
    ];
    for (word, error) in cases {
        master.exchange(&[(word, error), (0x8000_0000, position)]);
    }
    assert_eq!(master.encoder.store_count(), 4);
}

#[test]
fn reads_back_running_program() {
    let mut master = Master::with(SETTINGS);
    master.put(&[0x2080_0001, 0x4600_0015, 0x6600_0213, 0x2040_0008, 0x2010_0004, 0x8000_0000]);
    let live = 0x0000_0608;
    master.exchange(&[
        (0x2020_0013, 0xA000_0015),
        (0x0000_0000, live),
        (0x2020_0023, 0xA000_0213),
        (0x8000_0000, live),
        (0x2020_0000, 0xA000_0008),
        (0x2020_0040, 0xA000_0004),
        (0x2021_0009, 0xA000_0003),
        (0x0000_0000, live),
        (0x2080_0002, 0xE080_0002),
        (0x2020_0013, 0xA000_0000),
        (0x2020_0040, 0xA000_0004),
        (0x8000_0000, 0x0000_0600),
    ]);
    assert_eq!(master.encoder.store_count(), 4, "reading and selecting store nothing");
}

#[test]
fn unstored_changes_keep_outputs_invalid() {
    let mut master = Master::with(SETTINGS);
    master.put(&[0x2080_0001]);
    master.exchange(&[(0x4600_0015, 0xC600_0015), (0x2020_0013, 0xA000_0015), (0, 0x8000_0000)]);
    assert_eq!(master.encoder.store_count(), 3);
    master.exchange(&[(0x8000_0000, 0x0000_6400)]);
    assert_eq!(master.encoder.store_count(), 4);
}

#[test]
fn selecting_program_stores_pending_changes() {
    let mut master = Master::with(SETTINGS);
    master.put(&[0x2080_0001, 0x4000_0001, 0x2080_0002]);
    assert_eq!(master.encoder.store_count(), 4);
    master.put(&[0x8000_0000, 0, 0x2080_0003, 0x8000_0000, 0x2080_0000]);
    assert_eq!((master.encoder.store_count(), master.encoder.startup_mode()), (4, StartupMode::K3));
    master.exchange(&[(0, 100)]);
}

#[test]
fn running_program_treats_presets_as_cams() {
    let mut master = Master::with(SETTINGS);
    master.put(&[0x2080_0001, 0x4000_0005, 0x8000_0000]);
    // The start of cam 0 is set to 0, so its echo looks like the word of a busy encoder.
    master.exchange(&[(0x4000_0000, 0xC000_0000), (0x2020_0010, 0xA000_0000)]);
}

#[test]
fn program_selection_can_enable_outputs() {
    let mut master = Master::with(&format!("{SETTINGS}&selection=output&program=7"));
    master.exchange(&[
        (0, 0x0000_6400),
        (0x2021_0009, 0xA000_0009),
        (0x2080_0008, 0x0000_6400),
        (0x2021_0009, 0xA000_000A),
    ]);
}

#[test]
fn demo_has_example_and_wrapping_cams() {
    for steps in [1, 2, 20, 4096] {
        let config = config(&format!("steps={steps}&revolutions=1&cams=demo"));
        for number in [1, 2, 3] {
            let program = config.memory.program(program(number));
            assert_eq!(program.mask, 0xFF);
            for cam in program.cams.iter().flatten() {
                assert!(cam.start.get() < steps && cam.stop.get() < steps, "{steps}: {cam:?}");
            }
        }
    }
    let config = config("steps=4096&revolutions=1&cams=demo");
    let example = config.memory.program(program(8));
    let third = example.cams[3].map(|cam| (cam.start.get(), cam.stop.get()));
    assert_eq!((third, example.mask), (Some((15, 213)), 8));
    assert!(config.memory.program(program(3)).cams.iter().flatten().any(|cam| cam.wraps_around()));
}
