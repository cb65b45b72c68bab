//! Fuzz tests of the parsers for bytes from devices and hosts.

use encoder_studio::bits::ByteOrder;
use encoder_studio::buses::{bridge, ethernet_ip, ubicom};
use encoder_studio::devices::biss::protocol::{Descriptions, Eds, EdsBank};
use encoder_studio::devices::hiperdrive::protocol::{AddressSwitch, PARAMETERS};
use encoder_studio::devices::hiperface::protocol as hiperface;
use encoder_studio::devices::interbus::procedures::word_in_frame;
use encoder_studio::devices::interbus::protocol::{Reply, WordOrder};

use crate::{fuzz, hex_lines};

#[test]
fn hiperface_frames() {
    let vectors = include_str!("../vectors/hiperface.txt");
    let frames = vectors.lines().filter_map(|line| line.strip_prefix(['>', '<', '!', '-', 'x']));
    let digits = |line: &&str| line.chars().all(|c| c.is_ascii_hexdigit() || c == ' ');
    let lines: Vec<&str> = frames.filter(digits).collect();
    let examples = hex_lines(&lines.join("\n"));
    let requests: Vec<hiperface::Request> = examples
        .iter()
        .filter_map(|bytes| hiperface::Request::parse(&hiperface::Frame::parse(bytes).ok()?).ok())
        .collect();
    fuzz("hiperface", &examples, |bytes| {
        if let Ok(frame) = hiperface::Frame::parse(bytes) {
            let _ = hiperface::Request::parse(&frame);
        }
        for request in requests.iter().step_by(7) {
            let _ = request.parse_reply(0x40, bytes);
        }
        let _ = hiperface::ExtendedLabel::parse(bytes);
    });
}

#[test]
fn bridge_packets() {
    use bridge::protocol::{Message, Packet, Receiver, Request};
    fuzz("bridge", &hex_lines(include_str!("corpus/bridge.txt")), |bytes| {
        let mut receiver = Receiver::default();
        bytes.chunks(7).for_each(|part| receiver.push(part));
        let received: Vec<Packet> = std::iter::from_fn(|| receiver.next_packet()).collect();
        for packet in received.iter().chain(&Packet::parse(bytes).ok()) {
            assert_eq!(Packet::parse(packet.emit().strip_suffix(&[0]).unwrap()).as_ref(), Ok(packet));
            if let Ok(request) = Request::parse(packet) {
                assert_eq!(Request::parse(&request.emit(packet.seq)), Ok(request));
            }
            let _ = Message::parse(packet);
        }
    });
}

#[test]
fn ubicom_frames() {
    use ubicom::protocol::{Command, Frame, NODE, Receiver, Reply, Request};
    fuzz("ubicom", &hex_lines(include_str!("corpus/ubicom.txt")), |bytes| {
        let mut receiver = Receiver::new(NODE);
        bytes.chunks(5).for_each(|part| receiver.push(part));
        while let Some(frame) = receiver.next_frame() {
            Frame::parse(&frame).unwrap();
        }
        if let Ok(frame) = Frame::parse(bytes) {
            for order in [ByteOrder::LowFirst, ByteOrder::HighFirst] {
                let _ = Request::parse(&frame, order);
            }
            for command in [Command::Read, Command::Write, Command::Position] {
                let _ = Reply::parse(&frame, command);
            }
        }
    });
}

#[test]
fn ethernet_ip_packets() {
    use ethernet_ip::protocol::{
        EPath, ForwardClose, ForwardOpen, Frame, Identity, InterfaceConfiguration, IoPacket, ItemList, RealTimeFormat,
        Receiver, Reply, Request,
    };
    fuzz("ethernet_ip", &hex_lines(include_str!("corpus/ethernet_ip.txt")), |bytes| {
        let mut receiver = Receiver::default();
        bytes.chunks(11).for_each(|part| receiver.push(part));
        if let Ok(frame) = Frame::parse(bytes) {
            let _ = frame.parse_body();
        }
        let _ = (ItemList::parse(bytes), Request::parse(bytes), Reply::parse(bytes), EPath::parse(bytes));
        let _ = (ForwardOpen::parse(bytes), ForwardClose::parse(bytes), Identity::parse_all(bytes));
        let _ = InterfaceConfiguration::parse(bytes);
        for format in [RealTimeFormat::Modeless, RealTimeFormat::Header] {
            let _ = IoPacket::parse(bytes, format);
        }
        for row in PARAMETERS.iter().step_by(5) {
            let _ = row.kind.parse(bytes);
        }
        if let Some(byte) = bytes.first() {
            let _ = AddressSwitch::parse(*byte);
        }
    });
}

#[test]
fn interbus_words() {
    fuzz("interbus", &hex_lines(include_str!("corpus/interbus.txt")), |bytes| {
        for order in [WordOrder::HighFirst, WordOrder::LowFirst] {
            let _ = (word_in_frame(true, bytes, order), word_in_frame(false, bytes, order));
        }
        for word in bytes.chunks_exact(4) {
            let _ = Reply::parse(u32::from_be_bytes([word[0], word[1], word[2], word[3]]));
        }
    });
}

#[test]
fn biss_data_sheets_and_frames() {
    let descriptions = Descriptions::built_in();
    let layout = descriptions.find_by_name("POSITAL IXARC kit encoder").unwrap().layout().unwrap();
    fuzz("biss", &hex_lines(include_str!("corpus/biss.txt")), |bytes| {
        let mut bank = [0; 64];
        let length = bytes.len().min(64);
        bank[..length].copy_from_slice(&bytes[..length]);
        for own in [EdsBank::Common, EdsBank::Encoder] {
            let _ = Eds::parse(own, bank);
        }
        if let Some(raw) = bytes.first_chunk::<8>() {
            let _ = layout.parse(u64::from_be_bytes(*raw));
        }
    });
}
