//! Tests with the packets of the reference in both directions, and with packets composed by hand from the field tables.
//! Expected values never come from the code under test.

use core::net::Ipv4Addr;
use std::time::Duration;

use super::*;
use crate::bits::{hex, parse_hex};

mod any;

const SESSION: u32 = 0x1234_5678;
const OWNER: ConnectionOwner = ConnectionOwner { connection_serial: 1, vendor: 0x1234, serial_number: 0x0000_ABCD };

fn bytes(text: &str) -> Vec<u8> {
    parse_hex(text).unwrap()
}

/// The frames are from reference 9: RegisterSession and its reply, a request in a session, and ListIdentity.
#[test]
fn published_frames_match() {
    let zeros = "00 ".repeat(20);
    let register = format!("65 00 04 00 {zeros} 01 00 00 00");
    let get = format!(
        "6F 00 18 00 78 56 34 12 {} 00 00 00 00 00 00 02 00 00 00 00 00 B2 00 08 00 0E 03 20 65 24 01 30 6B",
        "00 ".repeat(16)
    );
    let asked = Request::get(0x65, 1, 0x6B);
    let cases = [
        ("register", register.clone(), Frame::register([0; 8])),
        ("list identity", format!("63 00 00 00 {zeros}"), Frame::list_identity([0; 8])),
        ("get 107", get, Frame::unconnected_message(SESSION, [0; 8], asked.emit())),
    ];
    for (label, text, frame) in cases {
        assert_eq!(hex(&frame.emit()), hex(&bytes(&text)), "{label}");
        assert_eq!(Frame::parse(&bytes(&text)), Ok(frame), "{label}");
    }
    let request = Frame::parse(&bytes(&register)).unwrap();
    assert_eq!(request.parse_body(), Ok(Body::Register { version: 1, options: 0 }));
    let reply = bytes(&register.replacen("00 04 00 00 00 00 00", "00 04 00 78 56 34 12", 1));
    let given = Frame { session: SESSION, ..request.reply(&request.parse_body().unwrap()) };
    assert_eq!(hex(&given.emit()), hex(&reply));
    assert!(Frame::parse(&reply).unwrap().is_reply_to(&request));
    assert_eq!(
        Request::parse(Frame::unconnected_message(1, [0; 8], asked.emit()).parse_body().unwrap().message().unwrap()),
        Ok(asked)
    );
}

/// A reply to an earlier request, from another session or to another command does not match.
#[test]
fn reply_matches_only_its_request() {
    let request = Frame::unconnected_message(SESSION, [7; 8], vec![0x0E]);
    assert!(request.error_reply(EncapsulationStatus::NO_SESSION).is_reply_to(&request));
    let other = |change: fn(&mut Frame)| {
        let mut frame = request.clone();
        change(&mut frame);
        frame.is_reply_to(&request)
    };
    assert!(!other(|frame| frame.context = [6; 8]));
    assert!(!other(|frame| frame.session = 1));
    assert!(!other(|frame| frame.command = Command::REGISTER_SESSION));
    assert_eq!(Frame::unregister_session(SESSION).emit()[..8], bytes("66 00 00 00 78 56 34 12"));
}

