//! Faults in the input, the gateway and the encoder. Each case ends with one clear sentence.

use super::support::{Bench, Foreign, Ran};

fn ask(bench: &Bench, encoder: &Foreign, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", &encoder.url, "--json"]].concat())
}

#[test]
fn invalid_arguments_are_usage_errors() {
    let bench = Bench::new();
    let cases: &[&[&str]] = &[
        &["read", "interbus"],
        &["read", "interbus", "speed"],
        &["read", "interbus", "cam:1"],
        &["read", "interbus", "cam:x:0"],
        &["write", "interbus", "steps", "many", "--yes"],
        &["write", "interbus", "cam:1:0", "5", "--yes"],
        &["write", "interbus", "cam:1:0", "5..", "--yes"],
        &["write", "interbus", "direction", "left", "--yes"],
        &["write", "interbus", "temperature", "20", "--yes"],
        &["find", "interbus"],
        &["do", "interbus", "calibrate", "--yes"],
        &["do", "interbus", "preset", "1", "2", "--yes"],
        &["do", "interbus", "preset", "here", "--yes"],
        &["do", "interbus", "default", "now", "--yes"],
        &["do", "interbus", "lead-back", "now"],
        &["do", "interbus", "preset", "1", "--timeout", "5", "--yes"],
        &["position", "interbus", "--count", "many"],
        &["position", "interbus", "--layout", "atm60"],
    ];
    for arguments in cases {
        let ran = bench.run(&[*arguments, &["--link", "sim:", "--json"]].concat());
        assert_eq!((ran.status, ran.out.as_str()), (Some(2), ""), "{arguments:?}: {ran:?}");
        assert!(!ran.err.is_empty() && !ran.err.contains("panicked"), "{ran:?}");
    }
    bench.run(&["identify", "interbus"]).fails(2, &["--link"]);
    bench.run(&["identify", "interbus", "--link", "modbus:127.0.0.1:1?unit=300"]).fails(2, &["unit", "0", "255"]);
    bench.run(&["identify", "interbus", "--link", "tcp:127.0.0.1:1"]).fails(2, &["modbus:", "sim:"]);
    bench.run(&["identify", "biss", "--link", "modbus:127.0.0.1:1"]).fails(2, &["modbus"]);
}

/// The value is rejected before anything is sent, or before anything is set if a reading is needed to check it. The
/// message states both limits.
#[test]
fn range_error_names_both_limits() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600"]) else { return };
    let cases: &[(&[&str], &[&str])] = &[
        (&["read", "interbus", "cam:9:0"], &["program 9", "1 to 8"]),
        (&["read", "interbus", "cam-mask:0"], &["program 0", "1 to 8"]),
        (&["write", "interbus", "cam:1:8", "0..1", "--yes"], &["cam 8", "0 to 7"]),
        (&["write", "interbus", "cam:1:0", "0..33554432", "--yes"], &["33554432", "0 to 33554431"]),
        (&["write", "interbus", "cam-mask:1", "256", "--yes"], &["256", "0 to 255"]),
        (&["write", "interbus", "shift", "26", "--yes"], &["26", "0 to 25"]),
        (&["write", "interbus", "direction", "5", "--yes"], &["5", "3 to 4"]),
        (&["write", "interbus", "steps", "0", "--yes"], &["0 is not", "1 to 33554431"]),
        (&["write", "interbus", "preset", "-1", "--yes"], &["-1", "0 to 33554430"]),
    ];
    for (arguments, words) in cases {
        ask(&bench, &encoder, arguments).fails(1, words);
    }
    assert!(encoder.requests().is_empty());
    let cases: &[(&[&str], &[&str])] = &[
        (&["write", "interbus", "cam:2:5", "3600..10", "--yes"], &["Cam 5 of program 2", "start at 3600", "0 to 3599"]),
        (&["write", "interbus", "cam:2:5", "0..4000", "--yes"], &["stop at 4000", "0 to 3599"]),
        (&["write", "interbus", "steps", "8193", "--yes"], &["8193", "1 to 8192"]),
        (&["write", "interbus", "revolutions", "4097", "--yes"], &["4097", "1 to 4096"]),
        (&["write", "interbus", "preset", "3600", "--yes"], &["3600", "0 to 3599"]),
    ];
    for (arguments, words) in cases {
        ask(&bench, &encoder, arguments).fails(1, words);
    }
    let told = encoder.requests();
    assert!(told.iter().all(|line| !line.starts_with("STORE") && !line.starts_with("W 4")), "{told:?}");
}

/// The encoder rejects a value with an error word (reference 2) and is then returned to its mode.
#[test]
fn refusal_restores_mode() {
    let bench = Bench::new();
    for (word, words) in [
        ("82000000", "within the limits"),
        ("84000000", "does not support"),
        ("98000004", "outside the measuring range"),
    ] {
        let Some(encoder) = bench.gateway(&["--steps=3600", "--error", &format!("1:{word}")]) else { return };
        let ran = ask(&bench, &encoder, &["write", "interbus", "preset", "7", "--yes"]);
        ran.fails(1, &[&format!("0x{word}"), "0x08000007", words, "is running again"]);
        let last = encoder.requests().into_iter().rfind(|line| line.starts_with("W "));
        assert_eq!(last.as_deref(), Some("W 00000000"));
    }
}

