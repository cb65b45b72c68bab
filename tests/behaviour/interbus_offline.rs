//! INTERBUS commands without a device: decoding words of the process data.

use serde_json::{Value, json};

use super::support::Bench;

/// The expected values come from interbus.md 5, 6.3 and 7.
#[test]
fn explains_example_words() {
    let bench = Bench::new();
    let cases: [(&[&str], &[&str]); 27] = [
        (&["020000FF", "--direction", "out"], &["position or parameterisation mode: set steps to 255"]),
        (&["0x06000004", "--direction", "out"], &["set direction to 4, counterclockwise"]),
        (&["04001001", "--direction", "out"], &["4097", "warning: beyond 1 to 4096"]),
        (&["0E000000", "--direction", "out"], &["default", "appendix"]),
        (&["40000000"], &["OUT in position mode: set preset", "OUT in cam mode: cam 0 starts at 0"]),
        (&["60000000"], &["OUT in position mode: FRABA preset", "OUT in cam mode: cam 0 stops at 0"]),
        (&["20400001"], &["velocity start", "OUT in cam mode: activation mask 0x0001: cam 0"]),
        (&["20400093", "--mode", "cam", "--direction", "out"], &["cams 0, 1, 4, 7"]),
        (&["2021005D", "--direction", "out"], &["register 5 of the chip"]),
        (
            &["20800001", "46000015", "66000213", "20400008", "80000000", "--mode", "cam", "--direction", "out"],
            &["program 1", "cam 3 starts at 21", "cam 3 stops at 531", "mask 0x0008: cam 3", "run"],
        ),
        (&["00123456", "--direction", "in", "--mode", "position"], &["IN in position mode: position 1193046"]),
        (&["02123456", "--direction", "in", "--mode", "position"], &["position 1193046", "0x1 in bits 30 to 25"]),
        (&["00000BB8", "--direction", "in", "--mode", "velocity"], &["speed 3000 rpm"]),
        (&["C20000FF", "--direction", "in"], &["echo of \"set steps to 255\"", "echo of \"cam 1 starts at 255\""]),
        (&["C0000000", "--direction", "in", "--mode", "parameterisation"], &["busy"]),
        (&["E2000001", "--direction", "in", "--mode", "parameterisation"], &["code 1, manufacturer bit, data 1"]),
        (&["82000000"], &["wrong parameter data"]),
        (&["84000000"], &["unknown parameter code"]),
        (&["86000000"], &["parameters lost"]),
        (&["A4000000"], &["unknown parameter in a read-out"]),
        (&["A0000FA0"], &["read-out value 4000", "--read-out"]),
        (&["A00000FD", "--read-out", "temperature"], &["temperature 25.3 °C"]),
        (&["A1FFFF9C", "A000FF9C", "--read-out", "0xC"], &["temperature -10.0 °C"]),
        (&["A00003E8", "--read-out", "operating-time"], &["operating time 10000 min"]),
        (&["98000004"], &["cam beyond the measuring range"]),
        (&["01CDEF20", "--mode", "cam", "--shift", "0"], &["cam 5 on", "position 0x001CDEF in the bits 0x001FFFF"]),
        (&["0FFF"], &["position 4095 of a K1 encoder"]),
    ];
    for (arguments, words) in cases {
        let ran = bench.run(&[&["decode", "interbus"], arguments].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        for word in words {
            assert!(ran.out.contains(word), "{word}: {ran:?}");
        }
    }
}

#[test]
fn json_has_every_reading() {
    let bench = Bench::new();
    let told = bench.run(&["decode", "interbus", "--json", "46000015", "9800000F"]).json();
    let frames = told["frames"].as_array().unwrap();
    assert_eq!((&frames[0]["bytes"], &frames[0]["valid"]), (&json!("46000015"), &json!(true)));
    let start =
        json!({"direction": "out", "modes": ["cam"], "meaning": "cam 3 starts at 21", "value": 21, "legal": true});
    assert_eq!(frames[0]["readings"][0], start);
    let position = json!(["position", "parameterisation", "read-out"]);
    assert_eq!((&frames[0]["readings"][1]["modes"], &frames[0]["readings"][1]["value"]), (&position, &json!(21)));
    // A word that has this meaning in every mode lists no modes.
    assert_eq!(
        (&frames[1]["readings"][0]["direction"], &frames[1]["readings"][0]["modes"]),
        (&json!("in"), &json!([]))
    );
    assert_eq!(frames[1]["meaning"].as_array().map(Vec::len), Some(1));
}

#[test]
fn rejects_illegal_and_invalid_words() {
    let bench = Bench::new();
    let out = |mode, word| ["decode", "interbus", "--direction", "out", "--mode", mode, word];
    for (mode, word, words) in [
        ("position", "46000015", &["46000015", "not legal in position mode", "cam 3 starts at 21", "for cam mode"][..]),
        ("velocity", "020000FF", &["not legal in velocity mode", "set steps to 255", "position or parameterisation"]),
        ("parameterisation", "40000000", &["not legal in parameterisation mode", "set preset"]),
        ("cam", "0C000001", &["0C000001", "any mode"]),
    ] {
        bench.run(&out(mode, word)).fails(1, words);
    }
    // If the direction is not given, the word may also come from the encoder.
    let told = bench.run(&["decode", "interbus", "46000015", "--mode", "position", "--json"]).json();
    let readings = told["frames"][0]["readings"].as_array().unwrap();
    let legal: Vec<&Value> = readings.iter().map(|reading| &reading["legal"]).collect();
    assert_eq!(legal, [&json!(false), &json!(true)], "{told}");
    // Valid words are printed even if the same command contains invalid ones.
    let mixed =
        bench.run(&["decode", "interbus", "--direction", "out", "80000000", "10000000", "--json"]).json_with_status(1);
    let valid: Vec<&Value> = mixed["frames"].as_array().unwrap().iter().map(|frame| &frame["valid"]).collect();
    assert_eq!(valid, [&json!(true), &json!(false)]);
    let cases: [(&[&str], &[&str]); 8] = [
        (&["123"], &["\"123\"", "8 hexadecimal digits", "020000FF"]),
        (&["0200 00FF"], &["8 hexadecimal digits"]),
        (&["+20000FF"], &["\"+20000FF\""]),
        (&["0200GGFF"], &["\"0200GGFF\""]),
        (&["A0000001", "--read-out", "warmth"], &["warmth", "temperature", "operating-time"]),
        (&["0FFF", "--direction", "out"], &["0FFF", "K1"]),
        (&["01CDEF20", "--shift", "26"], &["26", "0..=25"]),
        (&["01CDEF20", "--mode", "cams"], &["cams"]),
    ];
    for (arguments, words) in cases {
        bench.run(&[&["decode", "interbus"], arguments].concat()).fails(2, words);
    }
    bench.run(&["decode", "biss", "--mode", "cam", "024698000CF"]).fails(2, &["--mode", "interbus"]);
}
