//! The `simulate interbus` command, checked by an independently written master with the words of the reference. An
//! independent encoder has to answer that master in the same way.

use super::support::{Bench, Simulated, foreign_host, python};

fn host_replies(place: &str, things: &[&str]) -> Vec<String> {
    foreign_host("interbus_master.py", place, things)
}

/// The worked example of reference 4: 5000 of 8192 steps become 155 of 255 steps, followed by the preset.
const WORKED_EXAMPLES: [(&str, &str); 9] = [
    ("in", "00001388"),
    ("020000FF", "C20000FF"),
    ("04000001", "C4000001"),
    ("06000003", "C6000003"),
    ("08000000", "C8000000"),
    ("80000000", "0000009B"),
    ("00000000", "0000009B"),
    ("40000000", "00000000"),
    ("00000000", "00000000"),
];

/// Cams at 4096 steps per turn (reference 5). The position window shows 2500. Cam 3 first covers 21 to 531 and is off,
/// then 2001 past the end of the range to 531.
const CAMS: [(&str, &str); 21] = [
    ("20800001", "E0800001"),
    ("46000015", "C6000015"),
    ("66000213", "E6000213"),
    ("20400008", "E0400008"),
    ("80000000", "0009C400"),
    ("20200013", "A0000015"),
    ("00000000", "0009C400"),
    ("20200023", "A0000213"),
    ("00000000", "0009C400"),
    ("20200000", "A0000008"),
    ("00000000", "0009C400"),
    ("460007D1", "C60007D1"),
    ("20100004", "E0100004"),
    ("80000000", "00009C08"),
    ("46001000", "98000004"),
    ("80000000", "00009C08"),
    ("00000000", "00009C08"),
    ("20210009", "A0000003"),
    ("00000000", "00009C08"),
    ("20800000", "000009C4"),
    ("00000000", "000009C4"),
];

#[track_caller]
fn walk(place: &str, walk: &[(&str, &str)]) {
    let (things, expected): (Vec<&str>, Vec<&str>) = walk.iter().copied().unzip();
    let said = host_replies(place, &things);
    let pairs = || things.iter().zip(&said);
    assert_eq!(said, expected, "{:?}", pairs().collect::<Vec<_>>());
}

fn virtual_gateway(bench: &Bench, settings: &[&str]) -> Simulated {
    let settings = settings.iter().flat_map(|setting| ["--set", setting]);
    Simulated::start(bench, &["interbus", "--listen", "127.0.0.1:0"].into_iter().chain(settings).collect::<Vec<_>>())
}

#[test]
fn examples_match_reference() {
    let bench = Bench::new();
    if python("interbus_master.py").is_none() {
        return;
    }
    let gear = ["steps=8192", "revolutions=1", "position=5000", "busy=20", "stale=2"];
    let port = virtual_gateway(&bench, &gear);
    walk(&port.place, &WORKED_EXAMPLES);
    // The next client finds the encoder as the first one has left it.
    walk(&port.place, &[("in", "00000000"), ("20210001", "A00000FF"), ("00000000", "00000000")]);
    port.end("INT");
    let port = virtual_gateway(&bench, &["steps=4096", "revolutions=1", "position=5000", "busy=20", "stale=2"]);
    walk(&port.place, &CAMS);
    port.end("TERM");
}

/// Both encoders were written from the reference, independently of each other.
#[test]
fn independent_encoder_matches_reference() {
    let bench = Bench::new();
    let Some(foreign) = bench.gateway(&["--position", "5000", "--busy", "20", "--stale", "2"]) else { return };
    assert_eq!(foreign.url, format!("modbus:{}", foreign.place));
    walk(&foreign.place, &WORKED_EXAMPLES);
    let kept: Vec<String> = foreign.requests().into_iter().filter(|line| line != "R").collect();
    let words = ["W 020000FF", "W 04000001", "W 06000003", "W 08000000", "W 80000000", "STORE parameters"];
    assert_eq!(kept, [&words[..], &["W 00000000", "W 40000000", "PRESET 0", "W 00000000"]].concat());
    let Some(foreign) = bench.gateway(&["--position", "5000", "--steps", "4096", "--busy", "20", "--stale", "2"])
    else {
        return;
    };
    walk(&foreign.place, &CAMS);
    let stored: Vec<String> = foreign.requests().into_iter().filter(|line| line.starts_with("STORE")).collect();
    assert_eq!(stored, ["STORE program 1", "STORE program 1"]);
}

