//! Tests of saving data, filter and preset, of the flash's write cycles, and of a power loss during a save.

use super::*;
use crate::devices::biss::protocol::PositionFilter;

/// OEM data is written only after its area has been opened, and is saved once, as in section 5.3 of the reference.
#[test]
fn oem_data_write_matches_reference() {
    let mut host = Host::with("cycles=10");
    assert!(!host.write("0x24:0x10", 0xAB), "closed");
    host.enter(0x04);
    assert!(!host.write("0x24:0x10", 0xAB), "still closed");
    host.expect("0x00:0x1B", 0x00);
    host.put("0x00:0x1A", 0x02);
    host.expect("0x00:0x1B", 0x01);
    for (register, value) in [("0x24:0x10", 0xAB), ("0x24:0x11", 0xCD), ("0x43:0x3F", 0xEF)] {
        host.put(register, value);
        host.expect(register, value);
    }
    assert!(!host.write("0x23:0x3F", 1), "motor data is another area");
    assert_eq!(host.encoder.flash().oem_data()[0x10], 0, "not saved yet");
    host.put("0x00:0x1A", 0x03);
    host.expect("0x00:0x1B", 0x00);
    host.put("0x6A", 0x00);
    assert_eq!(host.encoder.flash().oem_data()[0x10..0x12], [0xAB, 0xCD]);
    assert_eq!(host.encoder.flash().oem_data()[2047], 0xEF);
    assert_eq!(host.encoder.flash().write_cycles(), 11, "one save");
    host.encoder.power_cycle(host.now);
    host.wait(1.0);
    host.expect("0x24:0x10", 0xAB);
}

#[test]
fn motor_data_has_separate_area() {
    let mut host = Host::with("");
    host.enter(0x04);
    host.put("0x00:0x1A", 0x01);
    host.put("0x04:0x00", 0x11);
    host.put("0x23:0x3F", 0x22);
    assert!(!host.write("0x24:0x00", 1));
    host.put("0x00:0x1A", 0x03);
    let motor_data = host.encoder.flash().motor_data();
    assert_eq!((motor_data[0], motor_data[2047]), (0x11, 0x22));
}

#[test]
fn discards_cancelled_or_abandoned_writes() {
    for end in [("0x00:0x1A", 0x04), ("0x6A", 0x00)] {
        let mut host = Host::with("cycles=10");
        host.enter(0x04);
        host.put("0x00:0x1A", 0x02);
        host.put("0x24:0x00", 0x77);
        host.put(end.0, end.1);
        host.expect("0x24:0x00", 0);
        assert_eq!(host.encoder.flash().write_cycles(), 10);
    }
    let mut host = Host::with("");
    host.enter(0x04);
    assert!(!host.write("0x00:0x1A", 0x03), "nothing is open");
    host.put("0x00:0x1A", 0x02);
    assert!(!host.write("0x00:0x1A", 0x01), "one at a time");
    host.expect("0x00:0x1B", 0x01);
}

/// A filter is selected and saved, and takes effect after the restart, as in section 5.4 of the reference.
#[test]
fn filter_selection_matches_reference() {
    let mut host = Host::with("cycles=0");
    host.enter(0x05);
    host.expect("0x00:0x25", 0x00);
    assert!(!host.write("0x00:0x24", 0x04), "not opened");
    host.put("0x00:0x24", 0x01);
    host.expect("0x00:0x25", 0x02);
    assert!(!host.write("0x00:0x24", 0x02), "nothing chosen");
    host.put("0x00:0x24", 0x04);
    host.expect("0x00:0x25", 0x01);
    host.put("0x00:0x24", 0x02);
    assert!(!host.answers(), "it restarts");
    host.wait(0.5);
    assert!(host.answers());
    for (register, value) in [("0x6E", 0x04), ("0x6A", 0x00), ("0x6B", 0x00)] {
        host.expect(register, value);
    }
    assert_eq!((host.encoder.flash().filter(), host.encoder.flash().write_cycles()), (PositionFilter::Dynamic, 1));
}

/// A preset value of 270° is stored first, and then the position is set to it, as in section 5.5 of the reference.
#[test]
fn position_preset_matches_reference() {
    let mut host = Host::with("cycles=0&position=0x12345");
    host.enter(0x07);
    assert!(!host.write("0x01:0x02", 0x00), "not opened");
    host.put("0x01:0x00", 0x02);
    host.expect("0x01:0x01", 0x01);
    for (register, value) in [
        ("0x01:0x02", 0x00),
        ("0x01:0x03", 0x80),
        ("0x01:0x04", 0x01),
        ("0x01:0x05", 0x34),
        ("0x01:0x06", 0x12),
        ("0x01:0x07", 0x00),
    ] {
        host.put(register, value);
        host.expect(register, value);
    }
    host.put("0x01:0x00", 0x03);
    assert!(!host.answers(), "it restarts");
    host.wait(0.5);
    assert_eq!(host.position(), Some((0, 0x12345)), "stored, not performed");
    host.expect("0x01:0x03", 0x80);
    host.enter(0x07);
    host.put("0x01:0x00", 0x01);
    assert!(!host.answers());
    host.wait(0.5);
    assert_eq!(host.position(), Some((0x1234, 0x18000)));
    host.expect("0x6A", 0x00);
    assert_eq!(host.encoder.flash().write_cycles(), 2);
}

#[test]
fn presets_singleturn_and_multiturn_separately() {
    for (command, position) in [(0x04, (0, 0)), (0x05, (0, 0x18000)), (0x01, (0, 0))] {
        let mut host = Host::with("position=0x18000");
        host.enter(0x07);
        host.put("0x01:0x00", command);
        host.wait(0.5);
        assert_eq!(host.position(), Some(position), "{command}");
    }
}

#[test]
fn rejects_preset_beyond_range() {
    let mut host = Host::with("cycles=0");
    host.enter(0x07);
    host.put("0x01:0x00", 0x02);
    host.put("0x01:0x04", 0x02); // singleturn 2¹⁷
    assert!(!host.write("0x01:0x00", 0x03));
    host.put("0x01:0x04", 0x01);
    host.put("0x01:0x07", 0x01); // multiturn 2¹⁶
    assert!(!host.write("0x01:0x00", 0x03));
    assert!(host.answers() && host.encoder.flash().write_cycles() == 0);
}

#[test]
fn loses_power_during_second_store() {
    let mut host = Host::with("fault=die-in-store:2");
    for _ in 0..2 {
        host.enter(0x04);
        host.put("0x00:0x1A", 0x02);
        host.put("0x24:0x00", 0x77);
        host.put("0x43:0x00", 0x77);
        assert!(host.answers());
        host.put("0x00:0x1A", 0x03);
        host.write("0x6A", 0x00);
        host.wait(1.0);
    }
    assert!(!host.answers() && !host.encoder.has_power());
    let mut host = Host::with("fault=die-in-store:1");
    host.enter(0x04);
    host.put("0x00:0x1A", 0x02);
    host.put("0x24:0x00", 0x77);
    host.put("0x43:0x00", 0x77);
    host.put("0x00:0x1A", 0x03);
    host.encoder.connect(host.now);
    host.wait(0.5);
    assert!(host.answers());
    host.expect("0x24:0x00", 0x77);
    host.expect("0x43:0x00", 0x00); // the second half was not written
}
