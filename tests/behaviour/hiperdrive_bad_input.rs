//! HIPERDRIVE commands that must fail. Each case ends with one clear sentence, and nothing is set.

use super::hiperdrive_tap::TappedDevice;
use super::support::Bench;

#[test]
fn unwritable_value_is_rejected_with_reason() {
    let bench = Bench::new();
    let cases: [(&[&str], i32, &[&str]); 32] = [
        // Both the program's and the drive's rejection name both limits.
        (&["166", "351"], 1, &["166", "351", "5 to 350"]),
        (&["166", "4"], 1, &["5 to 350"]),
        // The range is 512 turns of 65536 steps in either direction, and 1024 turns for the step sizes of the jog keys
        // (issue 21.10).
        (&["158", "2147483648"], 1, &["158", "-33554432 to 33554432"]),
        (&["158", "-2147483648"], 1, &["-33554432 to 33554432"]),
        (&["158", "-33554433"], 1, &["-33554432 to 33554432"]),
        (&["160", "33554433"], 1, &["160", "-33554432 to 33554432"]),
        (&["170", "67108865"], 1, &["170", "-67108864 to 67108864"]),
        (&["176", "-67108865"], 1, &["176", "-67108864 to 67108864"]),
        (&["198", "33554433"], 1, &["-33488896 to 33488896"]),
        (&["186", "256"], 1, &["1 to 100, or 255"]),
        (&["186", "200"], 1, &["1 to 100, or 255"]),
        (&["190", "115200"], 1, &["9600, 19200, 38400"]),
        (&["154", "0"], 1, &["1 to 65535"]),
        (&["47", "2"], 1, &["-4, -3, -2, -1, 1"]),
        (&["47", "0"], 1, &["47", "save"]),
        // The lower limit (158) is above the upper one (160).
        (&["158", "33488896"], 1, &["33488896"]),
        // These parameters are read-only.
        (&["107", "0"], 1, &["107", "Actual position", "read-only"]),
        (&["17", "1"], 1, &["17", "read-only"]),
        (&["13", "1"], 1, &["13", "read-only"]),
        // This parameter moves the drive.
        (&["101", "1"], 1, &["101", "move hiperdrive"]),
        (&["102", "50"], 1, &["102", "move hiperdrive"]),
        (&["104", "1000"], 1, &["104", "move hiperdrive"]),
        (&["199", "1"], 1, &["199", "presence-test", "factory --all"]),
        // These values cannot be parsed.
        (&["155", "1"], 2, &["155"]),
        (&["limit", "1"], 2, &["limit", "158 drive 2"]),
        (&["158", "low"], 2, &["158", "low"]),
        (&["258", "1", "--drive", "3"], 2, &["258", "3"]),
        (&["47", "1", "--drive", "2"], 2, &["47"]),
        (&["158", "1", "--drive", "9"], 2, &["9"]),
        // These parameters do not exist.
        (&["266", "100"], 1, &["2"]),
        (&["900", "1"], 2, &["900"]),
        (&["158 drive 2", "1"], 1, &["2"]),
    ];
    let device = TappedDevice::start(&bench, &[]);
    for (words, status, said) in cases {
        let ran = device.ask(&bench, &[&["write", "hiperdrive"], words, &["--yes"]].concat());
        ran.fails(status, said);
        assert!(device.sets().is_empty(), "{words:?}");
    }
}

#[test]
fn names_ports_without_drive() {
    let bench = Bench::new();
    let hub = "sim:?hub=4&drives=1,0,1";
    for words in [
        &["read", "hiperdrive", "158", "--drive", "2"][..],
        &["position", "hiperdrive", "--drive", "2"],
        &["status", "hiperdrive", "--drive", "2"],
        &["do", "hiperdrive", "set-position", "0", "--drive", "2", "--yes"],
        &["write", "hiperdrive", "258", "0", "--yes"],
    ] {
        bench.run(&[words, &["--link", hub, "--json"]].concat()).fails(1, &["2"]);
    }
    bench.run(&["position", "hiperdrive", "--drive", "5", "--link", hub]).fails(1, &["5", "4"]);
    for words in [
        &["position", "hiperdrive", "--drive", "2"][..],
        &["move", "hiperdrive", "0", "--drive", "2", "--yes"],
        &["read", "hiperdrive", "158", "--drive", "2"],
        &["write", "hiperdrive", "158", "0", "--drive", "2", "--yes"],
        &["do", "hiperdrive", "acknowledge", "--drive", "2", "--yes"],
        &["do", "hiperdrive", "set-position", "0", "--drive", "2", "--yes"],
    ] {
        bench
            .run(&[words, &["--link", "sim:"]].concat())
            .fails(1, &["This device has only one drive, so drive 2 does not exist"]);
    }
}

