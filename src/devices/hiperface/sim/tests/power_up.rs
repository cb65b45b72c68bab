//! Tests of commands 57h and 67h, and of the power-up sequence in figure 38: the encoder is deaf, uses factory
//! settings, is deaf again, and then uses the stored settings.

use super::*;

const POSITION: &str = "40 42 00 0E 05 31 38";

/// Returns the host of an encoder with stored settings of 19200 8E1 whose power has just been switched off and on.
fn restarted() -> Host {
    let mut host = Host::with("settings=0xE5");
    host.bus.power_cycle(host.now);
    host
}

#[test]
fn stored_settings_apply_after_power_up() {
    let mut host = Host::with("settings=0xE5");
    host.set_format(0xE5);
    host.expect("40 42 02", POSITION);
    host.expect("40 52 12", "40 52 E5 37 80 01 41");
}

#[test]
fn power_up_windows_change_settings() {
    // start of the request in ms after power-on, settings of the host, whether the encoder replies
    let cases = [
        ("INIT", 0.0, 0xE4, false),
        ("end of INIT", 98.0, 0xE4, false),
        ("DEFAULT", 100.0, 0xE4, true),
        ("DEFAULT, but with the stored settings", 200.0, 0xE5, false),
        ("DEFAULT, its frame ends in time", 890.0, 0xE4, true),
        ("DEFAULT, its frame ends in SWITCH", 894.0, 0xE4, false),
        ("SWITCH", 950.0, 0xE4, false),
        ("SWITCH, with the stored settings", 1050.0, 0xE5, false),
        ("USER, with factory settings", 1100.0, 0xE4, false),
        ("USER", 1100.0, 0xE5, true),
    ];
    for (what, start, settings, answered) in cases {
        let mut host = restarted();
        host.wait(ms(start));
        host.set_format(settings);
        let reply = host.ask("40 42 02");
        if answered {
            assert_eq!(reply, POSITION, "{what}");
        } else {
            assert_eq!(reply, "", "{what}");
        }
    }
}

#[test]
fn valid_command_keeps_factory_settings() {
    for (what, request, keeps) in [
        ("read status", "40 50 10", true),
        ("broadcast", "FF 50 AF", true),
        ("another encoder's", "41 50 11", false),
        ("wrong checksum", "40 50 11", false),
        ("unknown command", "40 54 14", false),
    ] {
        let mut host = restarted();
        host.wait(ms(200.0));
        host.ask(request);
        host.wait(ms(1000.0));
        assert_eq!(host.ask("40 42 02") == POSITION, keeps, "{what}");
        host.set_format(0xE5);
        assert_eq!(host.ask("40 42 02") == POSITION, !keeps, "{what}");
    }
}

#[test]
fn settings_57_apply_after_reset() {
    let mut host = Host::with("");
    host.expect("40 57 E5 55 A7", "40 57 E5 F2");
    host.expect("40 52 12", "40 52 E5 37 80 01 41");
    host.expect("40 42 02", POSITION);
    assert_eq!(host.encoder().stored_settings().byte(), 0xE5);
    host.expect("40 53 13", "");
    host.wait(ms(1200.0));
    host.set_format(0xE5);
    host.expect("40 42 02", POSITION);
}

#[test]
fn settings_67_apply_until_reset() {
    let mut host = Host::with("");
    host.expect("40 67 E6 C1", "40 67 E6 C1"); // reply still at 9600 baud
    host.set_format(0xE6);
    host.expect("40 42 02", POSITION);
    host.expect("40 52 12", "40 52 E4 37 80 01 40");
    assert_eq!(host.encoder().wear().total(), 0);
    host.expect("40 53 13", "");
    host.wait(ms(1200.0));
    host.set_format(0xE4);
    host.expect("40 42 02", POSITION);
}

#[test]
fn reset_clears_queue_without_reply() {
    let mut host = Host::with("");
    host.encoder_mut().queue_code(crate::devices::hiperface::protocol::StatusCode::new(0x1D));
    host.expect("FF 53 AC", "");
    host.expect("40 50 10", ""); // INIT
    host.wait(ms(100.0));
    host.expect("40 50 10", "40 50 00 10");
}

#[test]
fn stored_data_survives_power_cycle() {
    let mut host = Host::with("");
    host.expect("40 43 00 00 12 34 55 70", "40 43 03");
    host.expect("40 47 07", "40 47 07");
    host.expect("40 4B 00 00 04 55 DE AD BE EF 78", "40 4B 00 00 04 0F");
    host.bus.power_cycle(host.now);
    host.wait(ms(200.0));
    host.expect("40 42 02", "40 42 00 00 12 34 24");
    host.expect("40 46 06", "40 46 00 00 01 07");
    host.expect("40 4A 00 00 04 55 5B", "40 4A 00 00 04 DE AD BE EF 2C");
}

#[test]
fn power_cut_truncates_reply() {
    let mut host = Host::with("");
    host.send("40 42 02");
    host.wait(ms(14.0)); // the reply started at 11.7 ms, so one character has arrived and one is in transit
    host.bus.power_cycle(host.now);
    assert_eq!(host.receive().0, "40 42");
}
