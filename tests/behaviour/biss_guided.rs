//! The procedures that need a turning motor, run without a terminal on an independently written encoder and on the
//! virtual one.

use std::time::Duration;

use serde_json::json;

use super::biss_profile::PROFILE;
use super::support::{Bench, Foreign, Ran, run_on_terminal};

fn ask(bench: &Bench, encoder: &Foreign, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", &encoder.url, "--json", "--yes"]].concat())
}

fn written(encoder: &Foreign) -> Vec<String> {
    encoder.registers_written().into_iter().filter(|line| !line.starts_with("0x40 ")).collect()
}

/// The register writes of a calibration (reference 5.1 and 5.2), including the return to operation and the password
/// reset.
const CALIBRATION: [&str; 6] = ["0x6B 2A", "0x6A 01", "0x00:0x00 01", "0x00:0x00 02", "0x6A 00", "0x6B 00"];

#[test]
fn calibration_runs_both_ways() {
    let bench = Bench::new();
    let turning = ["--rpm", "-500", "--reverse"];
    let (Some(kit), Some(adapter)) = (bench.kit(&turning), bench.adapter(&turning)) else { return };
    for encoder in [&kit, &adapter] {
        let ran = ask(&bench, encoder, &["do", "biss", "calibrate"]);
        assert!(ran.err.contains("to turn without this encoder"), "{ran:?}");
        let told = ran.json();
        let result = &told["results"][0];
        assert_eq!((&told["write_cycles"], &result["result"]), (&json!(1), &json!("calibrated")), "{told}");
        let (ccw, cw) = (&result["counterclockwise_rpm"], &result["clockwise_rpm"]);
        assert!((ccw.as_f64().unwrap() + 500.0).abs() < 10.0 && (cw.as_f64().unwrap() - 500.0).abs() < 10.0, "{told}");
        assert_eq!(written(encoder), CALIBRATION);
    }
}

#[test]
fn wiegand_test_saves_on_request() {
    let bench = Bench::new();
    let turning = ["--rpm", "600", "--reverse"];
    for save in [false, true] {
        let (Some(kit), Some(adapter)) = (bench.kit(&turning), bench.adapter(&turning)) else { return };
        for encoder in [&kit, &adapter] {
            let words = [&["do", "biss", "wiegand-test"][..], if save { &["save"] } else { &[] }].concat();
            let told = ask(&bench, encoder, &words).json();
            let result = &told["results"][0];
            assert_eq!((&result["ok"], &result["saved"]), (&json!(true), &json!(save)), "{told}");
            assert_eq!((&result["average_cw_v"], &result["lowest_ccw_v"]), (&json!(6.3), &json!(5.8)), "{told}");
            assert_eq!(told["write_cycles"], json!(u64::from(save)));
            let lines = written(encoder);
            assert_eq!(lines.contains(&"0x00:0x06 05".to_owned()), save, "{lines:?}");
            assert_eq!(lines[lines.len() - 2..], ["0x6A 00", "0x6B 00"], "{lines:?}");
        }
    }
}

#[test]
fn unsuitable_motor_reports_measured_values() {
    let bench = Bench::new();
    let cases: [(&[&str], &str, &[&str]); 5] = [
        (&["--rpm", "0"], "calibrate", &["at rest", "counterclockwise"]),
        (&["--rpm", "500"], "calibrate", &["clockwise"]),
        (&["--rpm", "-100"], "calibrate", &["100", "300", "700"]),
        (&["--rpm", "-500", "--temperature", "60"], "calibrate", &["60", "25", "40"]),
        (&["--rpm", "-600"], "wiegand-test", &["clockwise"]),
    ];
    for (arguments, action, words) in cases {
        let Some(encoder) = bench.kit(arguments) else { return };
        let ran = ask(&bench, &encoder, &["do", "biss", action, "--timeout", "2"]);
        assert_eq!((ran.status, ran.out.as_str()), (Some(1), ""), "{ran:?}");
        for word in words {
            assert!(ran.err.contains(word), "{word}: {ran:?}");
        }
        assert!(ran.took < Duration::from_secs(15), "{ran:?}");
        let lines = written(&encoder);
        assert!(lines.iter().all(|line| line.starts_with("0x6A 00") || line.starts_with("0x6B 00")), "{lines:?}");
    }
}

#[test]
fn dynamic_filter_prevents_calibration() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&["--rpm", "-500", "--filter", "4"]) else { return };
    let ran = ask(&bench, &encoder, &["do", "biss", "calibrate"]);
    assert!(ran.status == Some(1) && ran.err.contains("filter"), "{ran:?}");
    assert!(!written(&encoder).contains(&"0x00:0x00 01".to_owned()));
}

