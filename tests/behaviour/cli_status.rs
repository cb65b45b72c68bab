//! Status codes: reading the whole queue, and codes that affect a value.

use serde_json::{Value, json};

use super::support::{Bench, Foreign, Ran};

fn numbers(list: &Value) -> Vec<u64> {
    list.as_array().unwrap().iter().map(|entry| entry["code"].as_u64().unwrap()).collect()
}

fn position(bench: &Bench, codes: &str) -> Option<(Ran, Value)> {
    let encoder = bench.encoder(&["--status", codes])?.with_long_reply_margin();
    let ran = bench.run(&["position", "hiperface", "--link", &encoder.url, "--json"]);
    let line = ran.json();
    Some((ran, line))
}

/// Reading status codes removes them from the encoder, so `status` records them in the logbook (issue 22.10).
#[test]
fn logbook_keeps_status_codes() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--status", "1E"]).map(Foreign::with_long_reply_margin) else { return };
    assert_eq!(bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]).status, Some(0));
    let entry = bench.run(&["log", "--json", "--device", "hiperface", "--limit", "1"]).json();
    assert_eq!((&entry["what"], &entry["virtual"]), (&json!("status"), &json!(false)));
    assert_eq!(entry["text"], json!("1Eh critical encoder temperature"));
}

#[test]
fn status_reads_entire_queue() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--status", "1E080120"]).map(Foreign::with_long_reply_margin) else { return };
    let told = bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]).json();
    assert_eq!(told["ok"], json!(false));
    assert_eq!(numbers(&told["errors"]), [0x01, 0x20]);
    assert_eq!(numbers(&told["warnings"]), [0x1E, 0x08]);
    for entry in told["errors"].as_array().unwrap().iter().chain(told["warnings"].as_array().unwrap()) {
        assert!(entry["text"].as_str().is_some_and(|text| !text.is_empty()), "{entry}");
    }
    // The queue of status codes is empty now.
    let told = bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]).json();
    assert_eq!(told, json!({"ok": true, "errors": [], "warnings": []}));
}

/// Request 50h removes a code from the encoder, so repeating it would lose a code. A reply is therefore accepted even
/// if it takes ten times as long as allowed (17.6 ms, reference 4, issue 22.10).
#[test]
fn keeps_codes_in_late_replies() {
    let bench = Bench::new();
    for milliseconds in [120, 180, 250, 400] {
        let late = format!("{milliseconds}:10");
        let Some(encoder) = bench.encoder(&["--status", "1E080120", "--late-status", &late]) else { return };
        let ran = bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]);
        let told = ran.json();
        assert_eq!(numbers(&told["errors"]), [0x01, 0x20], "{milliseconds} ms: {ran:?}");
        assert_eq!(numbers(&told["warnings"]), [0x1E, 0x08], "{milliseconds} ms: {ran:?}");
    }
}

/// The reply to 50h is replaced with other data, including a repeated old reply (issue 22.10).
#[test]
fn reports_each_code_once_unless_lost() {
    let bench = Bench::new();
    let spoilt = [
        "good,the-last",
        "twice,lost",
        "twice,good,twice",
        "twice-apart,good,lost",
        "good,cut,behind-the-last",
        "lost,good,the-last,the-last",
    ];
    for replies in spoilt {
        let Some(encoder) = bench.encoder(&["--status", "1E080120", "--status-replies", replies]) else { return };
        let ran = bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]);
        let told = ran.json();
        let given = [numbers(&told["errors"]), numbers(&told["warnings"])].concat();
        let once: std::collections::BTreeSet<u64> = given.iter().copied().collect();
        assert_eq!(once.len(), given.len(), "{replies}: {ran:?}");
        let said = ran
            .err
            .split("(read encoder status): ")
            .nth(1)
            .map_or(0, |rest| rest.split(['.', ' ']).next().and_then(|count| count.parse().ok()).unwrap_or(0));
        assert!(4 - given.len() <= said, "{replies}: {said} said to be lost of {ran:?}");
    }
}

/// A device server sends a reply twice (issue 22.10).
#[test]
fn duplicate_reply_loses_no_code() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--status", "1E080120", "--status-replies", "twice,twice,twice,twice"]) else {
        return;
    };
    let ran = bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]);
    let told = ran.json();
    assert_eq!((numbers(&told["errors"]), numbers(&told["warnings"])), (vec![0x01, 0x20], vec![0x1E, 0x08]), "{ran:?}");
    assert!(!ran.err.contains("Lost or damaged"), "{ran:?}");
}

