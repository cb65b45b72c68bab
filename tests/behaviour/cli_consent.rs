//! Consent to writes, and the extra permission for values that depend on the mounting.

use serde_json::json;

use super::support::{Bench, frame, python, run_on_terminal};

#[test]
fn terminal_writes_only_after_yes() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C8","bytes":"0815"}]"#]) else { return };
    if python("master.py").is_none() {
        return;
    }
    // On a terminal, the program also asks about a drive, unless an option has answered that question (issue 22.30).
    let arguments = ["write", "hiperface", "field:0@1", "16", "--only-master", "--link", &encoder.url];
    for no in ["n\n", "\n", "what?\n"] {
        let ran = run_on_terminal(&bench, &arguments, no);
        assert_eq!(ran.status, Some(1), "{ran:?}");
        for words in ["field:0@1+1", "15", "16", "nothing was written"] {
            assert!(ran.out.contains(words), "{words}: {ran:?}");
        }
        assert_eq!(encoder.writes(), [""; 0]);
    }
    let ran = run_on_terminal(&bench, &arguments, "y\n");
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert_eq!(encoder.writes(), [frame("40 4B 00 01 01 55 16")]);
}

/// Before the first byte is sent on a terminal, the user must confirm that no drive is on the line (issue 22.30).
#[test]
fn terminal_asks_about_drive_on_line() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    if python("master.py").is_none() {
        return;
    }
    let arguments = ["identify", "hiperface", "--link", &encoder.url];
    for reply in ["yes\n", "y\n", "not sure\n", "\n"] {
        let ran = run_on_terminal(&bench, &arguments, reply);
        assert_eq!(ran.status, Some(1), "{ran:?}");
        assert!(
            ran.out.contains("Is a drive or controller connected") && ran.out.contains("Nothing was sent"),
            "{ran:?}"
        );
        assert_eq!(encoder.requests(), [""; 0], "{reply:?}");
    }
    let ran = run_on_terminal(&bench, &arguments, "no\n");
    assert!(ran.status == Some(0) && ran.out.contains("serial number"), "{ran:?}");
}

#[test]
fn mounting_values_are_not_copied_by_default() {
    let bench = Bench::new();
    // The field has a commutation offset as this program stores it, followed by other bytes.
    let fields = format!(r#"[{{"status":"C9","bytes":"434F31{}0815"}}]"#, "00".repeat(13));
    let Some(source) = bench.encoder(&["--fields", &fields]) else { return };
    let other = ["--serial", "XX0000001", "--fields", r#"[{"status":"C9"}]"#];
    let Some(encoder) = bench.encoder(&other) else { return };
    let file = bench.file("p.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", &source.url, "-o", &file]).status, Some(0));
    assert!(bench.read("p.ron").contains("field:0@0+16"));

    // The meaning of two bytes is unknown, so the restore asks about them (issue 22.8).
    let restore = ["restore", &file, "--yes", "--allow-other-device", "--link", &encoder.url, "--json"];
    bench.run(&restore).fails(1, &["Data field 0", "--copy", "--leave"]);
    let dry = bench.run(&[&restore[..], &["--dry-run"]].concat());
    assert_eq!(dry.json()["operations"], json!([]), "{dry:?}");
    assert!(dry.err.contains("2 bytes differ, and their meaning is unknown"), "{dry:?}");
    let left = bench.run(&[&restore[..], &["--leave", "field:0"]].concat()).json();
    assert_eq!((&left["written"], &left["redo"]), (&json!(0), &json!([])));
    bench.run(&[&restore[..], &["--leave", "field:0", "--copy", "field:0"]].concat()).fails(2, &["field:0"]);
    assert_eq!(encoder.writes(), [""; 0]);
    let restore = [&restore[..], &["--copy", "field:0"]].concat();
    let ran = bench.run(&restore);
    assert_eq!((&ran.json()["written"], &ran.json()["redo"]), (&json!(2), &json!(["commutation"])));
    assert!(ran.err.contains("field:0@0+16") && ran.err.contains("--with-mounting"), "{ran:?}");
    assert_eq!(encoder.writes(), [frame("40 4B 00 10 02 55 08 15")]);
    // Even with both permissions, the values that must be adjusted again are reported (issue 22.7).
    let ran = bench.run(&[&restore[..], &["--with-mounting"]].concat());
    assert_eq!(ran.json()["written"], json!(16));
    assert_eq!(ran.json()["redo"], json!(["commutation", "field:0@0+16"]));
    assert!(
        ran.err.contains("must be set up again before you run the machine") && ran.err.contains("field:0@0+16"),
        "{ran:?}"
    );
    assert_eq!(bench.run(&["verify", &file, "--link", &encoder.url, "--json"]).json()["equal"], json!(true));
    // If the profile is restored onto its own encoder, no value is left out.
    source.host_address(&["40 4B 00 00 01 55 00"]);
    let own = bench.run(&["restore", &file, "--yes", "--link", &source.url, "--json"]).json();
    assert_eq!(own["written"], json!(1));
}