/// The CIP requests are from reference 9.
#[test]
fn published_requests_match() {
    let cases = [
        ("get 107", "0E 03 20 65 24 01 30 6B", Request::get(0x65, 1, 107)),
        ("get 47", "0E 03 20 64 24 01 30 2F", Request::get(0x64, 1, 47)),
        ("get 207", "0E 03 20 66 24 01 30 6B", Request::get(0x66, 1, 0x6B)),
        ("set 158", "10 03 20 65 24 01 30 9E 00 00 01 FE", Request::set_attribute(0x65, 1, 0x9E, bytes("00 00 01 FE"))),
        ("set 101", "10 03 20 65 24 01 30 65 00 04", Request::set_attribute(0x65, 1, 101, bytes("00 04"))),
        ("set 152", "10 03 20 65 24 01 30 98 01", Request::set_attribute(0x65, 1, 152, vec![1])),
        ("set 47", "10 03 20 64 24 01 30 2F 01 00", Request::set_attribute(0x64, 1, 47, vec![1, 0])),
        ("control", "0E 03 20 F5 24 01 30 03", Request::get(ConfigurationControl::CLASS, 1, 3)),
        // Composed by hand: a class or an attribute above 255 is encoded as a wide segment, with 21 00 or 31 00 before
        // the number.
        ("wide", "0E 05 21 00 2C 01 24 01 31 00 34 12", Request::get(0x012C, 1, 0x1234)),
        ("all", "01 02 20 01 24 01", Request::get_all(Identity::CLASS, 1)),
    ];
    for (label, text, request) in cases {
        assert_eq!(hex(&request.emit()), text, "{label}");
        assert_eq!(Request::parse(&bytes(text)), Ok(request), "{label}");
    }
    let position = Reply::parse(&bytes("8E 00 00 00 00 80 02 00")).unwrap();
    assert_eq!(position, Request::get(0x65, 1, 107).success_reply(bytes("00 80 02 00")));
    assert_eq!(hex(&position.emit()), "8E 00 00 00 00 80 02 00");
    let set = Request::set_attribute(0x65, 1, 0x9E, Vec::new());
    for (text, reply) in
        [("90 00 00 00", set.success_reply(Vec::new())), ("90 00 09 00", set.error_reply(GeneralStatus::INVALID_VALUE))]
    {
        assert_eq!((Reply::parse(&bytes(text)), hex(&reply.emit())), (Ok(reply), text.to_owned()));
    }
    assert!(matches!(Request::parse(&[0x8E, 0]), Err(PacketError::Value { got: 0x8E, .. })));
    assert!(matches!(Reply::parse(&[0x0E, 0, 0, 0]), Err(PacketError::Value { got: 0x0E, .. })));
}

/// A number may be encoded in a wider form than necessary, and its width is preserved. Unknown segments are preserved
/// as received.
#[test]
fn every_path_round_trips() {
    for (label, text, segments) in [
        ("wide small", "21 00 04 00 24 01", 2),
        ("key", "34 04 F2 03 0C 00 01 00 81 02 20 04 24 68", 3),
        ("data", "20 04 24 68 80 02 01 02 03 04", 3),
        ("port", "01 00 20 06 24 01", 1),
        ("wide instance", "20 06 26 00 01 00 00 00", 2),
    ] {
        let path = EPath::parse(&bytes(text)).unwrap();
        assert_eq!((path.0.len(), hex(&path.emit())), (segments, text.to_owned()), "{label}");
    }
    let key = ElectronicKey { vendor: 1010, device_type: 12, product_code: 1, major: 0x81, minor: 2 };
    let path = EPath::parse(&bytes("34 04 F2 03 0C 00 01 00 81 02")).unwrap();
    assert_eq!(path, EPath(vec![Segment::Key(key)]));
    let assemblies = EPath::to_assemblies(104, 100, 101);
    assert_eq!(hex(&assemblies.emit()), "20 04 24 68 2C 64 2C 65");
    assert_eq!(assemblies.values_of(LogicalKind::ConnectionPoint).collect::<Vec<_>>(), [100, 101]);
    for cut in ["20", "21 00", "21 01 04 00", "34 04 00", "80 02 00 00"] {
        assert!(EPath::parse(&bytes(cut)).is_err(), "{cut}");
    }
    assert_eq!(
        Request::parse(&bytes("0E 03 20 65 24 01")),
        Err(PacketError::Short { what: Structure::CipRequest, got: 6 })
    );
}

fn open() -> ForwardOpen {
    let parameters =
        |size| NetworkParameters::new(NetworkType::PointToPoint, NetworkPriority::Scheduled, size).unwrap();
    ForwardOpen {
        timeout: RequestTimeout::TWO_SECOND_TIMEOUT,
        to_target_id: 0,
        to_originator_id: 0x0001_0001,
        owner: OWNER,
        connection_timeout: ConnectionTimeout::new(1).unwrap(),
        to_target_interval_us: 10_000,
        to_target: parameters(22),
        to_originator_interval_us: 10_000,
        to_originator: parameters(18),
        transport: Transport::CYCLIC,
        path: EPath::to_assemblies(104, 100, 101),
    }
}

