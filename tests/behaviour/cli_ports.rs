//! The ports of this computer, device servers, and the program's folder.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::time::Duration;

use super::support::Bench;

#[test]
fn lists_ports() {
    let bench = Bench::new();
    assert!(bench.run(&["ports", "--json"]).json()["ports"].is_array());
    let text = bench.run(&["ports"]);
    assert!(text.status == Some(0) && !text.out.is_empty(), "{text:?}");
}

#[test]
fn rejects_port_in_use() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    let polling = ["position", "hiperface", "--link", &encoder.url, "--count", "100000", "--interval", "20"];
    let mut first = bench.program(&polling).spawn().unwrap();
    let mut line = [0];
    // The first line of output shows that the process has opened the port.
    first.stdout.as_mut().unwrap().read_exact(&mut line).unwrap();
    let second = bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]);
    first.kill().unwrap();
    first.wait().unwrap();
    second.fails(1, &["in use"]);
}

/// Starts a device server that serves one client and then exits.
fn server(serve: impl FnOnce(TcpStream) + Send + 'static) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || serve(listener.accept().unwrap().0));
    url
}

#[test]
fn busy_line_times_out() {
    let bench = Bench::new();
    let talk = |mut client: TcpStream| {
        while client.write_all(&[0x40, 0x50]).is_ok() {
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    let ran = bench.run(&["identify", "hiperface", "--link", &server(talk), "--json"]);
    ran.fails(1, &[]);
    assert!(ran.took < Duration::from_secs(10), "{ran:?}");
    // A search would disturb the communication on the port.
    bench
        .run(&["find", "hiperface", "--only-master", "--link", &server(talk)])
        .fails(1, &["sends on this line", "nothing was sent"]);
}

#[test]
fn reports_server_hangup() {
    let bench = Bench::new();
    bench.run(&["identify", "hiperface", "--link", &server(drop), "--json"]).fails(1, &["lost"]);
    let after_a_request = |mut client: TcpStream| {
        let _ = client.read(&mut [0; 16]);
    };
    let url = server(after_a_request);
    bench.run(&["save", "hiperface", "--link", &url, "-o", &bench.file("p.ron")]).fails(1, &["lost"]);
    assert!(!bench.path("p.ron").exists());
}

#[test]
fn writes_nothing_without_backup_folder() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C8"}]"#]) else { return };
    bench.write("data", "a file where the folder should be");
    bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]).json();
    let write = ["write", "hiperface", "field:0", "00", "--yes", "--link", &encoder.url, "--json"];
    // The logbook has no folder either (issue 22.4).
    bench.run(&write).fails(1, &["Nothing was written", "logbook", "--force-wear"]);
    bench.run(&[&write[..], &["--force-wear"]].concat()).fails(1, &["nothing was written", "data"]);
    assert_eq!(encoder.writes(), [""; 0]);
}