#[test]
fn gateway_exceptions_name_settings() {
    let bench = Bench::new();
    for (code, words) in [("1", "illegal function"), ("2", "illegal data address"), ("0xB", "failed to respond")] {
        let Some(encoder) = bench.gateway(&["--exception", code]) else { return };
        ask(&bench, &encoder, &["identify", "interbus"]).fails(1, &["refused", "exception 0x0", words]);
    }
    let Some(encoder) = bench.gateway(&["--unit=5"]) else { return };
    ask(&bench, &encoder, &["identify", "interbus"]).fails(1, &["0x0B", "unit="]);
}

#[test]
fn swapped_words_suggest_word_order_setting() {
    let bench = Bench::new();
    for order in [["--order=low-first", "order=high-first"], ["--order=high-first", "order=low-first"]] {
        for (position, found) in [
            ("--position=4097", "plausible only with its words swapped"),
            ("--position=0", "Check output= and the word order (order=)"),
        ] {
            let Some(encoder) = bench.gateway(&[order[0], position]) else { return };
            let link = format!("{}?{}&handshake=300", encoder.url, order[1]);
            for command in [&["identify", "interbus"][..], &["read", "interbus", "steps"]] {
                let ran = bench.run(&[command, &["--link", &link]].concat());
                ran.fails(1, &[found, "order="]);
                assert!(ran.took.as_secs() < 12, "{ran:?}");
            }
            let told = encoder.requests();
            assert!(told.iter().all(|line| !line.starts_with("STORE")), "{told:?}");
        }
    }
}

#[test]
fn reports_second_master() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600", "--second-master", "20210000:1"]) else { return };
    let ran = ask(&bench, &encoder, &["write", "interbus", "preset", "7", "--yes"]);
    ran.fails(1, &["nother master"]);
    assert!(encoder.requests().iter().all(|line| !line.starts_with("STORE")));
}

#[test]
fn silent_gateway_times_out() {
    let bench = Bench::new();
    let Some(silent) = bench.gateway(&["--silent-after=4"]) else { return };
    let ran = ask(&bench, &silent, &["identify", "interbus"]);
    ran.fails(1, &["did not reply"]);
    assert!(ran.took.as_secs() < 12, "{ran:?}");
    let Some(gone) = bench.gateway(&["--vanish-after=4"]) else { return };
    let ran = ask(&bench, &gone, &["identify", "interbus"]);
    ran.fails(1, &[&gone.place]);
    let Some(noise) = bench.gateway(&["--garbage"]) else { return };
    let ran = ask(&bench, &noise, &["identify", "interbus"]);
    ran.fails(1, &["gateway"]);
    assert!(ran.took.as_secs() < 12, "{ran:?}");
    let file = bench.file("never.ron");
    let Some(silent) = bench.gateway(&["--silent-after=60"]) else { return };
    ask(&bench, &silent, &["save", "interbus", "-o", &file]).fails(1, &["did not reply"]);
    assert!(!bench.path("never.ron").exists());
}

#[test]
fn rejects_invalid_and_unrelated_profiles() {
    let bench = Bench::new();
    let parameters = r#"parameters: (steps: 3600, revolutions: 1, direction: "cw", preset: 0, zero_shift: 0)"#;
    let with = |programs: &str| {
        bench.write("p.ron", format!(r#"(schema: 1, device: "interbus", {parameters}, programs: [{programs}])"#))
    };
    let file = with("(program: 9, mask: 1)");
    bench
        .run(&["verify", &file, "--link", "sim:"])
        .fails(1, &["programs[0].program", "program 9 is outside the range 1 to 8"]);
    let file = with("(program: 1, mask: 1, cams: [(cam: 0, start: 3600, stop: 1)])");
    bench
        .run(&["restore", &file, "--link", "sim:?steps=3600&revolutions=1", "--yes"])
        .fails(1, &["start at 3600", "0 to 3599"]);
    let biss = concat!(env!("CARGO_MANIFEST_DIR"), "/profiles/biss/dynamic-filter.ron");
    let file = with("");
    bench.run(&["diff", &file, biss]).fails(1, &["biss", "interbus"]);
}

/// The shipped profiles are for INTERBUS encoders and can be restored to a virtual one.
#[test]
fn plans_ready_made_profiles() {
    let bench = Bench::new();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/profiles/interbus/");
    for (name, stores) in [("packaging-machine.ron", 3), ("scaled-encoder.ron", 1)] {
        let link = "sim:?steps=3600&revolutions=1&cams=demo";
        let told = bench.run(&["restore", &format!("{folder}{name}"), "--dry-run", "--link", link, "--json"]);
        assert_eq!(told.json()["write_cycles"].as_u64(), Some(stores), "{name}: {told:?}");
    }
}