/// The packets are a ForwardOpen request of 50 bytes, its reply, and a ForwardClose request (reference 9).
#[test]
fn published_connection_matches() {
    let text = "54 02 20 06 24 01 03 FA 00 00 00 00 01 00 01 00 01 00 34 12 CD AB 00 00 01 00 00 00 10 27 00 00 16 48 \
                10 27 00 00 12 48 01 04 20 04 24 68 2C 64 2C 65";
    assert_eq!(hex(&open().request().emit()), text);
    let request = Request::parse(&bytes(text)).unwrap();
    assert_eq!((request.service, request.class_id()), (Service::FORWARD_OPEN, Some(6)));
    let parsed = ForwardOpen::parse(&request.data).unwrap();
    assert_eq!(parsed, open());
    assert_eq!(parsed.timeout.duration(), Duration::from_secs(2));
    // The interval is 10 ms, and multiplier 1 means 4 · 2 intervals.
    assert_eq!(parsed.target_timeout(), Duration::from_millis(80));

    let text = "D4 00 00 00 01 00 02 00 01 00 01 00 01 00 34 12 CD AB 00 00 10 27 00 00 10 27 00 00 00 00";
    let opened = ForwardOpenSuccess {
        to_target_id: 0x0002_0001,
        to_originator_id: 0x0001_0001,
        owner: OWNER,
        to_target_interval_us: 10_000,
        to_originator_interval_us: 10_000,
        application: Vec::new(),
    };
    assert_eq!(hex(&request.success_reply(opened.emit()).emit()), text);
    assert_eq!(ForwardOpenSuccess::parse(&Reply::parse(&bytes(text)).unwrap().data), Ok(opened));

    let text = "4E 02 20 06 24 01 03 FA 01 00 34 12 CD AB 00 00 04 00 20 04 24 68 2C 64 2C 65";
    let close = ForwardClose {
        timeout: RequestTimeout::TWO_SECOND_TIMEOUT,
        owner: OWNER,
        path: EPath::to_assemblies(104, 100, 101),
    };
    assert_eq!(hex(&close.request().emit()), text);
    assert_eq!(ForwardClose::parse(&Request::parse(&bytes(text)).unwrap().data), Ok(close));
}

/// The two replies are composed by hand from their fields: connection serial 0001, vendor 1234h and serial number
/// ABCDh, followed by 0 words and a reserved byte, or by the number of remaining path words and a reserved byte. The
/// rejection has status 01 and one extended status word, 0106h.
#[test]
fn connection_closes_or_fails() {
    let text = "CE 00 00 00 01 00 34 12 CD AB 00 00 00 00";
    let closed = ForwardCloseSuccess { owner: OWNER, application: Vec::new() };
    let reply = Reply::parse(&bytes(text)).unwrap();
    assert_eq!((ForwardCloseSuccess::parse(&reply.data), reply.service), (Ok(closed.clone()), Service::FORWARD_CLOSE));
    assert_eq!(closed.emit(), reply.data);

    let text = "D4 00 01 01 06 01 01 00 34 12 CD AB 00 00 04 00";
    let refused = ForwardErrorReply { owner: OWNER, remaining_path_words: 4 };
    assert_eq!(hex(&refused.reply(&open().request(), 0x0106).emit()), text);
    let reply = Reply::parse(&bytes(text)).unwrap();
    assert_eq!(ForwardErrorReply::parse(&reply.data), Ok(refused));
    let row = find_extended_status(reply.service, reply.status, reply.extended[0]).unwrap();
    assert_eq!(row.meaning, "another master owns the outputs");
    assert!(find_extended_status(Service::GET, reply.status, 0x0106).is_none());
    let mut wrong = open().request().data;
    wrong[18] = 8;
    let field = PacketField::TimeoutMultiplier;
    assert_eq!(ForwardOpen::parse(&wrong), Err(PacketError::Value { what: Structure::ForwardOpen, field, got: 8 }));
}

/// Covers all sizes in the table of reference 7, bit by bit, and the multicast variant.
#[test]
fn published_network_parameters_match() {
    use NetworkType::{Multicast, PointToPoint};
    for (kind, size, word) in [
        (PointToPoint, 22, 0x4816),
        (PointToPoint, 18, 0x4812),
        (PointToPoint, 14, 0x480E),
        (PointToPoint, 10, 0x480A),
        (Multicast, 18, 0x2812),
    ] {
        let parameters = NetworkParameters::new(kind, NetworkPriority::Scheduled, size).unwrap();
        assert_eq!(parameters.to_bits(), word);
        assert_eq!((parameters.kind(), parameters.priority()), (kind, NetworkPriority::Scheduled), "{word:04X}");
        assert_eq!(
            (parameters.size(), parameters.is_variable(), parameters.has_redundant_owner()),
            (size, false, false)
        );
    }
    // For 16 and 8 bytes of process data, packets to the target have 2 + 4 more bytes, and packets to the originator
    // have 2 more.
    assert_eq!([16, 8].map(|data| data + IoPacket::size_overhead(RealTimeFormat::Header)), [22, 14]);
    assert_eq!([16, 8].map(|data| data + IoPacket::size_overhead(RealTimeFormat::Modeless)), [18, 10]);
    assert_eq!(NetworkParameters::new(Multicast, NetworkPriority::Low, 512), None);
    let odd = NetworkParameters::from_word(0xFE05);
    assert_eq!((odd.kind(), odd.priority()), (NetworkType::Reserved, NetworkPriority::Urgent));
    assert!(odd.is_variable() && odd.has_redundant_owner() && odd.to_bits() == 0xFE05);
    let intervals: Vec<u32> =
        (0..=8).filter_map(ConnectionTimeout::new).map(ConnectionTimeout::interval_multiplier).collect();
    assert_eq!(intervals, [4, 8, 16, 32, 64, 128, 256, 512]);
    assert_eq!(
        (Transport::CYCLIC.transport_class(), Transport::CYCLIC.trigger(), Transport::CYCLIC.is_server()),
        (1, Trigger::Cyclic, false)
    );
    let other = Transport::from_byte(0xA3);
    assert_eq!((other.transport_class(), other.trigger(), other.is_server()), (3, Trigger::Application, true));
}

