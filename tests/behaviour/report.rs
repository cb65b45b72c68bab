//! The `report` command: a self-contained page with values, their meaning, history and differences.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::support::{Bench, skip};

/// Start of the virtual encoder's first field: the text EMD71K.
const FIELD: &str = "45 4D 44 37 31 4B";

fn profiles() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
    let kinds = ["hiperface", "biss", "ssi", "interbus", "hiperdrive"];
    let files = kinds.iter().flat_map(|kind| fs::read_dir(root.join(kind)).unwrap());
    let mut files: Vec<PathBuf> = files.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Returns the page without the element that contains the creation time.
fn without_time(page: &str) -> String {
    let (before, rest) = page.split_once("class=\"printed\">").unwrap();
    let (time, after) = rest.split_once('<').unwrap();
    assert!(time.contains(':') && !rest.contains("class=\"printed\""), "{time}");
    format!("{before}{after}")
}

/// Returns the text of each element in the page's body.
fn texts(page: &str) -> Vec<String> {
    let body = page.split_once("<body>").unwrap().1;
    let outside = body.split('<').filter_map(|part| Some(part.split_once('>')?.1.trim()));
    let plain = |text: &str| {
        let text = text.replace("&#60;", "<").replace("&#62;", ">").replace("&#34;", "\"").replace("&#39;", "'");
        text.replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&quot;", "\"")
            .replace("&#38;", "&")
            .replace("&amp;", "&")
    };
    outside.filter(|text| !text.is_empty()).map(plain).collect()
}

fn squeezed(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

#[test]
fn report_uses_no_external_resources() {
    let bench = Bench::new();
    for path in profiles() {
        for language in ["en", "de"] {
            let arguments = ["report", path.to_str().unwrap(), "-o", &bench.file("r.html"), "--language", language];
            let ran = bench.run(&[&arguments[..], &["--force"]].concat());
            assert_eq!(ran.status, Some(0), "{path:?}: {ran:?}");
            let page = bench.read("r.html");
            assert!(page.starts_with("<!DOCTYPE html>") && page.contains(&format!("<html lang=\"{language}\">")));
            for foreign in ["<script", "<link", "@import", "<iframe", "src=\"http", "href="] {
                assert!(!page.contains(foreign), "{path:?}: {foreign}");
            }
            assert!(page.match_indices("url(").all(|(at, _)| page[at..].starts_with("url(data:")), "{path:?}");
            assert_eq!(page.matches("http").count(), page.matches("http://www.w3.org/2000/svg").count(), "{path:?}");
            assert_eq!(page.matches("@font-face").count(), 3);
        }
    }
}

/// The page lists everything that was done to the encoder, with times and with old and new values.
#[test]
fn page_shows_device_history() {
    let bench = Bench::new();
    let fields = r#"[{"status":"C9","bytes":"0102031122060708"}]"#;
    let Some(encoder) = bench.encoder(&["--fields", fields]) else { return };
    let link = ["--link", &encoder.url, "--only-master", "--json"];
    let run = |words: &[&str]| bench.run(&[words, &link].concat()).json();
    let old = run(&["read", "hiperface", "field:0@3+2"])["value"].as_str().unwrap().to_owned();
    run(&["write", "hiperface", "field:0@3+2", "C0FF", "--yes"]);
    run(&["do", "hiperface", "set-position", "4096", "--yes", "--asset", "Axis 7"]);
    let made = run(&["report", "hiperface", "-o", &bench.file("r.html")]);
    let page = bench.read("r.html");
    let texts = texts(&page);
    let has = |text: &str| texts.iter().any(|own| own == text);
    for text in [
        "HIPERFACE report",
        "Data field 0, bytes 0x03 to 0x04",
        &old,
        "C0FF",
        "Position",
        "Axis 7",
        "Status when read",
        "Backups and saved profiles",
    ] {
        assert!(has(text), "{text}: {texts:?}");
    }
    let log = bench.run(&["log", "--json"]).out;
    let entries: Vec<serde_json::Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for entry in entries.iter().filter(|entry| ["write", "preset"].contains(&entry["what"].as_str().unwrap())) {
        let time = entry["time"].as_str().unwrap();
        let shown = format!("{} {} UTC", &time[..10], &time[11..19]);
        assert!(has(&shown), "{shown}");
        let backup = fs::read(entry["backup"].as_str().unwrap()).unwrap();
        bench.write("backup", &backup);
        let Ok(sum) = Command::new("sha256sum").arg(bench.path("backup")).output() else { continue };
        let sum = String::from_utf8(sum.stdout).unwrap();
        assert!(has(sum.split(' ').next().unwrap()), "{sum}");
    }
    let number = made["report_number"].as_str().unwrap();
    assert!(has(number) && has(made["sha256"].as_str().unwrap()));
    assert!(made["sha256"].as_str().unwrap().to_uppercase().starts_with(number));
}

/// The virtual encoder has the same serial number as the real one.
#[test]
fn counts_virtual_write_cycles_separately() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C9","bytes":"01020304"}]"#]) else { return };
    let (file, out) = (bench.file("a.ron"), bench.file("r.html"));
    bench.run(&["save", "hiperface", "--link", &encoder.url, "-o", &file]);
    let write = |link: &str| {
        bench.run(&["write", "hiperface", "field:0@3", "C0", "--yes", "--json", "--link", link]).json()["write_cycles"]
            .as_u64()
            .unwrap()
    };
    let (real, simulated) = (write(&encoder.url), write("sim:"));
    assert!(real > 0 && simulated > 0);
    bench.run(&["report", &file, "-o", &out]);
    let wanted = format!("Write cycles in the logbook: {real}. The newest entry comes first.");
    let texts = texts(&bench.read("r.html"));
    assert!(texts.contains(&wanted), "{texts:?}");
}

