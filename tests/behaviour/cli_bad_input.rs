//! Invalid input. Each case ends with its exit status and one clear sentence.

use std::fs;
use std::process::Stdio;

use serde_json::json;

use super::support::{Bench, finish};

/// Returns a profile of the virtual encoder with a single field.
fn profile(bench: &Bench) -> String {
    let file = bench.file("good.ron");
    let ran = bench.run(&["save", "hiperface", "--link", "sim:?serial=HF0000001", "-o", &file]);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    let field =
        "fields: [\n (number: 0, status: 0xC8, bytes: [\"00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\"]),\n],\n)";
    let text = bench.read("good.ron");
    let (before, _) = text.split_once("fields: [").unwrap();
    bench.write("good.ron", format!("{before}{field}"))
}

const SIM: &str = "sim:?serial=HF0000001";

#[test]
fn accepts_hand_edited_profile() {
    let bench = Bench::new();
    let file = profile(&bench);
    let told = bench.run(&["restore", &file, "--yes", "--link", SIM, "--json"]).json();
    assert_eq!(told["verified"], told["written"]);
    let by_crlf = bench.write("crlf.ron", bench.read("good.ron").replace('\n', "\r\n"));
    assert_eq!(bench.run(&["diff", &file, &by_crlf, "--json"]).json()["equal"], json!(true));
    let with_mark = bench.write("mark.ron", format!("\u{feff}{}", bench.read("good.ron")));
    assert_eq!(bench.run(&["diff", &file, &with_mark, "--json"]).json()["equal"], json!(true));
}

#[test]
fn broken_profile_is_rejected_by_name() {
    let bench = Bench::new();
    profile(&bench);
    let good = bench.read("good.ron");
    let edited = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replacen(from, to, 1)
    };
    let cases: [(&str, Vec<u8>, &[&str]); 11] = [
        ("syntax", edited("identity: (", "identity: ((").into(), &["line", "column"]),
        ("cut", good[..good.len() / 2].into(), &["line"]),
        ("empty", Vec::new(), &["line 1"]),
        ("words", b"Dear Sir or Madam".into(), &["not a valid profile"]),
        ("deep", "[".repeat(100_000).into(), &["line 1"]),
        ("key", edited("serial_number:", "serial_nr:").into(), &["identity.serial_number", "missing"]),
        ("kind", edited("status: 0xC8", "status: \"C8\"").into(), &["status", "number"]),
        ("length", edited("0E 0F\"", "0E\"").into(), &["fields[0].bytes", "15", "16"]),
        ("digit", edited("0E 0F\"", "0E 0G\"").into(), &["fields[0].bytes", "G"]),
        ("device", edited("\"hiperface\"", "\"sse\"").into(), &["sse", "hiperface"]),
        ("latin", [good.as_bytes(), b"// Gr\xFC\xDFe"].concat(), &["UTF-8"]),
    ];
    for (name, content, words) in cases {
        let file = bench.write(name, content);
        for arguments in [&["verify", &file][..], &["restore", &file, "--yes"], &["restore", &file, "--dry-run"]] {
            bench.run(&[arguments, &["--link", SIM, "--json"]].concat()).fails(1, &[words, &[name]].concat());
        }
        bench.run(&["diff", &bench.file("good.ron"), &file, "--json"]).fails(1, words);
    }
}

/// A profile with a newer schema can be compared. The message states that it cannot be used for anything else (issue
/// 22.17).
#[test]
fn newer_schema_is_read_only() {
    let bench = Bench::new();
    profile(&bench);
    let newer = bench.write("newer.ron", bench.read("good.ron").replacen("schema: 1", "schema: 99", 1));
    for consent in ["--yes", "--dry-run"] {
        bench.run(&["restore", &newer, consent, "--link", SIM, "--json"]).fails(1, &["schema 99", "newer.ron"]);
    }
    let compared = bench.run(&["diff", &bench.file("good.ron"), &newer, "--json"]);
    assert_eq!((compared.status, compared.json()["equal"].as_bool()), (Some(0), Some(true)), "{compared:?}");
    assert!(["schema 99", "read-only"].iter().all(|word| compared.err.contains(word)), "{compared:?}");
}

