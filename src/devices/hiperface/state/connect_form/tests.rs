//! Tests of the connection form: conversion to and from links, and messages about invalid entries.

use super::*;
use crate::app::Language;

fn form(link: &str) -> LinkForm {
    LinkForm::from_url(&link.parse().unwrap())
}

#[test]
fn links_round_trip_through_form() {
    let same = [
        "sim:",
        "sim:?model=sel37&rpm=60&fault=drop:0.01",
        "sim:?fault=drop:0.01&seed=7",
        "sim:?rpm=-12.5&baud=19200&address=0x41&echo=on&encoders=2&settings=0xE5",
        "serial:/dev/ttyUSB0",
        "serial:COM3",
        "serial:/dev/serial/by-id/usb-FTDI_A&B-if00",
        "serial:/dev/ttyUSB0?baud=38400&parity=odd&address=0x5F&echo=off&timeout=11&margin=5&periods=64&turns=4096",
        "serial:/dev/ttyUSB0?parity=none&address=0xFF",
        "tcp:127.0.0.1:4001",
        "tcp:encoder-7:4001?margin=200",
        "tcp:[::1]:4001?baud=19200",
        "bridge:/dev/ttyACM0",
        "bridge:COM3?voltage=8.5&leave-supply=on&address=0x41&margin=200",
        "bridge:tcp:192.168.0.7:4001?voltage=12&baud=38400",
        "replay:captures/monday.trace",
        "replay:monday.trace?periods=16",
    ];
    for link in same {
        assert_eq!(form(link).url().unwrap().to_string(), link);
    }
    let shorter = [
        ("sim:?model=skm36&rpm=60&fault=drop:0.01", "sim:?rpm=60&fault=drop:0.01"),
        ("sim:?seed=7&fault=drop:0.01", "sim:?fault=drop:0.01&seed=7"),
        ("serial:PATH?baud=9600&parity=even&address=0x40&echo=auto", "serial:PATH"),
        ("serial:PATH?timeout=44&address=64", "serial:PATH"),
        ("serial:PATH?address=41h", "serial:PATH?address=0x41"),
    ];
    for (link, usual_left_out) in shorter {
        assert_eq!(form(link).url().unwrap().to_string(), usual_left_out);
        assert_eq!(form(usual_left_out), form(link));
    }
}

#[test]
fn entries_match_link() {
    let serial = form("serial:COM3?address=0x41&parity=odd&baud=19200");
    assert_eq!((serial.kind, serial.port.as_str(), serial.address.as_str()), (LinkKind::Serial, "COM3", "41"));
    assert_eq!((serial.parity, serial.baud.bits_per_second()), (Parity::Odd, 19200));
    assert_eq!(form("serial:COM3?address=255").address, "broadcast");
    let adapter = form("bridge:tcp:[::1]:4001?voltage=8");
    assert_eq!((adapter.kind, adapter.network, adapter.host.as_str()), (LinkKind::Adapter, true, "[::1]"));
    assert_eq!(adapter.typed.get("voltage"), "8");
    // Other kinds of connection cannot supply the encoder.
    let serial_again = LinkForm { kind: LinkKind::Serial, port: "COM3".to_owned(), ..adapter };
    assert_eq!(serial_again.url().unwrap().to_string(), "serial:COM3");
    let tcp = form("tcp:[::1]:4001");
    assert_eq!((tcp.host.as_str(), tcp.tcp_port.as_str()), ("[::1]", "4001"));
    assert_eq!(form("sim:"), LinkForm::default());
    assert_eq!(LinkForm::model_names().next(), Some(form("sim:").model.as_str()));
}

