//! Property tests with arbitrary input: packets of any content survive a round trip, and no input makes a parser panic.

use proptest::prelude::*;

use super::super::*;
use super::{OWNER, SESSION, open};

/// Runs every parser on arbitrary bytes.
fn read_all(bytes: &[u8]) {
    let _ = Frame::parse(bytes).map(|frame| frame.parse_body().map(|body| body.emit()));
    let _ = ItemList::parse(bytes).map(|items| items.emit());
    let _ = Request::parse(bytes).map(|request| request.emit());
    let _ = Reply::parse(bytes).map(|reply| reply.emit());
    let _ = EPath::parse(bytes).map(|path| path.emit());
    let _ = (ForwardOpen::parse(bytes), ForwardOpenSuccess::parse(bytes), ForwardErrorReply::parse(bytes));
    let _ = (ForwardClose::parse(bytes), ForwardCloseSuccess::parse(bytes), Identity::parse_all(bytes));
    let _ = (ConfigurationControl::parse(bytes), InterfaceConfiguration::parse(bytes));
    for format in [RealTimeFormat::Header, RealTimeFormat::Modeless] {
        let _ = IoPacket::parse(bytes, format).map(|packet| packet.emit());
    }
}

/// Returns valid packets from which invalid ones are derived.
fn valid_packets() -> Vec<Vec<u8>> {
    let frame = Frame::unconnected_message(SESSION, [1; 8], open().request().emit());
    let packet = IoPacket { connection: 1, sequence: 2, count: 3, header: Some(RunIdleHeader::RUN), data: vec![0; 16] };
    vec![frame.emit(), frame.data.clone(), open().request().emit(), open().request().data, packet.emit()]
}

#[test]
fn rejects_truncated_packets() {
    let [frame, _, _, forward, packet] = valid_packets().try_into().unwrap();
    (0..frame.len()).for_each(|end| assert!(Frame::parse(&frame[..end]).is_err(), "{end}"));
    (0..forward.len()).for_each(|end| assert!(ForwardOpen::parse(&forward[..end]).is_err(), "{end}"));
    (0..packet.len())
        .for_each(|end| assert!(IoPacket::parse(&packet[..end], RealTimeFormat::Header).is_err(), "{end}"));
    assert!(Frame::parse(&[frame, vec![0]].concat()).is_err());
    assert_eq!(
        ForwardOpen::parse(&[forward, vec![0, 0]].concat()),
        Err(PacketError::Long { what: Structure::ForwardOpen, left: 2 })
    );
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes: Vec<u8>) {
        read_all(&bytes);
    }

    #[test]
    fn damaged_bytes_never_panic(which in 0usize..5, at: prop::sample::Index, byte: u8, end: prop::sample::Index) {
        let mut bytes = valid_packets().remove(which);
        let length = bytes.len();
        bytes[at.index(length)] = byte;
        read_all(&bytes);
        read_all(&bytes[..end.index(length)]);
    }

    #[test]
    fn every_frame_round_trips(
        command: u16, session: u32, status: u32, context: [u8; 8], options: u32, data in prop::collection::vec(any::<u8>(), 0..600)
    ) {
        let status = EncapsulationStatus::new(status);
        let frame = Frame { command: Command::new(command), session, status, context, options, data };
        prop_assert_eq!(Frame::parse(&frame.emit()), Ok(frame));
    }

    #[test]
    fn every_unknown_item_round_trips(kind in 0x200u16..0x8000, data: Vec<u8>, connection: u32, sequence: u32) {
        let address = Item::SequencedAddress { connection, sequence };
        let items = ItemList(vec![Item::Unknown { kind, data: data.clone() }, address, Item::UnconnectedData(data)]);
        prop_assert_eq!(ItemList::parse(&items.emit()), Ok(items));
    }

    #[test]
    fn every_message_round_trips(
        code in 0u8..0x80, class: u16, instance: u16, status: u8, extended: Vec<u16>, data: Vec<u8>
    ) {
        let service = Service::new(code).unwrap();
        let request = Request { service, path: EPath::to_instance(class, instance), data: data.clone() };
        prop_assert_eq!(Request::parse(&request.emit()), Ok(request));
        let reply = Reply { service, status: GeneralStatus::new(status), extended, data };
        prop_assert_eq!(Reply::parse(&reply.emit()), Ok(reply));
    }

    #[test]
    fn every_connection_round_trips(
        ids: [u32; 2], intervals: [u32; 2], parameters: [u16; 2], transport: u8, multiplier in 0u8..8, timeout: [u8; 2]
    ) {
        let asked = ForwardOpen {
            timeout: RequestTimeout { priority_and_tick: timeout[0], ticks: timeout[1] },
            to_target_id: ids[0],
            to_originator_id: ids[1],
            owner: OWNER,
            connection_timeout: ConnectionTimeout::new(multiplier).unwrap(),
            to_target_interval_us: intervals[0],
            to_target: NetworkParameters::from_word(parameters[0]),
            to_originator_interval_us: intervals[1],
            to_originator: NetworkParameters::from_word(parameters[1]),
            transport: Transport::from_byte(transport),
            path: EPath::to_assemblies(104, 100, 101),
        };
        prop_assert_eq!(ForwardOpen::parse(&asked.request().data), Ok(asked.clone()));
        let _ = (asked.timeout.duration(), asked.target_timeout());
    }

    #[test]
    fn every_cyclic_packet_round_trips(connection: u32, sequence: u32, count: u16, header: Option<u32>, data: Vec<u8>) {
        let packet = IoPacket { connection, sequence, count, header: header.map(RunIdleHeader::from_word), data };
        let format = if header.is_some() { RealTimeFormat::Header } else { RealTimeFormat::Modeless };
        prop_assert_eq!(IoPacket::parse(&packet.emit(), format), Ok(packet));
    }
}