#[test]
fn rejects_unreadable_files() {
    let bench = Bench::new();
    fs::create_dir(bench.path("folder")).unwrap();
    let huge = bench.file("huge");
    fs::File::create(&huge).unwrap().set_len(1 << 32).unwrap();
    let cases = [("folder", "folder"), ("huge", "size limit"), ("missing", "does not exist")];
    for (name, word) in cases {
        bench.run(&["verify", &bench.file(name), "--link", SIM, "--json"]).fails(1, &[name, word]);
        let replay = format!("replay:{}", bench.file(name));
        bench.run(&["identify", "hiperface", "--link", &replay, "--json"]).fails(1, &[name, word]);
    }
    bench.run(&["verify", "/dev/zero", "--link", SIM, "--json"]).fails(1, &["/dev/zero"]);
    let no_trace = format!("replay:{}", bench.write("no.trace", "hello"));
    bench.run(&["identify", "hiperface", "--link", &no_trace]).fails(1, &["no.trace", "trace 1"]);
}

#[test]
fn other_encoder_is_rejected_before_writing() {
    let bench = Bench::new();
    let file = profile(&bench);
    let Some(encoder) = bench.encoder(&["--serial", "XX9999999"]) else { return };
    for consent in ["--yes", "--dry-run"] {
        let ran = bench.run(&["restore", &file, consent, "--link", &encoder.url, "--json"]);
        ran.fails(1, &["HF0000001", "XX9999999", "--allow-other-device"]);
    }
    assert_eq!(encoder.writes(), [""; 0]);
    let arguments = ["restore", &file, "--yes", "--allow-other-device", "--link", &encoder.url, "--json"];
    // The meaning of the field's bytes is not known (issue 22.8).
    let arguments = [&arguments[..], &["--copy", "field:0"]].concat();
    let told = bench.run(&arguments).json();
    assert_eq!(told["verified"], told["written"]);
    assert_eq!(bench.run(&["verify", &file, "--link", &encoder.url, "--json"]).json()["equal"], json!(true));
}

/// A drive may be connected even if nothing answers on a serial line, so a search needs confirmation from the user.
/// Other commands run without it, as scripts expect (issue 22.30).
#[test]
fn scripted_search_needs_only_master() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    bench
        .run(&["find", "hiperface", "--link", &encoder.url, "--json"])
        .fails(2, &["--only-master", "nothing was sent"]);
    bench.run(&["find", "hiperface", "--link", "tcp:127.0.0.1:9"]).fails(2, &["--only-master", "nothing was sent"]);
    assert_eq!(encoder.requests(), [""; 0]);
    assert_eq!(bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]).json()["device"], "hiperface");
    bench.run(&["identify", "biss", "--only-master", "--link", "sim:"]).fails(2, &["--only-master"]);
}

/// Returns the path of a ready-made profile.
fn ready_made(kind: &str, name: &str) -> String {
    format!("{}/profiles/{kind}/{name}.ron", env!("CARGO_MANIFEST_DIR"))
}

/// Options for data fields are rejected for devices without data fields before the link is opened (issue 22.8).
#[test]
fn data_field_options_need_hiperface() {
    let bench = Bench::new();
    let profiles = [
        ready_made("biss", "dynamic-filter"),
        ready_made("interbus", "scaled-encoder"),
        ready_made("hiperdrive", "gentle-commissioning"),
    ];
    for file in &profiles {
        for answer in ["--copy", "--leave"] {
            let restore = ["restore", file, "--dry-run", answer, "field:0", "--link", "sim:"];
            bench.run(&restore).fails(2, &["--copy and --leave", "data fields"]);
        }
    }
}

/// The message names the other type, and the restore is rejected unless the user permits it explicitly (issue 22.9).
#[test]
fn other_biss_encoder_needs_permission() {
    let bench = Bench::new();
    let text = fs::read_to_string(ready_made("biss", "dynamic-filter")).unwrap();
    let other = text.replace("device_id: \"01 01", "device_id: \"02 01");
    assert_ne!(other, text);
    let file = bench.write("other.ron", other);
    let restore = ["restore", &file, "--dry-run", "--allow-other-device", "--link", "sim:", "--json"];
    bench.run(&restore).fails(1, &["--allow-other-type", "nothing was written"]);
    let allowed = bench.run(&[&restore[..], &["--allow-other-type"]].concat());
    assert!(allowed.status == Some(0) && allowed.err.contains("may have different meanings"), "{allowed:?}");
}

