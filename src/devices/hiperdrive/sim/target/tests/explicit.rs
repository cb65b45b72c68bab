//! Tests of frames and explicit messages (reference, sections 7 and 9).

use super::*;

/// RegisterSession and a read of parameter 107 in that session match section 9 of the reference.
#[test]
fn published_frames_match() {
    let mut host = Host::bare("position=163840");
    let mut reply = host.bytes(&bytes(REGISTER));
    let session: [u8; 4] = reply[4..8].try_into().unwrap();
    assert_ne!(session, [0; 4]);
    reply[4..8].fill(0);
    assert_eq!(hex(&reply), REGISTER);
    let get = "6F 00 18 00 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 02 00 00 00 00 00 B2 00 \
               08 00 0E 03 20 65 24 01 30 6B";
    let mut request = bytes(get);
    // The session number does not belong to this connection.
    assert_eq!(host.bytes(&request)[8..12], [0x64, 0, 0, 0]);
    request[4..8].copy_from_slice(&session);
    let mut expected = bytes(&get.replace("0E 03 20 65 24 01 30 6B", "8E 00 00 00 00 80 02 00"));
    expected[4..8].copy_from_slice(&session);
    assert_eq!(hex(&host.bytes(&request)), hex(&expected));
    // A request may arrive in pieces, or together with another one.
    let (first, second) = request.split_at(30);
    assert_eq!(host.bytes(first), [0; 0]);
    assert_eq!(host.bytes(&[second, &request].concat()), [&expected[..], &expected].concat());
}

/// CIP requests and replies match section 9 of the reference.
#[test]
fn published_requests_match() {
    let mut host = Host::new("position=163840");
    host.is_asking("0E 03 20 65 24 01 30 6B", "8E 00 00 00 00 80 02 00");
    host.is_asking("0E 03 20 64 24 01 30 2F", "8E 00 00 00 00 00");
    host.is_asking("10 03 20 65 24 01 30 9E 00 00 01 FE", "90 00 00 00");
    host.is_asking("0E 03 20 65 24 01 30 9E", "8E 00 00 00 00 00 01 FE");
    // A lower limit (158) above the position is rejected, and the drive stores error 8501.
    host.is_asking("10 03 20 65 24 01 30 9E FF FF FF 7F", "90 00 09 00");
    host.is_asking("0E 03 20 65 24 01 30 6C", "8E 00 00 00 01 85");
    host.is_asking("10 03 20 65 24 01 30 65 00 04", "90 00 00 00");
    host.is_asking("0E 03 20 65 24 01 30 69", "8E 00 00 00 B1 2A");
    host.is_asking("10 03 20 65 24 01 30 98 01", "90 00 00 00");
    host.is_asking("10 03 20 64 24 01 30 2F 01 00", "90 00 00 00");
    host.is_asking("0E 03 20 64 24 01 30 2F", "8E 00 00 00 01 00");
    // During a save, writes are rejected. Afterwards, parameter 47 is 0 again.
    host.is_asking("10 03 20 65 24 01 30 98 01", "90 00 0C 00");
    host.wait(200);
    host.is_asking("0E 03 20 64 24 01 30 2F", "8E 00 00 00 00 00");
    host.is_asking("0E 03 20 F5 24 01 30 03", "8E 00 00 00 02 00 00 00");
}

/// According to the manual, the reply to a reset of the drives is sent when the reset is complete. Meanwhile, other
/// requests are answered without delay (issue 21.8).
#[test]
fn reset_replies_on_completion() {
    for (query, ms) in [("", 1000), ("reset=8000", 8000), ("hub=8&reset=8000", 8000)] {
        let mut host = Host::new(query);
        let reset = frame(0x6F, host.session, &unconnected(&bytes("10 03 20 64 24 01 30 2F FC FF")));
        assert!(host.bytes(&reset).is_empty(), "{query}");
        host.is_asking("0E 03 20 64 24 01 30 2F", "8E 00 00 00 01 00");
        // The request arrived 10 ms ago, and its reply takes 1 ms.
        host.wait(ms - 10);
        assert!(host.target.poll(host.now).is_empty(), "{query}");
        host.wait(1);
        let reply = host.target.poll(host.now);
        assert_eq!(hex(&reply[reply.len() - 4..]), "90 00 00 00", "{query}");
        host.is_asking("0E 03 20 64 24 01 30 2F", "8E 00 00 00 00 00");
    }
    // The same applies to a reset of one drive through parameter 152 (from 0 to 1) or 199.
    let mut host = Host::new("requested=0");
    for (set, is_slow) in [("98 01", true), ("98 01", false), ("C7 00", true)] {
        let set = frame(0x6F, host.session, &unconnected(&bytes(&format!("10 03 20 65 24 01 30 {set}"))));
        assert_eq!(host.bytes(&set).is_empty(), is_slow, "{set:?}");
        host.wait(300);
        assert_eq!(host.target.poll(host.now).is_empty(), !is_slow, "{set:?}");
    }
}

