//! Encoders on the serial line of an independent adapter: reading, writing, supply, and adapter faults.

use serde_json::json;

use super::support::Bench;

/// One data field: 32 writable bytes, protected by access code 0.
const FIELDS: &str = r#"[{"status":"C9","bytes":"0815"}]"#;

#[test]
fn reads_and_writes_encoder_behind_adapter() {
    let bench = Bench::new();
    let Some(adapter) = bench.serial_adapter(&["--fields", FIELDS]) else { return };
    let run = |words: &[&str]| bench.run(&[words, &["--link", &adapter.url, "--json"]].concat()).json();
    let told = run(&["identify", "hiperface"]);
    assert_eq!((&told["serial_number"], &told["encoder_name"]), (&json!("GB0450179"), &json!("SKM36")));
    // 9600 baud and even parity are set before the first frame.
    assert_eq!(adapter.requests().first().map(String::as_str), Some("F 9600 2"));
    // An SKM36 at position 000E0531h is at turn E0h, step 1329 of 4096.
    let read = run(&["position", "hiperface"]);
    assert_eq!((&read["raw"], &read["turns"], &read["steps"]), (&json!(918_833), &json!(224), &json!(1329)));
    adapter.requests();
    let written = run(&["write", "hiperface", "field:0@1", "AB", "--yes"]);
    assert_eq!((&written["written"], &written["verified"]), (&json!(1), &json!(1)), "{written}");
    assert_eq!(run(&["read", "hiperface", "field:0@0+3"])["value"], json!("08ABFF"));
    let stores = adapter.requests().iter().filter(|line| line.starts_with("40 4B")).count();
    assert_eq!(stores, 1, "a store is never repeated without a check");
}

/// The encoder has executed the store, but its reply is lost. The host reads the byte back and does not store it again.
#[test]
fn lost_store_reply_is_not_retried() {
    let bench = Bench::new();
    let Some(adapter) = bench.serial_adapter(&["--fields", FIELDS, "--lose-command", "4B"]) else { return };
    let run = |words: &[&str]| bench.run(&[words, &["--link", &adapter.url, "--json"]].concat());
    let written = run(&["write", "hiperface", "field:0@1", "AB", "--yes"]);
    let stores = adapter.requests().iter().filter(|line| line.starts_with("40 4B")).count();
    assert_eq!(stores, 1, "{written:?}");
    assert_eq!(written.json()["verified"], json!(1), "{written:?}");
    assert_eq!(run(&["read", "hiperface", "field:0@0+3"]).json()["value"], json!("08ABFF"));
}

/// In transfer 2, the request reaches the encoder, but the reply does not reach the host.
#[test]
fn lost_reply_is_requested_again() {
    let bench = Bench::new();
    let Some(adapter) = bench.serial_adapter(&["--lose", "2"]) else { return };
    let told = bench.run(&["identify", "hiperface", "--link", &adapter.url, "--json"]).json();
    assert_eq!(told["serial_number"], json!("GB0450179"));
}

#[test]
fn supply_is_switched_on_and_restored() {
    let bench = Bench::new();
    let Some(adapter) = bench.serial_adapter(&["--supply", "off"]) else { return };
    let position = |parameters: &str| {
        bench.run(&["position", "hiperface", "--json", "--link", &format!("{}{parameters}", adapter.url)])
    };
    let supplied = || -> Vec<String> { adapter.requests().into_iter().filter(|line| line.starts_with("S ")).collect() };
    assert_eq!(position("?voltage=8").json()["raw"], json!(918_833));
    assert_eq!(supplied(), ["S 8000", "S off"]);
    assert_eq!(position("?voltage=8&leave-supply=on").json()["raw"], json!(918_833));
    assert_eq!(supplied(), ["S 8000"]);
    // The manual's technical data allow 7 to 12 V.
    position("?voltage=5").fails(2, &["voltage=5", "7 to 12"]);
    position("?voltage=24").fails(2, &["voltage=24", "7 to 12"]);
    assert!(supplied().is_empty(), "nothing is sent");
}

#[test]
fn silence_names_encoder_or_adapter() {
    let bench = Bench::new();
    let Some(adapter) = bench.serial_adapter(&[]) else { return };
    let wrong_address = format!("{}?address=0x45", adapter.url);
    bench.run(&["identify", "hiperface", "--link", &wrong_address]).fails(1, &["address 45h", "type label"]);
    let Some(dead) = bench.serial_adapter(&["--dead-from", "2"]) else { return };
    bench.run(&["identify", "hiperface", "--link", &dead.url]).fails(1, &["the adapter does not answer"]);
    // The adapter for BiSS and SSI has no serial line.
    let Some(other) = bench.adapter(&[]) else { return };
    bench.run(&["identify", "hiperface", "--link", &other.url]).fails(1, &["bench adapter", "no serial line"]);
}

/// Register 66h contains 80, which is 30 °C (BiSS reference 2).
#[test]
fn reads_and_writes_configuration_pin_behind_adapter() {
    let bench = Bench::new();
    let Some(adapter) = bench.serial_adapter(&["--pin", "--supply", "off"]) else { return };
    let link = format!("{}?pin=on&voltage=5", adapter.url);
    let run = |words: &[&str]| bench.run(&[words, &["--link", &link, "--json"]].concat()).json();
    assert_eq!(run(&["read", "biss", "0x66"])["value"], json!(80));
    let seen = adapter.requests();
    assert!(seen.contains(&"F 115200 0".to_owned()), "{seen:?}");
    assert_eq!(seen.iter().filter(|line| line.starts_with("S ")).collect::<Vec<_>>(), ["S 5000", "S off"]);
    let identity = run(&["identify", "biss"]);
    assert_eq!(identity["serial_number"], json!("12345678"), "{identity}");
    bench
        .run(&["read", "biss", "0x66", "--link", &format!("{}?pin=on&clock=1000000", adapter.url)])
        .fails(2, &["clock"]);
    bench
        .run(&["read", "biss", "0x66", "--link", &format!("{}?pin=on&voltage=24", adapter.url)])
        .fails(2, &["voltage=24"]);
    // The adapter waits at most two seconds for a reply.
    bench
        .run(&["read", "biss", "0x66", "--link", &format!("{}?pin=on&timeout=2001", adapter.url)])
        .fails(2, &["timeout=2001", "1 to 2000"]);
}