#[test]
fn entries_accept_common_notations() {
    for address in ["5f", "0x5F", "5Fh", " 5F "] {
        let written = LinkForm { address: address.to_owned(), ..form("serial:COM3") };
        assert_eq!(written.url().unwrap().to_string(), "serial:COM3?address=0x5F", "{address}");
    }
    let empty = LinkForm { address: String::new(), port: " COM3 ".to_owned(), ..form("serial:x") };
    assert_eq!(empty.url().unwrap().to_string(), "serial:COM3");
    let six = LinkForm { host: "::1".to_owned(), ..form("tcp:x:4001") };
    assert_eq!(six.url().unwrap().to_string(), "tcp:[::1]:4001");
    let mut comma = form("sim:");
    comma.typed.set("rpm", "12,5");
    assert_eq!(comma.url().unwrap().to_string(), "sim:?rpm=12.5");
}

#[test]
fn switching_link_kind_drops_other_settings() {
    let mut changed = form("sim:?model=sel37&rpm=60&seed=7&address=0x41");
    changed.kind = LinkKind::Serial;
    changed.port = "COM3".to_owned();
    assert_eq!(changed.url().unwrap().to_string(), "serial:COM3?address=0x41");
    changed.kind = LinkKind::Virtual;
    assert_eq!(changed.url().unwrap().to_string(), "sim:?model=sel37&rpm=60&address=0x41&seed=7");
}

#[test]
fn rejected_entries_list_allowed_values() {
    type Change = fn(&mut LinkForm);
    let cases: [(&str, Change, &str, &str); 23] = [
        ("serial:x", |f| f.port.clear(), "form.port_missing", "COM3"),
        ("serial:x", |f| f.port = "/dev/a?b".to_owned(), "form.characters", "/dev/a?b"),
        ("tcp:x:1", |f| f.host.clear(), "form.host_missing", "192.168.0.7"),
        ("tcp:x:1", |f| f.host = "10.0.0.1:4001".to_owned(), "form.host", "without the port"),
        ("tcp:x:1", |f| f.tcp_port.clear(), "form.tcp_port_missing", "65535"),
        (
            "tcp:x:1",
            |f| f.tcp_port = "99999".to_owned(),
            "form.tcp_port",
            "99999 is not a valid TCP port. Enter a number from 1",
        ),
        ("tcp:x:1", |f| f.tcp_port = "0".to_owned(), "form.tcp_port", "65535"),
        ("replay:x", |f| f.file.clear(), "form.file_missing", "recording"),
        ("serial:x", |f| f.address = "0x10".to_owned(), "form.address", "0x10 is not a valid address. Enter 40 to 5F"),
        ("serial:x", |f| f.address = "forty".to_owned(), "form.address", "forty"),
        ("sim:", |f| f.address = "broadcast".to_owned(), "form.address_virtual", "40 to 5F"),
        ("serial:x", |f| f.typed.set("margin", "2001"), "form.margin", "0 to 2000"),
        ("serial:x", |f| f.typed.set("periods", "0"), "form.periods", "134217728"),
        ("serial:x", |f| f.typed.set("turns", "4096"), "form.turns_alone", "4096"),
        ("serial:x?periods=134217728", |f| f.typed.set("turns", "2"), "form.turns", "2 is not a valid number of turns"),
        ("sim:", |f| f.model = "skm".to_owned(), "form.model", "skm36, sks36, sel37"),
        ("sim:", |f| f.typed.set("rpm", "fast"), "form.rpm", "-12000 to 12000"),
        ("sim:", |f| f.typed.set("fault", "drop:2"), "form.fault", "drop:2"),
        ("sim:", |f| f.typed.set("fault", "drop:1&x=1"), "form.characters", "drop:1&x=1"),
        ("serial:x?baud=115200", |_| (), "form.parameter", "baud=115200 is not valid (allowed: one of 600"),
        ("sim:?encoders=9", |_| (), "form.parameter", "encoders=9"),
        ("sim:?colour=green", |_| (), "form.other", "colour"),
        ("serial:x?colour=green", |_| (), "form.other", "colour"),
    ];
    for (link, change, id, words) in cases {
        let mut form = form(link);
        change(&mut form);
        let text = form.url().unwrap_err();
        assert_eq!(text.id(), id, "{form:?}");
        assert!(text.to_string_in(Language::English).contains(words), "{}", text.to_string_in(Language::English));
    }
}