/// The message names the other type, and the restore is rejected unless the user permits it explicitly (issue 22.9).
#[test]
fn other_type_needs_permission() {
    let bench = Bench::new();
    let file = profile(&bench);
    let Some(encoder) = bench.encoder(&["--serial", "XX9999999", "--type", "0x32"]) else { return };
    let restore = ["restore", &file, "--allow-other-device", "--copy", "field:0", "--link", &encoder.url, "--json"];
    for consent in ["--yes", "--dry-run"] {
        let ran = bench.run(&[&restore[..], &[consent]].concat());
        ran.fails(1, &["37h", "32h", "--allow-other-type"]);
    }
    let allowed = [&restore[..], &["--allow-other-type"]].concat();
    let dry = bench.run(&[&allowed[..], &["--dry-run"]].concat());
    assert!(dry.err.contains("37h") && dry.err.contains("32h"), "{dry:?}");
    assert_eq!(encoder.writes(), [""; 0]);
    let told = bench.run(&[&allowed[..], &["--yes"]].concat()).json();
    assert_eq!((&told["verified"], &told["redo"]), (&told["written"], &json!(["commutation"])));
}

#[test]
fn writes_nothing_without_consent() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C8"}]"#]) else { return };
    let file = profile(&bench);
    let commands: [&[&str]; 5] = [
        &["write", "hiperface", "field:0", "00"],
        &["write", "hiperface", "address", "0x41"],
        &["do", "hiperface", "create-field", "1", "16"],
        &["do", "hiperface", "set-position", "0"],
        &["restore", &file],
    ];
    for command in commands {
        bench.run(&[command, &["--link", &encoder.url, "--json"]].concat()).fails(2, &["--yes"]);
    }
    assert_eq!(encoder.requests(), [""; 0]);
}

#[test]
fn requires_valid_link() {
    let bench = Bench::new();
    for command in [&["identify", "hiperface"][..], &["status", "hiperface"], &["read", "hiperface", "counter"]] {
        bench.run(&[command, &["--json"]].concat()).fails(2, &["--link"]);
        bench.run(&[command, &["--link", "ttyUSB0"]].concat()).fails(2, &["ttyUSB0", "serial:"]);
        bench.run(&[command, &["--link", "serial:/dev/x?baud=fast"]].concat()).fails(2, &["baud=fast", "9600"]);
        bench.run(&[command, &["--link", "serial:/dev/x?speed=1"]].concat()).fails(2, &["speed", "baud"]);
        bench.run(&[command, &["--link", "sim:?fault=drop:2"]].concat()).fails(2, &["drop:2", "0 to 1"]);
        bench.run(&[command, &["--link", "enip:192.168.1.7"]].concat()).fails(2, &["enip:", "serial:"]);
        bench.run(&[command, &["--link", "bridge:tcp:host"]].concat()).fails(2, &["bridge:tcp:192.168.0.7:4001"]);
    }
    bench.run(&["diff", &profile(&bench), "--json"]).fails(2, &["--link"]);
    bench.run(&["identify", "drill", "--link", "sim:"]).fails(2, &["drill", "hiperface"]);
    bench.run(&["identfy", "hiperface"]).fails(2, &["identify"]);
}

#[test]
fn reports_invalid_port() {
    let bench = Bench::new();
    let file = bench.write("file", "text");
    let cases = [
        ("serial:/dev/ttyUSB99".to_owned(), "does not exist"),
        (format!("serial:{file}"), "not a serial port"),
        (format!("serial:{}", bench.file("")), "not a serial port"),
        ("serial:/dev/null".to_owned(), "not a serial port"),
        ("tcp:127.0.0.1:1".to_owned(), "Cannot reach"),
        ("tcp:no-such-host.invalid:4001".to_owned(), "not found on this network"),
    ];
    for (url, words) in cases {
        bench.run(&["identify", "hiperface", "--link", &url, "--json"]).fails(1, &[words]);
    }
}

