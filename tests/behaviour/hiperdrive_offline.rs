//! HIPERDRIVE commands without a device: decoding words, process data and packets.

use serde_json::json;

use super::support::Bench;

/// The expected values come from sections 3, 6 and 9 of hiperdrive.md.
#[test]
fn explains_example_words_and_process_data() {
    let bench = Bench::new();
    let cases: [(&[&str], &[&str]); 27] = [
        (&["0400"], &["OUT: control word, keeps it ready: bits 10 control by PLC"]),
        (
            &["0x0439"],
            &["holds, and starts a job if status bit 12 is 1", "0 on, 3 enable operation, 4 no stop, 5 no pause"],
        ),
        (&["0479"], &["starts a job if status bit 12 is 0", "6 job toggle"]),
        (
            &["1419", "1459", "1449", "1479"],
            &["stands", "runs clockwise to the end", "runs counterclockwise to the end", "without end"],
        ),
        (&["0481"], &["acknowledges a fault when bit 7 falls"]),
        (&["0509"], &["a jog step, which no stop ends"]),
        (&["2A30", "2A31", "2A33"], &["IN: status word, not ready", "status word, ready", "status word, operational"]),
        (&["2A37", "1A37", "3E37"], &["enabled", "moving", "10 target reached"]),
        (&["2AB8", "2A70"], &["status word, fault", "switch-on lock"]),
        (&["047F"], &["OUT: not to be sent", "reserved bits set (1, 2)", "IN: status word", "no drive sends that"]),
        (&["0000"], &["leaves the drive alone", "no drive found"]),
        // 163840 is 2.5 · 65536, and −65536 is one turn backwards.
        (
            &["79 04 64 64 00 80 02 00"],
            &["OUT: drive 1: control word 0479", "speed 100 %", "target 163840 (turn 2, 180.000°"],
        ),
        (
            &["39 04 32 4B 00 00 FF FF 00 00 00 00 00 00 00 00"],
            &["speed 50 %, torque 75 %, target -65536 (turn -1, 0.000°"],
        ),
        // 32 % and 100 % could be mistaken for the class of a CIP request.
        (&["39 04 20 64 00 80 02 00"], &["OUT: drive 1: control word 0439", "speed 32 %, torque 100 %"]),
        (&["0E 03 20 65 24 01 30 6B", "--direction", "in"], &["IN: drive 1: status word 030E"]),
        (&["04 79 64 64 00 02 80 00", "--order", "big"], &["control word 0479", "target 163840"]),
        (
            &["37 1A 20 03 A0 86 01 00"],
            &["IN: drive 1: status word 1A37 (moving", "speed 80 rpm, position 100000 (turn 1, 189.316°"],
        ),
        (
            &["A6 10 00 00 00 00 00 00", "--direction", "out"],
            &["OUT: parameter word: read of parameter 166 (maximum speed of drive 1)"],
        ),
        (
            &["A6 10 00 00 5E 01 00 00", "--direction", "in"],
            &["parameter 166 (maximum speed of drive 1) is 350 (35 rpm)"],
        ),
        (&["9E 30 00 00 00 00 01 FE"], &["write -33488896 steps to parameter 158 (lower limit of drive 1)"]),
        (&["9E 70 00 00 02 00 00 00"], &["parameter 158 (lower limit of drive 1) refused: beyond its limits (2)"]),
        (&["2F 20 00 00 FC FF 00 00"], &["write -4 (reset the drives) to parameter 47"]),
        (&["79 50 00 00 48 44 41 33"], &["parameter 121 (drive name of drive 1) is \"HDA3\""]),
        (&["A6 20 00 00 5F 01 00 00"], &["write 351 (35.1 rpm)", "warning: it may be 5 to 350"]),
        // A word is given for a parameter of double-word size, a double word for one of word size, and data of another
        // length (issue 21.9).
        (
            &["6B 10 00 00 02 00 00 00", "--direction", "in"],
            &["parameter 107 (actual position of drive 1) is no value (2 bytes where its type has 4: 0x2)"],
        ),
        (
            &["A6 20 00 00 02 00 00 00", "--direction", "in"],
            &["parameter 166 (maximum speed of drive 1) is no value (4 bytes where its type has 2: 0x2)"],
        ),
        (
            &["10 03 20 65 24 01 30 BA 0A"],
            &["parameter 186", "the value has the wrong length (bytes received: 1, expected: 2): 0A"],
        ),
    ];
    for (arguments, words) in cases {
        let ran = bench.run(&[&["decode", "hiperdrive"], arguments].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        for word in words {
            assert!(ran.out.contains(word), "{word}: {ran:?}");
        }
    }
    // A hub with four drives: drive 3 begins at byte 16 with 2A31 and −1.5 rpm. The others are missing.
    let hub = format!("{} 31 2A F1 FF 00 00 00 00 {}", "00 ".repeat(16), "00 ".repeat(8));
    let told = bench.run(&["decode", "hiperdrive", "--direction", "in", "--json", &hub]).json();
    let drives = &told["frames"][0]["readings"][0]["drives"];
    assert_eq!(drives.as_array().map(Vec::len), Some(4));
    let third = json!({"drive": 3, "status": "2A31", "state": "ready", "speed_rpm": -1.5, "position": 0});
    assert_eq!(drives[2], third);
}

/// The expected values come from sections 7 and 9 of hiperdrive.md.
#[test]
fn explains_example_packets() {
    let bench = Bench::new();
    let zeros = "00 ".repeat(20);
    let register = format!("65 00 04 00 {zeros} 01 00 00 00");
    let request = format!(
        "6F 00 18 00 78 56 34 12 {} 00 00 00 00 00 00 02 00 00 00 00 00 B2 00 08 00 0E 03 20 65 24 01 30 6B",
        "00 ".repeat(16)
    );
    let both = format!("{register} {request}");
    let refused = format!("6F 00 00 00 78 56 34 12 64 00 00 00 {}", "00 ".repeat(12));
    let open = "54 02 20 06 24 01 03 FA 00 00 00 00 01 00 01 00 01 00 34 12 CD AB 00 00 01 00 00 00 10 27 00 00 16 48 10 27 \
                00 00 12 48 01 04 20 04 24 68 2C 64 2C 65";
    let opened = "D4 00 00 00 01 00 02 00 01 00 01 00 01 00 34 12 CD AB 00 00 10 27 00 00 10 27 00 00 00 00";
    let owned = "D4 00 01 01 06 01 01 00 34 12 CD AB 00 00 04 00";
    let close = "4E 02 20 06 24 01 03 FA 01 00 34 12 CD AB 00 00 04 00 20 04 24 68 2C 64 2C 65";
    let out = "02 00 02 80 08 00 01 00 02 00 01 00 00 00 B1 00 16 00 01 00 01 00 00 00 39 04 64 64 00 80 02 00 00 00 00 00 00 \
               00 00 00";
    let back =
        "02 00 02 80 08 00 01 00 01 00 01 00 00 00 B1 00 12 00 01 00 37 2A 00 00 00 80 02 00 00 00 00 00 00 00 00 00";
    let either: [(&str, &[&str]); 8] = [
        (&register, &["RegisterSession: 4 bytes", "version 1"]),
        (
            &both,
            &["RegisterSession", "SendRRData, session 0x12345678", "Get_Attribute_Single of class 0x65, instance 1"],
        ),
        (&refused, &["status 0x00000064 no such session", "connect again"]),
        (
            open,
            &[
                "every 10 ms: 22 bytes, point to point (0x4816)",
                "18 bytes",
                "80 ms",
                "class 0x04 (assembly), instance 104",
            ],
        ),
        (opened, &["to the target as 0x00020001 every 10 ms, to the originator as 0x00010001"]),
        (owned, &["0x0106 another master owns the outputs", "4 words of the path left"]),
        (close, &["ForwardClose", "connection 1 of vendor 4660, serial number 43981"]),
        ("8E 00 0E 00", &["status 0x0E attribute cannot be set"]),
    ];
    let drives: [(&str, &[&str]); 5] = [
        (&request, &["parameter 107 (actual position of drive 1)"]),
        ("10 03 20 65 24 01 30 9E 00 00 01 FE", &["parameter 158 (lower limit of drive 1) = -33488896 steps"]),
        ("10 03 20 6C 24 01 30 65 7F 04", &["parameter 801 (control word of drive 8) = 047F", "reserved bits"]),
        (out, &["connection 0x00020001: count 1, run", "OUT: drive 1: control word 0439", "target 163840"]),
        (back, &["connection 0x00010001", "IN: drive 1: status word 2A37 (enabled"]),
    ];
    let of_drives = |(packet, words)| ("hiperdrive", packet, words);
    let both_ways =
        either.into_iter().flat_map(|(packet, words)| ["ethernet-ip", "hiperdrive"].map(|of| (of, packet, words)));
    for (protocol, packet, words) in both_ways.chain(drives.into_iter().map(of_drives)) {
        let ran = bench.run(&["decode", protocol, packet]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        for word in words {
            assert!(ran.out.contains(word), "{word}: {ran:?}");
        }
    }
    // For another device, an attribute is shown as a number.
    let other = bench.run(&["decode", "ethernet-ip", &request]);
    assert!(!other.out.contains("parameter"), "{other:?}");
    let told = bench.run(&["decode", "hiperdrive", "--json", out]).json();
    let frame = &told["frames"][0];
    assert_eq!((&frame["packet"], &frame["sequence"], &frame["run"]), (&json!("cyclic"), &json!(1), &json!(true)));
    assert_eq!(frame["readings"][0]["drives"][0]["control"], "0439");
}

#[test]
fn json_has_every_reading() {
    let bench = Bench::new();
    let told = bench.run(&["decode", "hiperdrive", "--json", "0401", "2AB8", "2A37"]).json();
    let frames = told["frames"].as_array().unwrap();
    assert_eq!((&frames[0]["bytes"], &frames[0]["device"]), (&json!("0401"), &json!("hiperdrive")));
    let readings = frames[0]["readings"].as_array().unwrap();
    assert_eq!(readings.len(), 1);
    assert_eq!((&readings[0]["direction"], &readings[0]["bits"]), (&json!("out"), &json!(["on", "control by PLC"])));
    assert_eq!(
        (&frames[1]["readings"][0]["direction"], &frames[1]["readings"][0]["state"]),
        (&json!("in"), &json!("fault"))
    );
    assert_eq!(frames[2]["valid"], true);
}

#[test]
fn rejects_illegal_and_invalid_words() {
    let bench = Bench::new();
    let failing: [(&[&str], &[&str]); 7] = [
        (&["hiperdrive", "--direction", "out", "047F"], &["047F", "reserved bits set (1, 2)"]),
        (&["hiperdrive", "--direction", "out", "7F 04 64 64 00 00 00 00"], &["drive 1", "047F", "must be 0"]),
        (&["hiperdrive", "01 02 03"], &["8, 16, 32, 40, 64 or 72 bytes, not 3", "0439"]),
        (&["hiperdrive", "01"], &["not 1)"]),
        (&["ethernet-ip", "01 02 03"], &["no frame, no cyclic packet and no CIP message"]),
        // A byte of the message is missing, or a list of items is incomplete.
        (&["ethernet-ip", &format!("65 00 04 00 {} 01 00 00", "00 ".repeat(20))], &["cut off", "27 bytes"]),
        (&["ethernet-ip", &format!("63 00 04 00 {} 01 00 0C 00", "00 ".repeat(20))], &["list of items is incomplete"]),
    ];
    for (arguments, words) in failing {
        bench.run(&[&["decode"], arguments].concat()).fails(1, words);
    }
    let wrong: [(&[&str], &[&str]); 6] = [
        (&["hiperdrive", "04GG"], &["04GG", "hexadecimal"]),
        (&["hiperdrive", "0439", "00 01 02"], &["words", "bytes", "cannot be mixed"]),
        (&["hiperdrive", "0439", "--mode", "cam"], &["--mode", "interbus"]),
        (&["ethernet-ip", "0439", "--direction", "in"], &["--direction", "interbus and hiperdrive"]),
        (&["interbus", "020000FF", "--order", "big"], &["--order", "hiperdrive"]),
        (&["ethernet-ip", ""], &["no bytes"]),
    ];
    for (arguments, words) in wrong {
        bench.run(&[&["decode"], arguments].concat()).fails(2, words);
    }
}