#[test]
fn rejects_impossible_requests_with_status() {
    let mut host = Host::new("");
    for (label, request, reply) in [
        ("166 = 200", "10 03 20 65 24 01 30 A6 C8 00", "90 00 00 00"),
        ("too little", "10 03 20 65 24 01 30 A6 C8", "90 00 13 00"),
        ("too much", "10 03 20 65 24 01 30 A6 C8 00 00", "90 00 15 00"),
        ("166 = 351", "10 03 20 65 24 01 30 A6 5F 01", "90 00 09 00"),
        ("107 is read", "10 03 20 65 24 01 30 6B 00 00 00 00", "90 00 0E 00"),
        ("121 is read", "10 03 20 65 24 01 30 79 41", "90 00 0E 00"),
        ("199 is written", "0E 03 20 65 24 01 30 C7", "8E 00 2C 00"),
        ("no parameter", "0E 03 20 65 24 01 30 6A", "8E 00 00 00 00 00"),
        ("no parameter 130", "0E 03 20 65 24 01 30 82", "8E 00 14 00"),
        ("no parameter 107 of the device", "0E 03 20 64 24 01 30 6B", "8E 00 14 00"),
        ("no attribute", "0E 02 20 65 24 01", "8E 00 14 00"),
        ("no drive 2", "0E 03 20 66 24 01 30 6B", "8E 00 05 00"),
        ("instance 2", "0E 03 20 65 24 02 30 6B", "8E 00 05 00"),
        ("no class", "0E 03 20 77 24 01 30 01", "8E 00 05 00"),
        ("no service", "0D 03 20 65 24 01 30 6B", "8D 00 08 00"),
        ("all of a parameter", "01 02 20 65 24 01", "81 00 08 00"),
        ("a port in the path", "0E 02 01 00 20 65", "8E 00 04 00"),
        ("a path cut off", "0E 03 20 65", "8E 00 04 00"),
        ("the manager has no attributes", "0E 03 20 06 24 01 30 01", "8E 00 08 00"),
        ("no long ForwardOpen", "5B 02 20 06 24 01", "DB 00 08 00"),
    ] {
        assert_eq!(host.items(request), reply, "{label}");
    }
}

/// The class of drive n is n higher than the class of the device (reference, section 7).
#[test]
fn hub_drives_have_consecutive_classes() {
    let mut host = Host::new("hub=8&drives=1,0,1,1,1,1,1,1&position=65536&variant=HDA70&requested=1");
    host.is_asking("0E 03 20 65 24 01 30 6B", "8E 00 00 00 00 00 01 00");
    host.is_asking("0E 03 20 66 24 01 30 6B", "8E 00 0C 00");
    host.is_asking("0E 03 20 66 24 01 30 78", "8E 00 00 00 00 00");
    host.is_asking("0E 03 20 66 24 01 30 98", "8E 00 00 00 00");
    host.is_asking("0E 03 20 67 24 01 30 6B", "8E 00 00 00 00 00 01 00");
    host.is_asking("0E 03 20 6C 24 01 30 65", "8E 00 00 00 00 00");
    host.is_asking("0E 03 20 6C 24 01 30 6B", "8E 00 00 00 00 00 01 00");
    host.is_asking("0E 03 20 6C 24 01 30 78", "8E 00 00 00 0D 00");
    host.is_asking("0E 03 20 6C 24 01 30 98", "8E 00 00 00 01");
    host.is_asking("0E 03 20 6D 24 01 30 6B", "8E 00 05 00");
    // "HIPERDRIVE HUB-8"
    host.is_asking("0E 03 20 64 24 01 30 0D", "8E 00 00 00 48 49 50 45 52 44 52 49 56 45 20 48 55 42 2D 38");
    let mut four = Host::new("hub=4&text=counted");
    four.is_asking("0E 03 20 69 24 01 30 6B", "8E 00 05 00");
    four.is_asking("0E 03 20 64 24 01 30 0D", "8E 00 00 00 10 48 49 50 45 52 44 52 49 56 45 20 48 55 42 2D 34");
}