#[test]
fn two_quick_writes_keep_two_backups() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C8"}]"#]) else { return };
    let backups = ["00", "01", "02"].map(|byte| {
        let arguments = ["write", "hiperface", "field:0@0+1", byte, "--yes", "--link", &encoder.url, "--json"];
        bench.run(&arguments).json()["backup"].as_str().unwrap().to_owned()
    });
    let first = ["FF", "00", "01"];
    for (backup, byte) in backups.iter().zip(first) {
        let text = std::fs::read_to_string(backup).unwrap();
        assert!(text.contains(&format!("\"{byte} FF")), "{backup}: {text}");
    }
}

/// On a terminal, an existing file is replaced only after confirmation. Without a terminal it is replaced, and a
/// message is printed (issue 22.28).
#[test]
fn terminal_asks_before_replacing_file() {
    let bench = Bench::new();
    let file = bench.file("layout.ron");
    let save = ["save", "ssi", "--layout", "ahm36", "-o", file.as_str()];
    let ran = bench.run(&save);
    assert_eq!((ran.status, ran.err.as_str()), (Some(0), ""), "a new file");
    let written = bench.read("layout.ron");

    std::fs::write(&file, "dear").unwrap();
    let ran = bench.run(&save);
    assert_eq!(ran.status, Some(0));
    assert!(ran.err.contains("layout.ron already existed and was replaced"), "{ran:?}");
    assert_eq!(bench.read("layout.ron"), written);

    std::fs::write(&file, "dear").unwrap();
    let ran = bench.run(&[&save[..], &["--force"]].concat());
    assert_eq!((ran.status, ran.err.as_str()), (Some(0), ""));
    assert_eq!(bench.read("layout.ron"), written);
    if python("master.py").is_none() {
        return;
    }
    std::fs::write(&file, "dear").unwrap();
    for no in ["n\n", "\n"] {
        let ran = run_on_terminal(&bench, &save, no);
        assert_eq!(ran.status, Some(1), "{ran:?}");
        assert!(ran.out.contains("already exists") && ran.out.contains("was not changed"), "{ran:?}");
        assert_eq!(bench.read("layout.ron"), "dear");
    }
    assert_eq!(run_on_terminal(&bench, &save, "y\n").status, Some(0));
    assert_eq!(bench.read("layout.ron"), written);
    // If an option already gives the answer, the program does not ask.
    std::fs::write(&file, "dear").unwrap();
    assert_eq!(run_on_terminal(&bench, &[&save[..], &["--force"]].concat(), "").status, Some(0));
    assert_eq!(bench.read("layout.ron"), written);
}

/// If the logbook's write cycles cannot be read, a write to any kind of device is rejected before the user is asked for
/// consent (issue 22.4).
#[test]
fn unknown_wear_is_rejected_without_prompt() {
    if python("master.py").is_none() {
        return;
    }
    let bench = Bench::new();
    bench.write("data", "a file where the folder should be");
    let writes: [&[&str]; 4] = [
        &["write", "hiperface", "address", "0x41"],
        &["write", "biss", "0x24:0x00", "1"],
        &["write", "interbus", "preset", "5"],
        &["write", "hiperdrive", "24", "5"],
    ];
    for write in writes {
        let ran = run_on_terminal(&bench, &[write, &["--link", "sim:"]].concat(), "y\n");
        assert_eq!(ran.status, Some(1), "{ran:?}");
        assert!(ran.out.contains("--force-wear") && !ran.out.contains("Write?"), "{ran:?}");
    }
}