#[test]
fn only_print_time_varies() {
    let bench = Bench::new();
    bench.run(&["save", "hiperface", "--link", "sim:", "-o", &bench.file("a.ron")]);
    let report = |out: &str, more: &[&str]| {
        let file = bench.file(out);
        bench.run(&[&["report", &bench.file("a.ron"), "-o", &file, "--json"], more].concat())
    };
    let first = report("1.html", &[]).json();
    std::thread::sleep(std::time::Duration::from_millis(1100));
    let second = report("2.html", &[]).json();
    let (one, two) = (bench.read("1.html"), bench.read("2.html"));
    assert_ne!(one, two);
    assert_eq!(without_time(&one), without_time(&two));
    assert_eq!(first["sha256"], second["sha256"]);
    assert!(one.contains(FIELD));
    // A report with different content has a different checksum.
    let changed = bench.read("a.ron").replacen("45 4D 44", "58 4D 44", 1);
    let other = bench.write("b.ron", changed);
    let compared =
        bench.run(&["report", &other, "-o", &bench.file("3.html"), "--compare", &bench.file("a.ron"), "--json"]);
    assert_ne!(compared.json()["sha256"], first["sha256"]);
    let page = texts(&bench.read("3.html"));
    let at = page.iter().position(|text| text == "Data field 0, byte 0x00").unwrap();
    assert_eq!(&page[at + 1..at + 3], ["58", "45"]);
    assert!(page.iter().any(|text| text == "Differences from a.ron"), "{page:?}");
    // The asset is part of the content.
    assert_ne!(report("4.html", &["--asset", "Axis 1"]).json()["sha256"], first["sha256"]);
}

#[test]
fn failed_report_leaves_no_file() {
    let bench = Bench::new();
    let out = bench.file("r.html");
    bench.run(&["report", &bench.file("missing.ron"), "-o", &out]).fails(1, &["missing.ron"]);
    let broken = bench.write("broken.ron", "(schema: 1");
    bench.run(&["report", &broken, "-o", &out]).fails(1, &["broken.ron"]);
    bench.run(&["report", "hiperface", "-o", &out, "--link", "serial:/nowhere"]).fails(1, &["/nowhere"]);
    bench.run(&["report", "toaster", "-o", &out, "--link", "sim:"]).fails(2, &["toaster", "hiperface"]);
    let profile = bench.file("a.ron");
    bench.run(&["save", "hiperface", "--link", "sim:", "-o", &profile]);
    bench.run(&["report", &profile, "-o", &bench.file("r.txt")]).fails(2, &[".html", ".pdf"]);
    bench.run(&["report", &profile, "-o", &out, "--compare", &broken]).fails(1, &["broken.ron"]);
    assert!(!bench.path("r.html").exists() && !bench.path("r.txt").exists());
    // An existing file is replaced without a terminal, and this is reported.
    bench.write("r.html", "before");
    let ran = bench.run(&["report", &profile, "-o", &out]);
    assert!(ran.status == Some(0) && ran.err.contains("already existed and was replaced"), "{ran:?}");
    assert_ne!(bench.read("r.html"), "before");
}

