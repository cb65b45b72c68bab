//! Invalid input for a BiSS encoder, and unusable profiles. Each is reported in one sentence.

use super::biss_profile::PROFILE;
use super::support::Bench;

#[test]
fn broken_profile_is_rejected_by_name() {
    let bench = Bench::new();
    let good = bench.write("good.ron", PROFILE);
    let edited = |from: &str, to: &str| {
        assert!(PROFILE.contains(from), "{from}");
        PROFILE.replacen(from, to, 1)
    };
    let cases: [(&str, String, &[&str]); 11] = [
        ("syntax", edited("identity: (", "identity: (("), &["line", "column"]),
        ("cut", PROFILE[..PROFILE.len() / 2].to_owned(), &["line"]),
        ("empty", String::new(), &["line 1"]),
        ("key", edited("profile_id:", "profil:"), &["identity.profile_id", "missing"]),
        ("kind", edited("filter: 0x03", "filter: \"slow\""), &["filter"]),
        ("length", edited("3D 3E 3F\"", "3D 3E\""), &["63", "64"]),
        ("digit", edited("3D 3E 3F\"", "3D 3E 3G\""), &["G"]),
        ("bank", edited("bank: 0x25", "bank: 0x44"), &["bank"]),
        ("twice", edited("bank: 0x25", "bank: 0x24"), &["bank"]),
        ("preset", edited("singleturn: 98304", "singleturn: 16777216"), &["preset.singleturn"]),
        ("device", edited("\"biss\"", "\"bus\""), &["bus", "biss"]),
    ];
    for (name, content, words) in cases {
        let file = bench.write(name, content);
        for arguments in [&["verify", &file][..], &["restore", &file, "--yes"], &["restore", &file, "--dry-run"]] {
            bench.run(&[arguments, &["--link", "sim:", "--json"]].concat()).fails(1, &[words, &[name]].concat());
        }
        bench.run(&["diff", &good, &file, "--json"]).fails(1, words);
    }
}

/// A profile with a newer schema can be compared. The message states that it cannot be used for anything else (issue
/// 22.17).
#[test]
fn newer_schema_is_read_only() {
    let bench = Bench::new();
    let good = bench.write("good.ron", PROFILE);
    let newer = bench.write("newer.ron", PROFILE.replacen("schema: 1", "schema: 99", 1));
    let words = ["schema 99", "read-only"];
    for arguments in [&["restore", &newer, "--yes"][..], &["restore", &newer, "--dry-run"]] {
        bench.run(&[arguments, &["--link", "sim:", "--json"]].concat()).fails(1, &["schema 99", "newer.ron"]);
    }
    let compared = bench.run(&["diff", &good, &newer, "--json"]);
    assert_eq!((compared.status, compared.json()["equal"].as_bool()), (Some(0), Some(true)), "{compared:?}");
    assert!(words.iter().all(|word| compared.err.contains(word)), "{compared:?}");
    let verified = bench.run(&["verify", &newer, "--link", "sim:", "--json"]);
    assert_eq!(verified.status, Some(3), "the virtual encoder has other content: {verified:?}");
    assert!(words.iter().all(|word| verified.err.contains(word)), "{verified:?}");
}

#[test]
fn requires_valid_link() {
    let bench = Bench::new();
    let good = bench.write("good.ron", PROFILE);
    let commands: [&[&str]; 9] = [
        &["identify", "biss"],
        &["status", "biss"],
        &["position", "biss"],
        &["read", "biss", "0x66"],
        &["save", "biss", "-o", &good],
        &["write", "biss", "0x24:0x00", "1", "--yes"],
        &["do", "biss", "filter", "dynamic", "--yes"],
        &["verify", &good],
        &["restore", &good, "--yes"],
    ];
    let links: [(&str, i32, &[&str]); 17] = [
        ("ttyUSB0", 2, &["ttyUSB0", "bridge:"]),
        ("serial:/dev/x?order=lsb", 2, &["order=lsb", "low-first"]),
        ("serial:/dev/x?clock=1000000", 2, &["clock", "order"]),
        ("serial:/dev/x?baud=fast", 2, &["baud=fast", "300 to 4000000", "115200"]),
        ("tcp:127.0.0.1:1?parity=mark", 2, &["parity=mark", "none, even or odd"]),
        ("bridge:/dev/x?baud=115200", 2, &["baud", "clock"]),
        ("sim:?foo=1", 2, &["foo", "bridge, baud, parity", "line (bridge=on)"]),
        ("sim:?line=open", 2, &["line (bridge=on)"]),
        ("bridge:/dev/x?order=low-first", 2, &["order", "clock"]),
        ("bridge:/dev/x?clock=5", 2, &["clock=5", "80000"]),
        ("bridge:", 2, &["bridge:/dev/ttyACM0"]),
        ("sim:?bridge=maybe", 2, &["bridge=maybe", "on or off"]),
        ("sim:?motor=fast", 2, &["motor=fast", "steady or reverse"]),
        ("sim:?fault=drop:2", 2, &["drop:2"]),
        ("serial:/dev/ttyUSB99", 1, &["does not exist"]),
        ("bridge:/dev/null", 1, &["not a serial port"]),
        ("bridge:tcp:127.0.0.1:1", 1, &["Cannot reach"]),
    ];
    for command in commands {
        bench.run(&[command, &["--json"]].concat()).fails(2, &["--link"]);
        for (link, status, words) in links {
            bench.run(&[command, &["--link", link, "--json"]].concat()).fails(status, words);
        }
    }
    assert_eq!(bench.read("good.ron"), PROFILE, "a save that fails leaves what was there");
}

#[test]
fn invalid_arguments_are_usage_errors() {
    let bench = Bench::new();
    let cases: [&[&str]; 12] = [
        &["read", "biss", "colour"],
        &["read", "biss", "0x3F"],
        &["read", "biss", "0x80"],
        &["read", "biss", "0x24:0x40"],
        &["read", "biss", "0x24:0x3F+2"],
        &["read", "biss", "field:0"],
        &["write", "biss", "0x24:0x00", "--yes"],
        &["find", "biss"],
        &["do", "biss", "explode"],
        &["do", "biss", "wiegand-test", "twice", "--yes"],
        &["position", "biss", "--count", "many"],
        &["do", "biss", "lead-back", "now"],
    ];
    for arguments in cases {
        let ran = bench.run(&[arguments, &["--link", "sim:", "--json"]].concat());
        assert_eq!((ran.status, ran.out.as_str()), (Some(2), ""), "{arguments:?}: {ran:?}");
        assert!(!ran.err.is_empty() && !ran.err.contains("panicked"), "{ran:?}");
    }
    bench.run(&["identify", "bis", "--link", "sim:"]).fails(2, &["bis", "biss", "hiperface"]);
}

/// Each shipped profile can be restored to an encoder of its type.
#[test]
fn compares_ready_made_profiles() {
    let bench = Bench::new();
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/biss");
    let mut count = 0;
    for file in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = file.to_str().unwrap();
        let command = ["restore", name, "--dry-run", "--allow-other-device", "--link", "sim:", "--json"];
        let told = bench.run(&command).json();
        assert!(told["write_cycles"].as_u64() <= Some(4), "{name}: {told}");
        count += 1;
    }
    assert!(count > 0);
}
