//! Access codes other than the factory codes. They are requested by number, used if given, and never shown.

use serde_json::json;

use super::support::{Bench, Foreign, finish, frame};

const FIELDS: &str = r#"[{"status":"C8","bytes":"0815"},{"status":"E8","bytes":"0102"}]"#;

/// Starts an encoder whose field 1 is protected by access code 2, which is A7h.
fn run_guarded(bench: &Bench) -> Option<Foreign> {
    let encoder = bench.encoder(&["--fields", FIELDS])?;
    assert_eq!(encoder.host_address(&["40 4F 02 55 A7"]), [frame("40 4F 02")]);
    encoder.requests();
    Some(encoder)
}

#[test]
fn field_with_unknown_code_stays_locked() {
    let bench = Bench::new();
    let Some(encoder) = run_guarded(&bench) else { return };
    let file = bench.file("p.ron");
    let ran = bench.run(&["save", "hiperface", "--link", &encoder.url, "-o", &file, "--json"]);
    ran.json();
    assert!(ran.err.contains("field 1") && ran.err.contains("code 2"), "{ran:?}");
    let text = bench.read("p.ron");
    assert!(text.contains("0xE8") && text.contains("08 15") && !text.contains("01 02"), "{text}");

    let ran = bench.run(&["verify", &file, "--link", &encoder.url, "--json"]);
    assert_eq!(ran.json()["differences"], json!([]));
    assert!(ran.err.contains("code 2"), "what is not compared is named: {ran:?}");
    encoder.requests();
    let told = bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]).json();
    assert_eq!(told["written"], json!(0));
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn complete_save_fails_without_code() {
    let bench = Bench::new();
    let Some(encoder) = run_guarded(&bench) else { return };
    let file = bench.file("p.ron");
    let ran = bench.run(&["save", "hiperface", "--complete", "--link", &encoder.url, "-o", &file, "--json"]);
    ran.fails(1, &["field 1", "code 2"]);
    assert!(!bench.path("p.ron").exists());
}

#[test]
fn code_opens_field_and_stays_secret() {
    let bench = Bench::new();
    let Some(encoder) = run_guarded(&bench) else { return };
    let trace = bench.file("t.trace");
    let mut shown = String::new();
    let mut codes_in = |arguments: &[&str], environment: Option<&str>| {
        let mut command = bench.program(&[arguments, &["--link", &encoder.url, "--trace", &trace]].concat());
        command.envs(environment.map(|codes| ("ENCODER_STUDIO_CODES", codes)));
        let ran = finish(command);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        shown.push_str(&ran.out);
        shown.push_str(&ran.err);
        shown.push_str(&bench.read("t.trace"));
    };
    let file = bench.file("p.ron");
    codes_in(&["save", "hiperface", "--complete", "--code", "2=A7", "-o", &file], None);
    codes_in(&["read", "hiperface", "field:1"], Some("2=A7"));
    codes_in(&["read", "hiperface", "field:1", "--code", "2=a7"], Some("0=55, 2=11"));
    assert!(bench.read("p.ron").contains("01 02 FF"));
    encoder.requests();
    codes_in(&["write", "hiperface", "field:1@2", "AB", "--yes", "--json"], Some("2=A7"));
    assert_eq!(encoder.writes(), [frame("40 4B 01 02 01 A7 AB")]);
    codes_in(&["restore", &file, "--yes"], Some("2=A7"));
    codes_in(&["do", "hiperface", "change-code", "2", "B3", "--yes", "--json"], Some("2=A7"));
    codes_in(&["read", "hiperface", "field:1@0+2", "--code", "2=B3"], None);
    assert!(bench.read("t.trace").lines().any(|line| line.ends_with("> 40 4A 01 00 02 ** **")), "{shown}");

    // Profiles, backups, the logbook and traces contain neither the codes nor a checksum calculated from them.
    shown.push_str(&bench.all_text_files());
    let shown = bench.with_folder_removed(&shown).to_uppercase();
    for secret in ["A7", "B3"] {
        let found = shown.lines().find(|line| {
            line.split(|c: char| !c.is_ascii_hexdigit()).any(|word| word == secret || word == format!("0X{secret}"))
        });
        assert_eq!(found, None, "{secret}");
    }
    for request in ["40 4A 01 00 10 A7", "40 4B 01 02 01 A7 AB", "40 4F 02 A7 B3"] {
        let sum = frame(request).split(' ').next_back().unwrap().to_owned();
        let masked: Vec<&str> = shown.lines().filter(|line| line.contains('>') && line.ends_with(&sum)).collect();
        let guarded = masked.iter().filter(|line| [" 4A ", " 4B ", " 4F ", " 4D "].iter().any(|c| line.contains(c)));
        assert_eq!(guarded.count(), 0, "{masked:?}");
    }
}

#[test]
fn wrong_code_is_rejected_by_number() {
    let bench = Bench::new();
    let Some(encoder) = run_guarded(&bench) else { return };
    for arguments in [&["read", "hiperface", "field:1"][..], &["write", "hiperface", "field:1", "00", "--yes"]] {
        let ran = bench.run(&[arguments, &["--link", &encoder.url, "--code", "2=A8", "--json"]].concat());
        ran.fails(1, &["code 2"]);
        assert!(!ran.err.contains("A8"), "{ran:?}");
    }
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn invalid_code_is_not_echoed() {
    let bench = Bench::new();
    for wrong in ["5=A7", "2=A7A7", "2:A7", "A7"] {
        let ran = bench.run(&["identify", "hiperface", "--link", "sim:", "--code", wrong]);
        ran.fails(2, &["N=HEX"]);
        assert!(!ran.err.contains("A7"), "{ran:?}");
        let mut command = bench.program(&["identify", "hiperface", "--link", "sim:"]);
        command.env("ENCODER_STUDIO_CODES", wrong);
        let ran = finish(command);
        ran.fails(2, &["ENCODER_STUDIO_CODES"]);
        assert!(!ran.err.contains("A7"), "{ran:?}");
    }
}

#[test]
fn recording_does_not_reveal_code() {
    let bench = Bench::new();
    let Some(encoder) = run_guarded(&bench) else { return };
    let trace = bench.file("t.trace");
    bench.run(&["identify", "hiperface", "--link", &encoder.url, "--trace", &trace, "--json"]).json();
    bench.write("t.trace", bench.read("t.trace") + "1.0 > 40 4C 01 0D\n1.1 < 40 4C 01 E8 E5\n");
    let replay = format!("replay:{trace}");
    let ran = bench.run(&["read", "hiperface", "field:1@0+2", "--code", "2=A7", "--link", &replay, "--json"]);
    ran.fails(1, &["recording", "40 4A 01"]);
    let sum = frame("40 4A 01 00 02 A7").split_off(18);
    assert!(!bench.with_folder_removed(&ran.err).contains("A7") && !ran.err.contains(&format!(" {sum}")), "{ran:?}");
}