#[test]
fn warnings_alone_are_ok() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--status", "1C1D1E08"]).map(Foreign::with_long_reply_margin) else { return };
    let told = bench.run(&["status", "hiperface", "--link", &encoder.url, "--json"]).json();
    assert_eq!((&told["ok"], &told["errors"]), (&json!(true), &json!([])));
    assert_eq!(numbers(&told["warnings"]), [0x1C, 0x1D, 0x1E, 0x08]);
}

#[test]
fn warning_keeps_position_valid() {
    let bench = Bench::new();
    for codes in ["1E08", "090F"] {
        let Some((ran, line)) = position(&bench, codes) else { return };
        assert_eq!((&line["valid"], &line["raw"]), (&json!(true), &json!(918_833)), "{codes}");
        for code in [&codes[..2], &codes[2..]] {
            assert!(ran.err.contains(&format!("{code}h")), "{ran:?}");
        }
    }
}

#[test]
fn position_code_invalidates_position() {
    let bench = Bench::new();
    for code in ["01", "06", "1F", "20", "1E23"] {
        let Some((ran, line)) = position(&bench, code) else { return };
        assert_eq!((&line["valid"], &line["raw"]), (&json!(false), &json!(918_833)), "{code}");
        assert!(ran.err.contains(&format!("{}h", &code[code.len() - 2..])), "{ran:?}");
    }
}

#[test]
fn read_prints_value_despite_codes() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--status", "1D06"]).map(Foreign::with_long_reply_margin) else { return };
    let ran = bench.run(&["read", "hiperface", "counter", "--link", &encoder.url, "--json"]);
    assert_eq!(ran.json()["value"], json!(0));
    assert!(ran.err.contains("1Dh") && ran.err.contains("06h"), "{ran:?}");
}

#[test]
fn check_prints_verdict_per_line() {
    let bench = Bench::new();
    let check = ["do", "hiperface", "check", "--link"];
    let good = bench.run(&[&check[..], &["sim:", "--json"]].concat()).json();
    let steps = json!([
        {"step": "status", "verdict": "good", "findings": []},
        {"step": "identity", "verdict": "good", "findings": ["SKM36", "GB0450179"]},
        {"step": "position", "verdict": "good", "findings": ["turn 224, 116.807°"]},
        {"step": "data fields", "verdict": "good", "findings": ["0: 32 bytes, writable, code 0, code required"]},
    ]);
    assert_eq!((&good["ok"], &good["steps"]), (&json!(true), &steps));
    // The keys are those that CLI.md names (issue 22.11).
    let lines = json!([
        {"name": "status", "verdict": "good", "text": ""},
        {"name": "identity", "verdict": "good", "text": "SKM36; GB0450179"},
        {"name": "position", "verdict": "good", "text": "turn 224, 116.807°"},
        {"name": "data fields", "verdict": "good", "text": "0: 32 bytes, writable, code 0, code required"},
    ]);
    assert_eq!(good["lines"], lines);
    let hot = bench.run(&[&check[..], &["sim:?temperature=200", "--json"]].concat()).json();
    assert_eq!((&hot["lines"][0]["name"], &hot["lines"][0]["verdict"]), (&json!("status"), &json!("warning")));
    // The output includes the quality of the line (issue 22.11).
    let quality = &good["line_quality"];
    assert!(quality["requests"].as_u64().is_some_and(|count| count > 5), "{quality}");
    assert_eq!(quality["requests"], quality["replies"]);
    for key in ["retries", "damaged", "silent", "late"] {
        assert_eq!(quality[key], json!(0), "{key}");
    }
    let milliseconds = |key: &str| quality[key].as_f64().unwrap();
    assert!(milliseconds("answer_ms_median") > 0.0);
    assert!(milliseconds("answer_ms_median") <= milliseconds("answer_ms_p99"));
    let locked = bench.run(&[&check[..], &["sim:?type=0x11&codes=0:11"]].concat());
    let lines: Vec<&str> = locked.out.lines().collect();
    assert_eq!(
        lines,
        [
            "status       good",
            "identity     attention  unknown type; GB0450179",
            "position     good       918833",
            "data fields  attention  0: 32 bytes, writable, code 0, code required, access code 0 is unknown",
        ]
    );
}
