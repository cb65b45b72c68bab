//! Commands without a real device: recordings, captured frames and the virtual encoder.

use serde_json::{Value, json};

use super::support::Bench;

#[test]
fn replays_recorded_replies() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C9","bytes":"0815"}]"#]) else { return };
    let trace = bench.file("t.trace");
    let replay = format!("replay:{trace}");
    let told = bench.run(&["identify", "hiperface", "--link", &encoder.url, "--trace", &trace, "--json"]).json();
    assert_eq!(bench.run(&["identify", "hiperface", "--link", &replay, "--json"]).json(), told);

    let (first, second) = (bench.file("first.ron"), bench.file("second.ron"));
    let save = ["save", "hiperface", "--link", &encoder.url, "--trace", &trace, "-o", &first];
    assert_eq!(bench.run(&save).status, Some(0));
    // A masked code matches any code.
    let text = bench.read("t.trace");
    assert!(text.lines().any(|line| line.ends_with("> 40 4A 00 00 20 ** **")), "{text}");
    for codes in [&[][..], &["--code", "0=12"]] {
        let ran = bench.run(&[&["save", "hiperface", "--link", &replay, "-o", &second], codes].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        assert_eq!(bench.run(&["diff", &first, &second, "--json"]).json()["equal"], json!(true));
    }
    let ran = bench.run(&["read", "hiperface", "analogue:0x48", "--link", &replay, "--json"]);
    ran.fails(1, &["t.trace", "40 44 48 4C"]);
}

#[test]
fn reports_unwritable_trace() {
    let bench = Bench::new();
    let trace = bench.file("none/t.trace");
    bench.run(&["identify", "hiperface", "--link", "sim:", "--trace", &trace, "--json"]).fails(1, &["none/t.trace"]);
}

#[test]
fn explains_example_frames() {
    let bench = Bench::new();
    let cases = [
        ("40420E0531", None),
        ("40 42 00 0E 05 31 38", Some("918833")),
        ("40 42 02", Some("position")),
        ("404D00C95591", Some("32 bytes")),
        ("40 52 E4 22 80 01 55", Some("9600")),
        ("40 4E 08 00 06", Some("128")),
        ("40 50 1D 0D", Some("1Dh")),
        ("40 D0 1E 8E", Some("1Eh")),
        ("404D01E05569", None),
        ("40 42 03", None),
    ];
    for (bytes, word) in cases {
        let words: Vec<&str> = bytes.split(' ').collect();
        let ran = bench.run(&[&["decode", "hiperface"], &words[..]].concat());
        match word {
            Some(word) => {
                assert_eq!(ran.status, Some(0), "{ran:?}");
                assert!(ran.out.to_lowercase().contains(&word.to_lowercase()), "{word}: {ran:?}");
            }
            None => {
                assert_eq!(ran.status, Some(1), "{bytes}: {ran:?}");
                ran.assert_stderr(&["checksum"]);
            }
        }
    }
    bench.run(&["decode", "hiperface", "4G"]).fails(2, &["4G"]);
    bench.run(&["decode", "hiperface"]).fails(2, &[]);
}

#[test]
fn captured_access_code_is_not_printed() {
    let bench = Bench::new();
    // The example of the manual writes 08 15 to field 1 at address 5. Decoding repeats the input and adds nothing.
    let told = bench.run(&["decode", "hiperface", "40 4B 01 05 02 66 08 15 76", "--json"]).json();
    let meaning = told["frames"][0]["meaning"].to_string();
    assert!(meaning.contains("08 15") || meaning.contains("0815"), "{told}");
    assert!(!meaning.contains("66"), "{told}");
}

#[test]
fn virtual_encoder_needs_no_hardware() {
    let bench = Bench::new();
    let told = bench.run(&["identify", "hiperface", "--link", "sim:", "--json"]).json();
    assert_eq!((&told["address"], &told["baud"], &told["parity"]), (&json!(0x40), &json!(9600), &json!("even")));
    assert!(told["free_bytes"].as_u64() >= Some(32), "{told}");
    let linear = bench.run(&["position", "hiperface", "--link", "sim:?model=lincoder", "--json"]);
    if linear.status == Some(0) {
        let line = linear.json();
        assert_eq!((&line["turns"], &line["degrees"]), (&Value::Null, &Value::Null));
        assert!(line["millimetres"].is_number(), "{line}");
    }
}
