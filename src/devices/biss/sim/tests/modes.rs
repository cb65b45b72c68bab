//! Tests of the device modes (last table in section 5 of the reference) and of restarts.

use super::*;

#[test]
fn mode_needs_password() {
    let mut host = Host::with("");
    for mode in [0x01, 0x02, 0x04, 0x05, 0x07] {
        assert!(!host.write("0x6A", mode));
        host.expect("0x6A", 0x00);
    }
    host.put("0x6B", 0x2B);
    assert!(!host.write("0x6A", 0x01));
    for mode in [0x01, 0x02, 0x04, 0x05, 0x07] {
        host.enter(mode);
        host.put("0x6A", 0x00);
        host.expect("0x6A", 0x00);
        host.expect("0x6B", 0x2A); // mode 00 does not reset the password
    }
    host.put("0x6B", 0x00);
    assert!(!host.write("0x6A", 0x01));
}

#[test]
fn ignores_nonexistent_modes() {
    let mut host = Host::with("");
    host.put("0x6B", 0x2A);
    for mode in [0x03, 0x06, 0x08, 0xFF] {
        assert!(!host.write("0x6A", mode));
        host.expect("0x6A", 0x00);
    }
    host.enter(0x04);
    assert!(!host.write("0x6A", 0x05), "only from operation");
    host.expect("0x6A", 0x04);
    host.put("0x6B", 0x00);
    host.put("0x6A", 0x00); // returning to operation is always possible
}

#[test]
fn commands_need_matching_mode() {
    let mut host = Host::with("");
    let commands = [("0x00:0x00", 1, 0x01), ("0x00:0x06", 1, 0x02), ("0x00:0x1A", 1, 0x04), ("0x00:0x24", 1, 0x05)];
    for (register, command, _) in commands {
        assert!(!host.write(register, command), "{register}");
    }
    for (register, command, mode) in commands {
        host.enter(mode);
        for (other, other_command, own_mode) in commands {
            assert!(own_mode == mode || !host.write(other, other_command), "{other} in mode {mode}");
        }
        host.put("0x6A", 0x00);
        assert!(!host.write(register, command), "{register} after mode {mode}");
    }
}

#[test]
fn power_loss_resets_all_state() {
    let mut host = Host::with("rpm=500");
    host.enter(0x02);
    host.put("0x40", 0x24);
    host.put("0x00:0x06", 0x01);
    host.encoder.power_cycle(host.now);
    assert!(!host.answers());
    assert_eq!(host.position(), None);
    host.wait(0.499);
    assert!(!host.answers());
    host.wait(0.001);
    assert!(host.answers());
    for (register, value) in [("0x6A", 0), ("0x6B", 0), ("0x40", 0), ("0x00:0x07", 0)] {
        host.expect(register, value);
    }
}