/// The access code is used to read the field but must not appear in the report.
#[test]
fn report_omits_access_codes() {
    let bench = Bench::new();
    let change = ["do", "hiperface", "change-code", "2", "A7", "--yes", "--link", "sim:"];
    assert_eq!(bench.run(&change).status, Some(0));
    for name in ["r.html", "r.pdf"] {
        let ran = bench.run(&["report", "hiperface", "--link", "sim:", "--code", "0=55", "-o", &bench.file(name)]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
    }
    let is_code = |text: &str| ["55", "A7", "0x55", "0xA7"].contains(&text);
    let page = texts(&bench.read("r.html"));
    assert!(!page.iter().any(|text| is_code(text)), "{page:?}");
    let Ok(read) = Command::new("pdftotext").args(["-raw", &bench.file("r.pdf"), "-"]).output() else {
        return skip("pdftotext is not installed");
    };
    let document = String::from_utf8(read.stdout).unwrap();
    assert!(document.contains("SKM36") && !document.split_whitespace().any(is_code), "{document}");
}

/// The PDF document contains the same text as the page.
#[test]
fn pdf_matches_page() {
    if Command::new("pdftotext").arg("-v").output().is_err() {
        return skip("pdftotext is not installed");
    }
    let bench = Bench::new();
    for path in profiles() {
        for language in ["en", "de"] {
            for name in ["r.html", "r.pdf"] {
                let out = bench.file(name);
                let ran = bench.run(&["report", path.to_str().unwrap(), "-o", &out, "--language", language, "--force"]);
                assert_eq!(ran.status, Some(0), "{path:?}: {ran:?}");
            }
            // Text is extracted in content order, so the lines of a cell stay together.
            let read = Command::new("pdftotext").args(["-raw", &bench.file("r.pdf"), "-"]).output().unwrap();
            let document = squeezed(&String::from_utf8(read.stdout).unwrap());
            for text in texts(&bench.read("r.html")) {
                // The creation time may be a second later.
                if !text.contains(" UTC") {
                    assert!(document.contains(&squeezed(&text)), "{path:?} {language}: {text:?}");
                }
            }
        }
    }
}

/// The scale is 0.1°, 3600 steps per turn. The limits are half a turn in either direction.
#[test]
fn drive_limits_are_in_turns() {
    let bench = Bench::new();
    let profile = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/hiperdrive/rotary-axis-in-0.1-degree.ron");
    for (language, travel) in [
        ("en", "-0.500 to 0.500 turns, in total 1.000 turns"),
        ("de", "-0,500 bis 0,500 Umdrehungen, insgesamt 1,000 Umdrehungen"),
    ] {
        let out = bench.file("r.html");
        let ran = bench.run(&["report", profile.to_str().unwrap(), "-o", &out, "--language", language]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        let page = texts(&bench.read("r.html"));
        assert!(page.iter().any(|text| text == travel), "{page:?}");
    }
}

/// The report shows the values of `analyse` next to their limits, with a verdict.
#[test]
fn capture_report_has_limits() {
    let bench = Bench::new();
    let capture = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/signals/offset-gain-phase.csv");
    let capture = capture.to_str().unwrap();
    let found = bench.run(&["analyse", capture, "--json"]).json();
    let made = bench.run(&["report", capture, "-o", &bench.file("r.html"), "--json"]);
    assert_eq!(made.status, Some(0), "{made:?}");
    let page = bench.read("r.html");
    let rows = texts(&page);
    let after = |label: &str| {
        let at = rows.iter().position(|text| text == label).unwrap_or_else(|| panic!("{label}: {rows:?}"));
        rows[at + 1..at + 5].to_vec()
    };
    let gain = format!("{:.4}", found["gain_ratio"].as_f64().unwrap());
    assert_eq!(after("Gain ratio cos/sin")[..2], [gain, "0.9 … 1.1".to_owned()]);
    let phase = format!("{:.2}", found["phase_error_deg"].as_f64().unwrap());
    assert_eq!(after("Phase error")[..3], [phase, "°".to_owned(), "± 5".to_owned()]);
    assert_eq!(page.matches("<svg").count(), 4, "signals, Lissajous, spectrum, position error");
    // Other limits: 0.8 V to 1.2 V peak to peak.
    let ran = bench.run(&["report", capture, "-o", &bench.file("r.html"), "--limits", "afs-afm60", "--language", "de"]);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert!(texts(&bench.read("r.html")).iter().any(|text| text == "0,8 … 1,2"));
    bench.run(&["report", "missing.csv", "-o", &bench.file("x.html")]).fails(1, &["missing.csv"]);
    bench.run(&["report", capture, "-o", &bench.file("x.html"), "--compare", "b.ron"]).fails(1, &["b.ron"]);
    assert!(!bench.path("x.html").exists());
}

#[test]
fn settings_name_company() {
    let bench = Bench::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let logo = root.join("assets/icon/64.png");
    let profile = root.join("profiles/hiperface/multiturn-skm36.ron");
    fs::create_dir_all(bench.path("config/encoder-studio")).unwrap();
    let settings = |logo: &str| {
        let text = format!("(company: Some(\"Miller & Sons\"), company_logo: Some({logo:?}))");
        bench.write("config/encoder-studio/settings.ron", text);
    };
    settings(logo.to_str().unwrap());
    for name in ["r.html", "r.pdf"] {
        let ran = bench.run(&["report", profile.to_str().unwrap(), "-o", &bench.file(name)]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
    }
    let page = bench.read("r.html");
    assert!(page.contains("src=\"data:image/png;base64,iVBOR"), "a PNG file begins with these bytes");
    assert!(texts(&page).iter().any(|text| text == "Miller & Sons"));
    settings("/missing.png");
    bench.run(&["report", profile.to_str().unwrap(), "-o", &bench.file("x.html")]).fails(1, &["missing.png"]);
    assert!(!bench.path("x.html").exists());
}
