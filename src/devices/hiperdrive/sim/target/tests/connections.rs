//! Tests of the cyclic connection (reference, sections 7 and 9).

use super::*;

/// ForwardOpen, the packets in both directions, and ForwardClose match section 9 of the reference.
#[test]
fn published_connection_matches() {
    let mut host = Host::new("position=163840");
    // The socket item contains family 2, port 2222 and no address.
    host.is_asking(OPEN, &format!("{OPENED} 00 80 10 00 00 02 08 AE 00 00 00 00 00 00 00 00 00 00 00 00"));
    let ours = bytes(
        "02 00 02 80 08 00 01 00 02 00 01 00 00 00 B1 00 16 00 01 00 01 00 00 00 39 04 64 64 00 80 02 00 00 00 00 00 00 00 00 00",
    );
    let theirs =
        "02 00 02 80 08 00 01 00 01 00 01 00 00 00 B1 00 12 00 01 00 37 2A 00 00 00 80 02 00 00 00 00 00 00 00 00 00";
    // The first packet is sent one interval after the connection was opened.
    host.wait(4);
    assert_eq!(host.datagrams(), []);
    host.wait(1);
    let (to, first) = host.datagrams().pop().unwrap();
    assert_eq!(to, SocketAddrV4::new(PEER, 2222));
    assert_eq!(first, theirs.replace("37 2A", "30 2A"));
    let next = host.words(1, &[0x0000, 0x0400, 0x0401, 0x0409]);
    let mut packet = ours.clone();
    packet[10..14].copy_from_slice(&next.to_le_bytes());
    host.target.on_datagram(host.now, FROM, &packet);
    host.wait(10);
    let (_, last) = host.datagrams().pop().unwrap();
    // The fourteenth packet, 13 · 10 ms after the first.
    assert_eq!(
        last,
        theirs
            .replace("01 00 01 00 01 00 00 00 B1", "01 00 01 00 0E 00 00 00 B1")
            .replace("12 00 01 00", "12 00 0E 00")
    );
    assert_eq!(host.target.traffic_counters().packets, 13);
    host.is_asking(CLOSE, "CE 00 00 00 01 00 34 12 CD AB 00 00 00 00");
    host.is_asking(CLOSE, "CE 00 01 01 07 01 01 00 34 12 CD AB 00 00 00 00");
    host.datagrams();
    host.wait(50);
    assert_eq!(host.datagrams(), []);
}

/// Returns the ForwardOpen request from the reference with some bytes replaced.
fn open_with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(OPEN.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, to)
    })
}

#[test]
fn rejects_unsupported_connections() {
    let refused = |extended: &str| format!("D4 00 01 01 {extended} 01 00 34 12 CD AB 00 00 00 00");
    let assemblies = "04 20 04 24 68 2C 64 2C 65";
    for (label, changes, extended) in [
        ("other assemblies", &[("2C 65", "2C 66")][..], "17 01"),
        ("configuration 103", &[("24 68", "24 67")], "17 01"),
        ("class 5", &[("20 04", "20 05")], "17 01"),
        ("configuration data", &[(assemblies, "06 20 04 24 68 2C 64 2C 65 80 01 01 00")], "15 03"),
        ("to the target without parameter words", &[("16 48", "0E 48")], "28 01"),
        ("of a hub", &[("16 48", "2E 48")], "27 01"),
        ("back of a hub", &[("12 48", "2A 48")], "28 01"),
        ("5 bytes", &[("16 48", "05 48")], "27 01"),
        ("4999 us to the target", &[("10 27 00 00 16 48", "87 13 00 00 16 48")], "11 01"),
        ("100.001 ms back", &[("10 27 00 00 12 48", "A1 86 01 00 12 48")], "11 01"),
        ("multicast", &[("12 48", "12 28")], "08 01"),
        ("several owners", &[("16 48", "16 C8")], "08 01"),
        ("class 0", &[("12 48 01", "12 48 00")], "03 01"),
        ("change of state", &[("12 48 01", "12 48 11")], "03 01"),
        ("another maker", &[(assemblies, "09 34 04 01 00 0C 00 01 00 01 02 20 04 24 68 2C 64 2C 65")], "14 01"),
        ("another type", &[(assemblies, "09 34 04 F2 03 0D 00 00 00 00 00 20 04 24 68 2C 64 2C 65")], "15 01"),
        ("revision 2", &[(assemblies, "09 34 04 F2 03 0C 00 01 00 02 00 20 04 24 68 2C 64 2C 65")], "16 01"),
        ("revision 1.3", &[(assemblies, "09 34 04 F2 03 0C 00 01 00 81 03 20 04 24 68 2C 64 2C 65")], "16 01"),
    ] {
        let mut host = Host::new("");
        assert_eq!(host.open(&open_with(changes)), refused(extended), "{label}");
        assert_eq!(host.open(OPEN), OPENED, "{label}");
    }
    let mut host = Host::new("");
    host.is_asking(&OPEN.replace("CD AB 00 00 01 00 00 00", "CD AB 00 00 08 00 00 00"), "D4 00 09 00");
    host.is_asking(&OPEN[..OPEN.len() - 3], "D4 00 13 00");
    host.is_asking(&format!("{OPEN} 00"), "D4 00 15 00");
}