#[test]
fn rejects_options_of_other_devices() {
    let bench = Bench::new();
    for (words, said) in [
        (&["read", "interbus", "steps", "--drive", "1"][..], "--drive is not for interbus"),
        (&["write", "biss", "0x40", "1", "--drive", "1"], "--drive is not for biss"),
        (&["do", "hiperface", "check", "--all"], "--all is not for hiperface"),
        (&["do", "hiperdrive", "calibrate"], "calibrate is not an action of hiperdrive"),
        (&["do", "biss", "acknowledge"], "acknowledge is not an action of biss"),
        (&["do", "hiperdrive", "save", "--all"], "--all is not for save"),
        (&["do", "hiperdrive", "save", "--drive", "1"], "--drive is not for save"),
        (&["do", "hiperdrive", "save", "now"], "no argument"),
        (&["do", "hiperdrive", "set-position"], "one position"),
        (&["do", "hiperdrive", "set-position", "here", "--yes"], "not a number"),
        (&["do", "hiperdrive", "acknowledge", "--kit"], "--kit is not for hiperdrive"),
        (&["find", "hiperdrive", "--one-encoder"], "--one-encoder is not for hiperdrive"),
        (&["identify", "hiperdrive", "--code", "0=55"], "--code"),
    ] {
        bench.run(&[words, &["--link", "sim:"]].concat()).fails(2, &[said]);
    }
    bench
        .run(&["do", "hiperdrive", "set-position", "2147483648", "--link", "sim:"])
        .fails(1, &["-2147483648", "2147483647", "\"encoder-studio read hiperdrive 158\""]);
    for number in ["999", "155", "0"] {
        let ran = bench.run(&["read", "hiperdrive", number, "--link", "sim:"]);
        ran.fails(2, &[number, "101 to 199", "\"encoder-studio help read\""]);
    }
    let help = bench.run(&["help", "read"]).out;
    assert!(help.contains("  158  lower limit, steps") && help.contains("   17  serial number"), "{help}");
    bench.run(&["identify", "hiperdrive"]).fails(2, &["--link"]);
    bench.run(&["identify", "hiperdrive", "--link", "serial:/dev/null"]).fails(2, &["enip:"]);
    bench.run(&["identify", "hiperdrive", "--link", "enip:127.0.0.1?rpi=1"]).fails(2, &["5 to 100"]);
    bench.run(&["identify", "hiperdrive", "--link", "enip:127.0.0.1:99999"]).fails(2, &["99999 is not a port"]);
    bench.run(&["identify", "hiperdrive", "--link", "sim:?hub=3"]).fails(2, &["hub"]);
}

#[test]
fn writes_nothing_without_consent() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &[]);
    for words in
        [&["write", "hiperdrive", "170", "1"][..], &["do", "hiperdrive", "save"], &["do", "hiperdrive", "acknowledge"]]
    {
        device.ask(&bench, words).fails(2, &["--yes"]);
        assert!(device.heard().is_empty(), "{words:?}");
    }
}

#[test]
fn missing_device_times_out() {
    let bench = Bench::new();
    // Port 1 accepts no connections.
    let ran = bench.run(&["identify", "hiperdrive", "--link", "enip:127.0.0.1:1"]);
    ran.fails(1, &["127.0.0.1:1"]);
    let silent = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("enip:{}", silent.local_addr().unwrap());
    let ran = bench.run(&["identify", "hiperdrive", "--link", &url]);
    ran.fails(1, &["session"]);
    assert!(ran.took < std::time::Duration::from_secs(10), "{ran:?}");
}

#[test]
fn failed_save_leaves_no_file() {
    let bench = Bench::new();
    let file = bench.file("none.ron");
    bench.run(&["save", "hiperdrive", "-o", &file, "--link", "enip:127.0.0.1:1"]).fails(1, &["127.0.0.1:1"]);
    assert!(!bench.path("none.ron").exists());
}