/// Identity object, composed by hand: vendor 03F2, type 000C, code 1, revision 1.2, status, serial number 4711 = 1267h,
/// and the 17 characters of "HIPERDRIVE SINGLE".
const IDENTITY: &str =
    "F2 03 0C 00 01 00 01 02 30 00 67 12 00 00 11 48 49 50 45 52 44 52 49 56 45 20 53 49 4E 47 4C 45";

#[test]
fn reports_identity_over_tcp_udp_and_cip() {
    let mut host = Host::new("");
    host.target.set_address(SocketAddrV4::new(Ipv4Addr::new(192, 168, 1, 17), 44818));
    host.is_asking("01 02 20 01 24 01", &format!("81 00 00 00 {IDENTITY}"));
    host.is_asking("0E 03 20 01 24 01 30 01", "8E 00 00 00 F2 03");
    host.is_asking("0E 03 20 01 24 01 30 08", "8E 00 14 00");
    host.is_asking("10 03 20 01 24 01 30 01 00 00", "90 00 0E 00");
    let item = format!("01 00 00 02 AF 12 C0 A8 01 11 00 00 00 00 00 00 00 00 {IDENTITY} 03");
    // The item has 2 + 16 + 32 + 1 bytes.
    let expected = format!("01 00 0C 00 33 00 {item}");
    // This request needs no session.
    host.session = 0;
    assert_eq!(host.frame(0x63, &[]).map(|(status, data)| (status, hex(&data))), Some((0, expected.clone())));
    let mut request = frame(0x63, 0, &[]);
    request[12..20].copy_from_slice(b"whoisit?");
    host.target.on_datagram(host.now, FROM, &request);
    let told = host.datagrams();
    let head = "63 00 39 00 00 00 00 00 00 00 00 00 77 68 6F 69 73 69 74 3F 00 00 00 00";
    assert_eq!(told, [(FROM, format!("{head} {expected}"))]);
}

#[test]
fn answers_or_ignores_other_commands() {
    let mut host = Host::new("");
    // The reply to ListServices: item 0100h, version 1, capability 0120h.
    let services = "01 00 00 01 14 00 01 00 20 01 43 6F 6D 6D 75 6E 69 63 61 74 69 6F 6E 73 00 00";
    assert_eq!(host.frame(0x04, &[]).map(|(_, data)| hex(&data)), Some(services.to_owned()));
    assert_eq!(host.frame(0x64, &[]), Some((0, vec![0, 0])));
    assert_eq!(host.frame(0x00, &[1, 2, 3]), None);
    assert_eq!(host.frame(0x72, &[]), Some((0x01, vec![])));
    assert_eq!(host.frame(0x6F, &bytes("00 00 00 00")), Some((0x03, vec![])));
    assert_eq!(host.frame(0x6F, &unconnected(&[])), Some((0x03, vec![])));
    // A request for a second session on the same connection, and one with another protocol version.
    let again = host.bytes(&bytes(REGISTER));
    assert_eq!(again[4..12], [&host.session.to_le_bytes()[..], &[1, 0, 0, 0]].concat());
    let mut other = Host { target: host.target.clone(), now: host.now, session: 0 };
    assert_eq!(other.frame(0x65, &bytes("02 00 00 00")), Some((0x69, vec![])));
    // A session is only valid on its own connection.
    other.session = host.session;
    assert_eq!(other.frame(0x6F, &unconnected(&bytes("0E 03 20 65 24 01 30 6B"))).map(|(s, _)| s), Some(0x64));
    // A frame with options is invalid.
    let mut void = frame(0x63, 0, &[]);
    void[20] = 1;
    assert_eq!(host.bytes(&void), [0; 0]);
    assert!(!host.target.has_ended());
    assert_eq!(host.frame(0x66, &[]), None);
    assert!(host.target.has_ended());
    host.target.connect(host.now);
    assert_eq!(host.frame(0x6F, &unconnected(&bytes("0E 03 20 65 24 01 30 6B"))).map(|(s, _)| s), Some(0x64));
    host.register();
    host.is_asking("0E 03 20 65 24 01 30 6B", "8E 00 00 00 00 00 00 00");
}