#[test]
fn accepts_supported_connections() {
    for (label, query, changes) in [
        ("5 ms", "", &[("10 27 00 00 16 48", "88 13 00 00 16 48")][..]),
        ("100 ms", "", &[("10 27 00 00 16 48", "A0 86 01 00 16 48"), ("10 27 00 00 12 48", "A0 86 01 00 12 48")]),
        ("without parameter words", "", &[("16 48", "0E 48"), ("12 48", "0A 48")]),
        // With parameter words, the lengths are 8 · 5 + 6 = 46 and 8 · 5 + 2 = 42 for a hub of four, and 8 · 9 + 6 = 78
        // and 8 · 9 + 2 = 74 for a hub of eight. Without them, they are 8 less.
        ("a hub of four", "hub=4", &[("16 48", "2E 48"), ("12 48", "2A 48")]),
        ("a hub of eight", "hub=8", &[("16 48", "4E 48"), ("12 48", "4A 48")]),
        ("that without words", "hub=8", &[("16 48", "46 48"), ("12 48", "42 48")]),
        ("no configuration", "", &[("04 20 04 24 68 2C", "03 20 04 2C")]),
        ("a key", "", &[("04 20 04 24 68", "09 34 04 F2 03 0C 00 01 00 81 02 20 04 24 68")]),
        ("a key of zeros", "", &[("04 20 04 24 68", "09 34 04 00 00 00 00 00 00 00 00 20 04 24 68")]),
    ] {
        let mut host = Host::new(query);
        let reply = host.open(&open_with(changes));
        assert!(reply.starts_with("D4 00 00 00 01 00 02 00 01 00 01 00 01 00 34 12"), "{label}: {reply}");
    }
}

#[test]
fn rejects_second_master() {
    let mut host = Host::opened("");
    assert_eq!(host.open(OPEN), "D4 00 01 01 00 01 01 00 34 12 CD AB 00 00 00 00");
    let other = OPEN.replace("34 12 CD AB", "34 12 CE AB");
    let mut second = Host { target: host.target.connect_from(Ipv4Addr::new(10, 0, 0, 8)), now: host.now, session: 0 };
    second.register();
    assert_eq!(second.open(&other), "D4 00 01 01 06 01 01 00 34 12 CE AB 00 00 00 00");
    second.is_asking(&CLOSE.replace("34 12 CD AB", "34 12 CE AB"), "CE 00 01 01 07 01 01 00 34 12 CE AB 00 00 00 00");
    // After 80 ms without a packet, the first connection has ended.
    second.wait(80);
    assert_eq!(second.open(&other), OPENED.replace("34 12 CD AB", "34 12 CE AB").replace("01 00 02 00", "02 00 02 00"));
}

#[test]
fn sends_cyclic_data_to_requested_address() {
    for (socket, expected) in [
        ("01 80 10 00 00 02 9C 41 00 00 00 00 00 00 00 00 00 00 00 00", SocketAddrV4::new(PEER, 40001)),
        ("01 80 10 00 00 02 9C 41 0A 00 00 63 00 00 00 00 00 00 00 00", "10.0.0.99:40001".parse().unwrap()),
    ] {
        let mut host = Host::new("");
        let mut data = unconnected(&bytes(OPEN));
        data[6] = 3;
        data.extend(bytes(socket));
        let (status, _) = host.frame(0x6F, &data).unwrap();
        host.wait(10);
        let to: Vec<SocketAddrV4> = host.datagrams().into_iter().map(|(to, _)| to).collect();
        assert_eq!((status, to), (0, vec![expected]));
    }
}

