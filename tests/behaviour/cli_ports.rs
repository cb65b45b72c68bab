//! Ports of this machine.

use super::support::Bench;

#[test]
fn ports_are_listed_or_there_are_none() {
    let bench = Bench::new();
    assert!(bench.run(&["ports", "--json"]).json()["ports"].is_array());
    let text = bench.run(&["ports"]);
    assert!(text.status == Some(0) && !text.out.is_empty(), "{text:?}");
}

#[test]
fn a_port_in_use_is_not_taken_away() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    let polling = ["position", "hiperface", "--link", &encoder.url, "--count", "100000", "--interval", "20"];
    let mut first = bench.program(&polling).spawn().unwrap();
    let mut line = [0];
    // Its first line of output: it has the port.
    std::io::Read::read_exact(first.stdout.as_mut().unwrap(), &mut line).unwrap();
    let second = bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]);
    first.kill().unwrap();
    first.wait().unwrap();
    second.fails(1, &["in use"]);
}