/// According to ODVA, attribute 5 can be set only while attribute 3 selects the stored address.
#[test]
fn writes_network_settings() {
    let mut host = Host::new("switch=17");
    host.is_asking("0E 03 20 F5 24 01 30 03", "8E 00 00 00 02 00 00 00");
    // 192.168.1.17 and 255.255.255.0 with the low byte first, no further addresses, and an empty name.
    let fixed = "11 01 A8 C0 00 FF FF FF 00 00 00 00 00 00 00 00 00 00 00 00 00 00";
    host.is_asking("0E 03 20 F5 24 01 30 05", &format!("8E 00 00 00 {fixed}"));
    // 10.0.0.5, 255.0.0.0, 10.0.0.1, no servers, "plant".
    let wanted = "05 00 00 0A 00 00 00 FF 01 00 00 0A 00 00 00 00 00 00 00 00 05 00 70 6C 61 6E 74 00";
    host.is_asking(&format!("10 03 20 F5 24 01 30 05 {wanted}"), "90 00 0C 00");
    host.is_asking("10 03 20 F5 24 01 30 03 03 00 00 00", "90 00 09 00");
    host.is_asking("10 03 20 F5 24 01 30 03 00 00", "90 00 13 00");
    host.is_asking("10 03 20 F5 24 01 30 03 00 00 00 00", "90 00 00 00");
    host.is_asking(&format!("10 03 20 F5 24 01 30 05 {wanted}"), "90 00 00 00");
    host.is_asking("0E 03 20 F5 24 01 30 05", &format!("8E 00 00 00 {wanted}"));
    host.is_asking("0E 03 20 F5 24 01 30 04", "8E 00 00 00 02 00 20 F6 24 01");
    host.is_asking("0E 03 20 F6 24 01 30 03", "8E 00 00 00 02 00 00 00 12 67");
    // −3 restores all factory settings.
    host.is_asking("10 03 20 64 24 01 30 2F FD FF", "90 00 00 00");
    host.is_asking("0E 03 20 F5 24 01 30 03", "8E 00 00 00 02 00 00 00");
}

/// Controllers use Unconnected_Send and class 3 connections, so these are supported.
#[test]
fn answers_wrapped_and_connected_messages() {
    let mut host = Host::new("position=163840");
    host.is_asking("52 02 20 06 24 01 0A 05 08 00 0E 03 20 65 24 01 30 6B 00 00", "8E 00 00 00 00 80 02 00");
    host.is_asking("52 02 20 06 24 01 0A 05 09 00 10 03 20 65 24 01 30 98 01 00 01 00 01 00", "90 00 00 00");
    host.is_asking("52 02 20 06 24 01 0A 05 09 00 0E 03", "D2 00 13 00");
    let open = "54 02 20 06 24 01 0A 05 00 00 00 00 27 04 19 71 27 04 09 10 09 10 19 71 07 00 00 00 01 40 20 00 F4 43 \
                01 40 20 00 F4 43 A3 02 20 02 24 01";
    let opened = "D4 00 00 00 01 00 02 00 27 04 19 71 27 04 09 10 09 10 19 71 01 40 20 00 01 40 20 00 00 00";
    host.is_asking(open, opened);
    host.is_asking(open, "D4 00 01 01 00 01 27 04 09 10 09 10 19 71 00 00");
    let message = "00 00 00 00 00 00 02 00 A1 00 04 00 01 00 02 00 B1 00 0A 00 2A 00 0E 03 20 65 24 01 30 6B";
    let expected = "00 00 00 00 00 00 02 00 A1 00 04 00 27 04 19 71 B1 00 0A 00 2A 00 8E 00 00 00 00 80 02 00";
    assert_eq!(host.frame(0x70, &bytes(message)).map(|(s, data)| (s, hex(&data))), Some((0, expected.to_owned())));
    host.is_asking(
        "4E 02 20 06 24 01 0A 05 27 04 09 10 09 10 19 71 02 00 20 02 24 01",
        "CE 00 00 00 27 04 09 10 09 10 19 71 00 00",
    );
    assert_eq!(host.frame(0x70, &bytes(message)), None);
}