#[test]
fn ignores_packets_out_of_sequence() {
    let mut host = Host::opened("");
    let next = host.words(1, &[0x0400]);
    assert_eq!(host.status(), Some(0x2A31));
    // A repeated packet, an older packet, and a packet from before the first one.
    for sequence in [next - 1, next - 2, 0] {
        host.word(sequence, 0x0401);
    }
    // Packets that belong to another connection, are too short or too long, are not packets, or are truncated at any
    // length.
    host.packet_on_connection(0x0002_0002, next, 1, &[0; 16]);
    host.packet(next, 1, &[1; 15]);
    host.packet(next, 1, &[1; 17]);
    let whole = bytes(
        "02 00 02 80 08 00 01 00 02 00 09 00 00 00 B1 00 16 00 01 00 01 00 00 00 01 04 64 64 00 80 02 00 00 00 00 00 00 00 00 00",
    );
    for length in 0..whole.len() {
        host.target.on_datagram(host.now, FROM, &whole[..length]);
    }
    host.wait(10);
    assert_eq!(host.status(), Some(0x2A31));
    let figures = host.target.traffic_counters();
    assert_eq!((figures.packets, figures.stale, figures.foreign, figures.malformed), (3, 3, 1, 42));
    // A missing packet has no effect.
    host.word(next + 5, 0x0401);
    host.wait(10);
    assert_eq!(host.status(), Some(0x2A33));
}

/// Packets with an idle header have the same effect as control words of 0.
#[test]
fn idle_data_acts_as_zero_control_word() {
    let mut host = Host::opened("");
    let next = host.words(1, &[0x0400, 0x0401]);
    assert_eq!(host.status(), Some(0x2A33));
    host.packet(next, 0, &[1, 4, 100, 100, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    host.wait(10);
    assert_eq!(host.status(), Some(0x2A30));
}

/// The master is considered lost after 4 · 2 intervals (reference, section 7). The drive stops with a fault, which is
/// still present in the next connection.
#[test]
fn silent_master_times_out() {
    let mut host = Host::opened("");
    host.words(1, &[0x0400, 0x0401, 0x0409, 0x0439, 0x0479]);
    host.wait(60);
    assert_eq!(host.status().map(|status| status & 0x2000), Some(0), "it moves");
    // The time-out is 80 ms after the last packet, which was sent 70 ms ago.
    host.wait(9);
    assert!(!host.datagrams().is_empty());
    host.wait(1);
    host.wait(200);
    let stopped = host.items("0E 03 20 65 24 01 30 6B");
    assert_eq!(host.datagrams(), []);
    host.wait(1000);
    host.is_asking("0E 03 20 65 24 01 30 6B", &stopped);
    // The drive has not reached its target, and its fault is 8601.
    assert_ne!(stopped, "8E 00 00 00 00 80 02 00");
    host.is_asking("0E 03 20 65 24 01 30 6C", "8E 00 00 00 01 86");
    assert_eq!(host.open(OPEN), OPENED.replace("01 00 02 00 01", "02 00 02 00 01"));
}

/// Closing a TCP connection ends its session. The cyclic connection continues until its own time-out.
#[test]
fn cyclic_connection_outlives_tcp() {
    let mut host = Host::opened("");
    let other = host.target.connect_from(PEER);
    let session = host.session;
    let now = host.now;
    drop(std::mem::replace(&mut host, Host { target: other, now, session }));
    assert_eq!(host.frame(0x6F, &unconnected(&bytes(CLOSE))).map(|(status, _)| status), Some(0x64));
    host.words(1, &[0x0400, 0x0401]);
    assert_eq!(host.status(), Some(0x2A33));
    host.register();
    host.is_asking(CLOSE, "CE 00 00 00 01 00 34 12 CD AB 00 00 00 00");
}

/// A position of 2.5 turns is transmitted with the high byte first (reference, section 2).
#[test]
fn uses_requested_byte_order() {
    let mut host = Host::opened("order=big&position=163840");
    host.packet(1, 1, &bytes("04 00 64 64 00 02 80 00 00 00 00 00 00 00 00 00"));
    host.wait(10);
    let (_, packet) = host.datagrams().pop().unwrap();
    assert!(packet.ends_with("2A 31 00 00 00 02 80 00 00 00 00 00 00 00 00 00"), "{packet}");
}

/// A read of parameter 166 matches section 9 of the reference.
#[test]
fn answers_parameter_words_in_process_data() {
    let mut host = Host::opened("");
    host.packet(1, 1, &bytes("00 00 64 64 00 00 00 00 A6 10 00 00 00 00 00 00"));
    host.wait(10);
    let (_, packet) = host.datagrams().pop().unwrap();
    assert!(packet.ends_with("A6 10 00 00 5E 01 00 00"), "{packet}");
}