/// The cyclic packets are from reference 9, in both directions.
#[test]
fn published_cyclic_packets_match() {
    let to_target = "02 00 02 80 08 00 01 00 02 00 01 00 00 00 B1 00 16 00 01 00 01 00 00 00 39 04 64 64 00 80 02 00 00 00 \
                     00 00 00 00 00 00";
    let back =
        "02 00 02 80 08 00 01 00 01 00 01 00 00 00 B1 00 12 00 01 00 37 2A 00 00 00 80 02 00 00 00 00 00 00 00 00 00";
    let cases = [
        (to_target, RealTimeFormat::Header, 0x0002_0001, Some(RunIdleHeader::RUN), "39 04 64 64 00 80 02 00"),
        (back, RealTimeFormat::Modeless, 0x0001_0001, None, "37 2A 00 00 00 80 02 00"),
    ];
    for (text, format, connection, header, data) in cases {
        let data = [bytes(data), vec![0; 8]].concat();
        let packet = IoPacket { connection, sequence: 1, count: 1, header, data };
        assert_eq!(hex(&packet.emit()), text);
        assert_eq!(IoPacket::parse(&bytes(text), format), Ok(packet));
    }
    assert!(RunIdleHeader::RUN.is_running() && !RunIdleHeader::IDLE.is_running());
    let short =
        ItemList(vec![Item::SequencedAddress { connection: 1, sequence: 1 }, Item::ConnectedData(vec![1, 0, 1])]);
    let cut = Err(PacketError::Short { what: Structure::CyclicPacket, got: 3 });
    assert_eq!(IoPacket::parse(&short.emit(), RealTimeFormat::Header), cut);
    let ItemList(items) = short;
    let turned = ItemList(items.into_iter().rev().collect()).emit();
    assert!(IoPacket::parse(&turned, RealTimeFormat::Modeless).is_err(), "the address comes first");
}

/// The item is composed by hand from its fields: version 1; socket with AF_INET, port 44818 = AF12h, 192.168.1.5 and
/// eight zeros; vendor 1010 = 03F2h, type 12, product 1, revision 1.2, status 0030h, serial number 4711 = 1267h, a name
/// of 10 characters, and state 3. It has 2 + 16 + 14 + 1 + 10 + 1 = 44 = 2Ch bytes, and the data of the frame have 2 +
/// 4 + 44 = 50 = 32h bytes.
#[test]
fn parses_identity_item() {
    let item = "01 00 00 02 AF 12 C0 A8 01 05 00 00 00 00 00 00 00 00 F2 03 0C 00 01 00 01 02 30 00 67 12 00 00 0A 48 49 50 \
                45 52 44 52 49 56 45 03";
    let text = format!("63 00 32 00 {} 01 00 0C 00 2C 00 {item}", "00 ".repeat(20));
    let frame = Frame::parse(&bytes(&text)).unwrap();
    let Body::List(items) = frame.parse_body().unwrap() else { panic!("no list") };
    let expected = IdentityItem {
        version: 1,
        socket: SocketAddress::new(Ipv4Addr::new(192, 168, 1, 5), EXPLICIT_MESSAGE_PORT),
        identity: Identity {
            vendor: 1010,
            device_type: 12,
            product_code: 1,
            revision: Revision { major: 1, minor: 2 },
            status: 0x30,
            serial_number: 4711,
            product_name: "HIPERDRIVE".to_owned(),
        },
        state: 3,
    };
    assert_eq!(items.identity(), Some(&expected));
    let reply = Frame::list_identity([0; 8]).reply(&Body::List(ItemList(vec![Item::Identity(expected.clone())])));
    assert_eq!(hex(&reply.emit()), hex(&bytes(&text)));
    // The attributes of the identity object are the same bytes from the vendor on, without the state.
    let all = bytes(item)[18..43].to_vec();
    assert_eq!((Identity::parse_all(&all), expected.identity.emit_all()), (Ok(expected.identity.clone()), all));
    assert_eq!(expected.identity.attribute_bytes(6), Some(bytes("67 12 00 00")));
    assert_eq!(expected.identity.attribute_bytes(8), None);
}

