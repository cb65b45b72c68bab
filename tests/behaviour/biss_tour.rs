//! The tour in the README: commands that read and change a virtual kit encoder and then restore its original content.

use serde_json::json;

use super::support::{Bench, Simulated};

#[test]
fn reads_saves_compares_and_restores() {
    let bench = Bench::new();
    let simulated = Simulated::start(&bench, &["biss", "--listen", "127.0.0.1:0"]);
    let link = format!("--link=tcp:{}", simulated.place);
    let run = |words: &[&str]| bench.run(&[words, &[&link, "--json"]].concat());
    let file = bench.file("kit.ron");

    let identity = run(&["identify", "biss"]).json();
    assert_eq!((&identity["firmware"], &identity["profile_id"]), (&json!("1.6.0"), &json!("6129")));
    let saved = run(&["save", "biss", "-o", &file]).json();
    assert_eq!(saved["banks"], json!(64));
    let written = run(&["write", "biss", "0x24:0x10+4", "C0FFEE01", "--yes"]).json();
    assert_eq!((&written["written"], &written["write_cycles"]), (&json!(4), &json!(1)));

    let differences = json!([{"item": "0x24:0x10+4", "left": "00000000", "right": "C0FFEE01"}]);
    let told = run(&["diff", &file]).json_with_status(3);
    assert_eq!((&told["differences"], &told["missing"]), (&differences, &json!([])));
    let dry = run(&["restore", &file, "--dry-run"]).json();
    assert_eq!((&dry["operations"][0]["new"], &dry["write_cycles"]), (&json!("00000000"), &json!(1)));
    let restored = run(&["restore", &file, "--yes"]).json();
    assert_eq!((&restored["written"], &restored["verified"]), (&json!(4), &json!(4)));
    assert_eq!(run(&["verify", &file]).json()["equal"], json!(true));

    run(&["do", "biss", "preset", "98304", "0", "--yes"]).json();
    let place = run(&["position", "biss"]).json();
    assert_eq!((&place["turns"], &place["degrees"]), (&json!(0), &json!(270.0)));
    simulated.end("INT");
}