/// The encoder is returned to operation, but its calibration table is lost.
#[test]
fn failed_run_returns_to_operation() {
    let bench = Bench::new();
    let failing = ["--rpm", "-500", "--reverse", "--calibration-fails", "0x33"];
    let (Some(kit), Some(adapter)) = (bench.kit(&failing), bench.adapter(&failing)) else { return };
    for encoder in [&kit, &adapter] {
        let ran = ask(&bench, encoder, &["do", "biss", "calibrate"]);
        assert!(ran.status == Some(1) && ran.err.contains("lost"), "{ran:?}");
        assert_eq!(written(encoder), CALIBRATION);
    }
}

/// A mounting run covers temperature, calibration, Wiegand test, preset and data, in this order. The motor stands still
/// until the data have been read, and stops after the test.
#[test]
fn mounting_performs_all_steps() {
    let bench = Bench::new();
    let file = bench.write("p.ron", PROFILE);
    let turning = ["--rpm", "-600", "--reverse", "--stops", "--rests", "12"];
    let (Some(kit), Some(adapter)) = (bench.kit(&turning), bench.adapter(&turning)) else { return };
    let data = format!("data={file}");
    for encoder in [&kit, &adapter] {
        let parts = ["calibrate", "wiegand-test", "save", "preset=98304,7", &data];
        let told = ask(&bench, encoder, &[&["do", "biss", "mounting"], &parts[..]].concat()).json();
        let results: Vec<&str> =
            told["results"].as_array().unwrap().iter().map(|one| one["result"].as_str().unwrap()).collect();
        assert_eq!(results, ["calibrated", "tested", "preset stored", "preset", "stored"], "{told}");
        assert_eq!(told["write_cycles"], json!(5), "{told}");
        let link = ["--link", &encoder.url, "--json"];
        let place = bench.run(&[&["position", "biss"], &link[..]].concat()).json();
        assert_eq!((&place["turns"], &place["steps"]), (&json!(7), &json!(98_304)));
        let bytes = bench.run(&[&["read", "biss", "0x25:0x00+3"], &link[..]].concat()).json();
        assert_eq!(bytes["value"], json!("A1B2C3"));
        let state = bench.run(&[&["read", "biss", "0x6A+2"], &link[..]].concat()).json();
        assert_eq!(state["value"], json!("0000"), "operation, and no password");
    }
}

#[test]
fn invalid_mounting_steps_are_usage_errors() {
    let bench = Bench::new();
    for words in [&["spin"][..], &["preset=1,2,3"], &["preset=x"], &["preset"], &["data"]] {
        let command = [&["do", "biss", "mounting"], words, &["--yes", "--link", "sim:"]].concat();
        bench.run(&command).fails(2, &[]);
    }
    let data = format!("data={}", bench.file("none.ron"));
    bench.run(&["do", "biss", "mounting", &data, "--yes", "--link", "sim:"]).fails(1, &["none.ron"]);
    bench.run(&["do", "biss", "mounting", "preset=16777216", "--yes", "--link", "sim:"]).fails(1, &["16777215"]);
}

/// The virtual encoder turns 515 revolutions in each direction, which takes 15.5 s at 2000 rpm. A failed test must not
/// be reported as a success (issue 22.19): 5.2 V is below the required 5.3 V (reference 4).
#[test]
fn virtual_encoder_passes_guided_procedures() {
    let bench = Bench::new();
    let link = "sim:?rpm=-500&motor=reverse&calibration=0.2";
    let calibrated = bench.run(&["do", "biss", "calibrate", "--yes", "--json", "--link", link]).json();
    assert_eq!(calibrated["results"][0]["result"], json!("calibrated"));
    let link = "sim:?rpm=2000&motor=reverse&pulses=6.1,5.2&bridge=on";
    let command = ["do", "biss", "mounting", "wiegand-test", "save", "--yes", "--json", "--link", link];
    let ran = bench.run(&command);
    assert!(ran.err.contains("mounting failed"), "{ran:?}");
    let tested = ran.json_with_status(1);
    let result = &tested["results"][0];
    assert_eq!((&result["ok"], &result["lowest_cw_v"], &result["saved"]), (&json!(false), &json!(5.2), &json!(true)));
}

/// The first question asks what drives the motor. A motor controlled with this encoder is rejected.
#[test]
fn terminal_asks_for_motor_source() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&["--rpm", "-500", "--reverse"]) else { return };
    let command = ["do", "biss", "calibrate", "--link", &encoder.url];
    for (answers, words) in [
        ("2\n", "uses this encoder as feedback"),
        ("\n", "nothing was done"),
        ("1\nn\n", "nothing was written"),
        ("1\n\n", "calibration table is lost"),
    ] {
        let ran = run_on_terminal(&bench, &command, answers);
        assert_eq!(ran.status, Some(1), "{ran:?}");
        assert!(ran.out.contains("How is the motor driven?") && ran.out.contains(words), "{words}: {ran:?}");
        assert_eq!(written(&encoder), [""; 0]);
    }
    let ran = run_on_terminal(&bench, &command, "1\ny\n");
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert!(
        ran.out.contains("Turn the motor counterclockwise") && ran.out.contains("Turn the motor clockwise"),
        "{ran:?}"
    );
    assert_eq!(written(&encoder), CALIBRATION);
}
