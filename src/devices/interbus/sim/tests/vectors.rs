//! Tests with the golden vectors of reference 7 through the gateway. Each OUT word is written as printed, and the IN
//! word must be its exact echo or the printed value.

use super::gateway::Host;

/// Writes an OUT word and returns the IN word, both as eight hexadecimal digits.
fn exchange(host: &mut Host, out: &str) -> String {
    let [high, low] = [&out[..4], &out[4..]].map(|half| format!("{} {}", &half[..2], &half[2..]));
    assert_eq!(
        host.ask(&format!("00 07 00 00 00 0B 01 10 00 00 00 02 04 {high} {low}")),
        "00 07 00 00 00 06 01 10 00 00 00 02"
    );
    let reply = host.ask("00 08 00 00 00 06 01 04 00 00 00 02");
    reply.strip_prefix("00 08 00 00 00 07 01 04 04 ").unwrap().replace(' ', "")
}

#[track_caller]
fn walk(settings: &str, words: &[(&str, &str)]) {
    let mut host = Host::with(settings);
    for (out, expected) in words {
        assert_eq!(exchange(&mut host, out), *expected, "{out} with {settings}");
    }
}

#[test]
fn echoes_parameters() {
    walk(
        "position=0",
        &[
            ("020000FF", "C20000FF"),
            ("02000168", "C2000168"),
            ("02001000", "C2001000"),
            ("02002000", "C2002000"),
            ("04000001", "C4000001"),
            ("04001000", "C4001000"),
            ("03FFFFFF", "C3FFFFFF"),
            ("06000003", "C6000003"),
            ("06000004", "C6000004"),
            ("08000000", "C8000000"),
            ("080003E8", "C80003E8"),
            ("0801E240", "C801E240"),
            ("0A000000", "CA000000"),
            ("80000000", "00000000"),
            ("00000000", "00000000"),
            ("40000000", "0001E240"),
            ("00000000", "0001E240"),
            ("0E000000", "CE000000"),
            // The zero point is unchanged, and the preset is 0 again.
            ("80000000", "0001E240"),
            ("60000000", "00000000"),
        ],
    );
}

#[test]
fn cam_echoes_set_both_upper_bits() {
    walk(
        "position=0&steps=33554431",
        &[
            ("20800001", "E0800001"),
            ("46000015", "C6000015"),
            ("66000213", "E6000213"),
            ("420003E8", "C20003E8"),
            ("620007D0", "E20007D0"),
            ("20400093", "E0400093"),
            ("20400008", "E0400008"),
            ("20100008", "E0100008"),
            ("20100019", "E0100019"),
            // The edges are one step beyond the measuring range.
            ("4FFFFFFF", "98000004"),
            ("6FFFFFFF", "98000004"),
            ("4E000000", "CE000000"),
            ("6FFFFFFE", "EFFFFFFE"),
            ("80000000", "00000000"),
            ("20200013", "A0000015"),
            ("20200023", "A0000213"),
            ("20200000", "A0000008"),
            ("20200040", "A0000019"),
        ],
    );
}

#[test]
fn reads_out_values() {
    let settings = "position=1193046&steps=4000&revolutions=4096&temperature=25.3&operating-time=1000";
    walk(
        settings,
        &[
            // Disc position 1193046 of 33554432 is step 142.2 of 4000.
            ("00000000", "0000008E"),
            ("20210001", "A0000FA0"),
            ("2021000C", "A00000FD"),
            ("20210008", "A00003E8"),
            ("20210009", "A0000001"),
            ("2021005D", "A0000045"),
            ("2021000B", "A4000000"),
            ("80000000", "0000008E"),
        ],
    );
    walk("temperature=-10", &[("2021000C", "A1FFFF9C")]);
    walk("temperature=-10&temperature-bits=16", &[("2021000C", "A000FF9C")]);
}

#[test]
fn k1_encoder_sends_position_within_turn() {
    // Disc position 1FFEh of 2000h is FFFh of 1000h.
    walk("class=K1&position=24574", &[("00000000", "00000FFF"), ("02000168", "00000FFF")]);
}