#[test]
fn serves_concurrent_masters() {
    let bench = Bench::new();
    if python("interbus_master.py").is_none() {
        return;
    }
    let port = virtual_gateway(&bench, &["steps=8192", "revolutions=1", "position=5000"]);
    let things =
        ["020000FF", "other:in", "other:out", "other:04000001", "in", "out", "80000000", "other:00000000", "in"];
    let words =
        ["C20000FF", "C20000FF", "020000FF", "C4000001", "C4000001", "04000001", "0000009B", "0000009B", "0000009B"];
    assert_eq!(host_replies(&port.place, &things), words);
    port.end("INT");
}

#[test]
fn configures_registers_unit_and_word_order() {
    let bench = Bench::new();
    if python("interbus_master.py").is_none() {
        return;
    }
    let settings =
        ["unit=17", "input=100", "output=512", "order=low-first", "position=5000", "steps=8192", "revolutions=1"];
    let port = virtual_gateway(&bench, &settings);
    let options = ["--unit=17", "--input=100", "--output=512", "--low-first"];
    assert_eq!(
        host_replies(&port.place, &[&options[..], &["in", "020000FF", "out"]].concat()),
        ["00001388", "C20000FF", "020000FF"]
    );
    let wrong = ["raw:01 0000 0001", "raw:04 0000 0002", "raw:04 0064 0000", "raw:07"];
    let exceptions = ["exception 01", "exception 02", "exception 03", "exception 01"];
    assert_eq!(host_replies(&port.place, &[&["--unit=17"], &wrong[..]].concat()), exceptions);
    assert_eq!(host_replies(&port.place, &["in"]), ["exception 0B"]);
    port.end("INT");
}

/// After a loss of power, the encoder restarts with the next client and without the value that it was storing.
#[test]
fn injects_configured_faults() {
    let bench = Bench::new();
    if python("interbus_master.py").is_none() {
        return;
    }
    let listen = ["interbus", "--listen", "127.0.0.1:0", "--set", "steps=360", "--set", "revolutions=1"];
    let port = Simulated::start(&bench, &[&listen[..], &["--fault", "die-in-store:1"]].concat());
    assert_eq!(
        host_replies(&port.place, &["06000004", "80000000", "in"]),
        ["C6000004", "exception 0B", "exception 0B"]
    );
    assert_eq!(host_replies(&port.place, &["in", "20210001"]), ["86000000", "A1FFFFFF"]);
    port.end("INT");
    let refusing = Simulated::start(&bench, &[&listen[..], &["--set", "exception=1"]].concat());
    assert_eq!(host_replies(&refusing.place, &["in", "020000FF"]), ["exception 0B", "exception 0B"]);
    refusing.end("TERM");
    bench
        .run(&["simulate", "interbus", "--listen", "127.0.0.1:0", "--fault", "lose:1"])
        .fails(2, &["lose:1", "drop:P"]);
}

#[test]
fn rejects_impossible_simulations() {
    let bench = Bench::new();
    bench.run(&["simulate", "interbus", "--pty", &bench.file("enc")]).fails(2, &["--listen", "Modbus/TCP"]);
    bench.run(&["simulate", "interbus", "--listen", "127.0.0.1:0", "--bridge"]).fails(2, &["--bridge", "biss"]);
    bench.run(&["simulate", "interbus"]).fails(2, &["--listen"]);
    let wrong = ["simulate", "interbus", "--listen", "127.0.0.1:0", "--set", "steps=0"];
    bench.run(&wrong).fails(2, &["steps=0", "1", "33554431"]);
    bench.run(&["simulate", "interbus", "--listen", "nowhere"]).fails(2, &["nowhere", "HOST:PORT"]);
    assert!(!bench.path("enc").exists());
}