#[test]
fn range_error_names_both_limits() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C9"}]"#]) else { return };
    let cases: [(&[&str], &[&str]); 11] = [
        (&["write", "hiperface", "address", "0x60", "--yes"], &["0x40", "0x5F"]),
        (&["write", "hiperface", "address", "-1", "--yes"], &["64", "95"]),
        (&["write", "hiperface", "settings", "256", "--yes"], &["0", "255"]),
        (&["write", "hiperface", "settings", "-5", "--yes"], &["-5", "0", "255"]),
        (&["write", "hiperface", "field:0@30", "010203", "--yes"], &["0 to 31"]),
        (&["write", "hiperface", "field:7", "00", "--yes"], &["0 to 0"]),
        (&["read", "hiperface", "field:0@32"], &["0 to 31"]),
        (&["read", "hiperface", "field:7"], &["0 to 0"]),
        (&["read", "hiperface", "status:7"], &["0 to 0"]),
        (&["do", "hiperface", "set-position", "16777216", "--yes"], &["0 to 16777215"]),
        (&["do", "hiperface", "set-position", "-1", "--yes"], &["0", "4294967295"]),
    ];
    for (arguments, words) in cases {
        bench.run(&[arguments, &["--link", &encoder.url, "--json"]].concat()).fails(1, words);
    }
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn invalid_arguments_are_usage_errors() {
    let bench = Bench::new();
    let cases: [&[&str]; 12] = [
        &["read", "hiperface", "colour"],
        &["read", "hiperface", "field:x"],
        &["read", "hiperface", "field:0@1+0"],
        &["write", "hiperface", "analogue:0", "1", "--yes"],
        &["write", "hiperface", "address", "home", "--yes"],
        &["write", "hiperface", "field:0", "0G", "--yes"],
        &["write", "hiperface", "field:0@0+2", "00", "--yes"],
        &["write", "hiperface", "field:0", "", "--yes"],
        &["write", "hiperface", "field:0", "--yes"],
        &["do", "hiperface", "explode", "--yes"],
        &["do", "hiperface", "lock-field", "--yes"],
        &["position", "hiperface", "--count", "many"],
    ];
    for arguments in cases {
        let ran = bench.run(&[arguments, &["--link", "sim:", "--json"]].concat());
        assert_eq!((ran.status, ran.out.as_str()), (Some(2), ""), "{arguments:?}: {ran:?}");
        assert!(!ran.err.is_empty() && !ran.err.contains("panicked"), "{ran:?}");
    }
}

#[test]
fn failed_save_leaves_no_file() {
    let bench = Bench::new();
    bench.write("file", "text");
    fs::create_dir(bench.path("folder")).unwrap();
    for (name, word) in [("none/p.ron", "does not exist"), ("file/p.ron", "file"), ("folder", "folder")] {
        let file = bench.file(name);
        bench.run(&["save", "hiperface", "--link", "sim:", "-o", &file, "--json"]).fails(1, &[name, word]);
    }
    assert_eq!(bench.read("file"), "text");
    assert_eq!(fs::read_dir(bench.path("folder")).unwrap().count(), 0);
    let old = bench.write("old.ron", "kept");
    let silent = "sim:?fault=silent-after:3";
    bench.run(&["save", "hiperface", "--link", silent, "-o", &old, "--json"]).fails(1, &[]);
    assert_eq!(bench.read("old.ron"), "kept");
    let beside: Vec<_> = fs::read_dir(bench.path("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(beside.iter().all(|name| !name.to_string_lossy().contains("tmp")), "{beside:?}");
}

#[test]
fn closed_output_pipe_does_not_panic() {
    let bench = Bench::new();
    let arguments = ["position", "hiperface", "--link", "sim:", "--count", "100000", "--interval", "0"];
    let mut child = bench.program(&arguments).spawn().unwrap();
    drop(child.stdout.take());
    let ran = super::support::ended(child, std::time::Instant::now());
    assert!(ran.status.is_some() && !ran.err.contains("panicked"), "{ran:?}");

    // A closed standard error is not a failure either.
    let mut command = bench.program(&["identify", "hiperface"]);
    command.stderr(Stdio::from(closed_pipe()));
    assert_eq!(finish(command).status, Some(2));
    let mut command = bench.program(&["identify", "hiperface", "--link", "tcp:127.0.0.1:1"]);
    command.stderr(Stdio::from(closed_pipe()));
    assert_eq!(finish(command).status, Some(1));
}

/// Returns the write end of a pipe that has no reader.
fn closed_pipe() -> std::io::PipeWriter {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer
}