/// The attributes are composed by hand: addresses such as C0A80105h = 192.168.1.5 with the low byte first, a name of
/// three characters with its length in two bytes, and a padding byte. The low four bits of the configuration control
/// are the address source.
#[test]
fn parses_interface_configuration() {
    let text = "05 01 A8 C0 00 FF FF FF 01 01 A8 C0 00 00 00 00 00 00 00 00 03 00 6C 61 6E 00";
    let configuration = InterfaceConfiguration {
        address: Ipv4Addr::new(192, 168, 1, 5),
        mask: Ipv4Addr::new(255, 255, 255, 0),
        gateway: Ipv4Addr::new(192, 168, 1, 1),
        name_servers: [Ipv4Addr::UNSPECIFIED; 2],
        domain: "lan".to_owned(),
    };
    assert_eq!(hex(&configuration.emit()), text);
    assert_eq!(InterfaceConfiguration::parse(&bytes(text)), Ok(configuration));
    let control = ConfigurationControl::parse(&bytes("12 00 00 00")).unwrap();
    assert_eq!(control.source(), AddressSource::Dhcp);
    assert_eq!(control.with_source(AddressSource::Stored).emit(), [0x10, 0, 0, 0]);
    for number in 0..16 {
        let control = ConfigurationControl::parse(&[number, 0, 0, 0]).unwrap();
        assert_eq!(control.with_source(control.source()), control);
    }
    assert!(ConfigurationControl::parse(&[2]).is_err());
}

#[test]
fn parses_socket_address_items() {
    // Composed by hand: 8000h and 16 bytes. The family is 2, the port is 2222 = 08AEh and the address is 10.0.0.7, all
    // with the high byte first.
    let text = "02 00 00 80 10 00 00 02 08 AE 0A 00 00 07 00 00 00 00 00 00 00 00 01 80 10 00 00 02 08 AE EF 01 02 03 00 \
                00 00 00 00 00 00 00";
    let items = ItemList::parse(&bytes(text)).unwrap();
    let socket = |address| Some(SocketAddress::new(address, IMPLICIT_MESSAGE_PORT));
    assert_eq!(items.socket_to_target(), socket(Ipv4Addr::new(10, 0, 0, 7)));
    assert_eq!(items.socket_to_originator(), socket(Ipv4Addr::new(239, 1, 2, 3)));
    assert_eq!(hex(&items.emit()), hex(&bytes(text)));
    for wrong in ["01 00 00 00 01 00 00", "01 00 02 80 04 00 01 00 00 00", "00 00 00", "01 00 B2 00 05 00 01"] {
        assert!(ItemList::parse(&bytes(wrong)).is_err(), "{wrong}");
    }
}

/// Each code is listed once, and an unknown one is reported as unknown.
#[test]
fn status_tables_match_specification() {
    for (code, meaning) in [(0x05, "path unknown"), (0x09, "invalid value"), (0x0E, "attribute cannot be set")] {
        assert_eq!(GeneralStatus::new(code).row().map(|row| row.meaning), Some(meaning));
    }
    assert!(GENERAL_STATUS.is_sorted_by_key(|row| row.code.code()));
    assert!(ENCAPSULATION_STATUS.is_sorted_by_key(|row| row.code.code()));
    assert!(EXTENDED_STATUS.is_sorted_by_key(|row| row.code));
    assert_eq!(GeneralStatus::new(0xAA).to_string(), "0xAA unknown status");
    assert_eq!(EncapsulationStatus::NO_SESSION.to_string(), "0x00000064 no such session");
    assert_eq!(Command::new(0x6F).name(), Some("SendRRData"));
    assert_eq!(Service::FORWARD_OPEN.name(Some(6)), Some("ForwardOpen"));
    assert_eq!(Service::FORWARD_OPEN.name(Some(0x65)), None);
}
