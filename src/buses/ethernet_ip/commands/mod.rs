//! `decode ethernet-ip`: explains frames, cyclic packets and CIP messages offline. It detects the kind of the input.

mod cip;

use serde_json::{Map, Value as Json, json};

use crate::bits::{hex, hex_compact};
use crate::buses::ethernet_ip::protocol::{
    Body, Command, EncapsulationStatus, Frame, IoPacket, Item, ItemList, RealTimeFormat, SocketAddress,
};
use crate::cli::Result;
use crate::cli::args::DecodeArgs;
use crate::cli::commands::ProtocolDecoder;
use crate::cli::decode::{FrameExplanation, parse_frames, show};
use crate::cli::output::{Output, count};

pub(crate) struct DecodedBytes {
    pub(crate) lines: Vec<String>,
    pub(crate) more: Map<String, Json>,
    /// Process data of a cyclic packet, and whether the packet is sent to the target.
    pub(crate) data: Option<(Vec<u8>, bool)>,
}

/// A function that decodes an attribute of a class. Returns its name, and its value or the reason why the value is
/// invalid.
pub(crate) type AttributeDecoder = fn(u16, u16, &[u8]) -> Option<(String, std::result::Result<String, String>)>;

#[derive(Clone, Copy)]
pub(crate) enum Device {
    Any,
    /// A known device. It supports only standard services, and the meaning of its attributes is known.
    Known(AttributeDecoder),
}

const NO_KNOWN_PACKET: &str = "no frame, no cyclic packet and no CIP message of EtherNet/IP";

pub(crate) struct EthernetIpDecoder;

impl ProtocolDecoder for EthernetIpDecoder {
    fn name(&self) -> &'static str {
        "ethernet-ip"
    }

    fn description(&self) -> &'static str {
        "EtherNet/IP of any device"
    }

    fn help_text(&self) -> &'static str {
        "consecutive frames of a TCP stream, cyclic packets (UDP) or single CIP messages"
    }

    fn decode(&self, output: &Output, arguments: &DecodeArgs) -> Result {
        decode(output, &arguments.hex)
    }
}

fn decode(output: &Output, words: &[String]) -> Result {
    let explain = |bytes: &Vec<u8>| {
        let explained = explain_packet(bytes, Device::Any).unwrap_or_else(|| Err(NO_KNOWN_PACKET.to_owned()));
        let (meaning, more) = match explained {
            Ok(DecodedBytes { lines, more, .. }) => (Ok(lines), more),
            Err(why) => (Err(why), Map::new()),
        };
        FrameExplanation { shown: hex(bytes), compact: hex_compact(bytes), meaning, more }
    };
    let explained: Vec<FrameExplanation> = parse_frames(words)?.iter().map(explain).collect();
    show(output, &explained)
}

/// Decodes a packet. Returns `None` if the bytes do not start like one.
pub(crate) fn explain_packet(bytes: &[u8], device: Device) -> Option<std::result::Result<DecodedBytes, String>> {
    if let Some(explained) = explain_cyclic(bytes) {
        return Some(Ok(explained));
    }
    if let Some(explained) = explain_stream(bytes, device) {
        return Some(explained);
    }
    let (kind, lines) = cip::message(bytes, device)?;
    Some(Ok(DecodedBytes { lines, more: packet_map(kind), data: None }))
}

fn packet_map(kind: &str) -> Map<String, Json> {
    Map::from_iter([("packet".to_owned(), json!(kind))])
}

/// Describes a cyclic packet. The header is detected by its value and by the length of the data.
fn explain_cyclic(bytes: &[u8]) -> Option<DecodedBytes> {
    let plain = IoPacket::parse(bytes, RealTimeFormat::Modeless).ok()?;
    let with = IoPacket::parse(bytes, RealTimeFormat::Header).ok().filter(|packet| {
        let known = packet.header.is_some_and(|header| header.to_bits() <= 1);
        known && (packet.data.len() % 8 == 0 || plain.data.len() % 8 != 0)
    });
    let to_target = with.is_some();
    let IoPacket { connection, sequence, count: number, header, data } = with.unwrap_or(plain);
    let header_words = header.map_or("no run/idle header", |header| if header.is_running() { "run" } else { "idle" });
    let lines = vec![
        format!("cyclic packet {sequence} of connection 0x{connection:08X}: count {number}, {header_words}"),
        format!("{} of process data: {}", count(data.len(), "byte"), hex(&data)),
    ];
    let mut more = packet_map("cyclic");
    more.extend([
        ("connection".to_owned(), json!(connection)),
        ("sequence".to_owned(), json!(sequence)),
        ("count".to_owned(), json!(number)),
        ("run".to_owned(), json!(header.map(|header| header.is_running()))),
    ]);
    Some(DecodedBytes { lines, more, data: Some((data, to_target)) })
}

/// Decodes consecutive frames. Returns `None` if the first command is unknown.
///
/// For a known device, NOP also yields `None`. Captures do not contain NOP, but process data of idle drives look like
/// it.
fn explain_stream(bytes: &[u8], device: Device) -> Option<std::result::Result<DecodedBytes, String>> {
    let [low, high, ..] = bytes else { return None };
    let command = Command::new(u16::from_le_bytes([*low, *high]));
    let is_idle = command == Command::NOP && matches!(device, Device::Known(_));
    if bytes.len() < Frame::HEADER || command.name().is_none() || is_idle {
        return None;
    }
    let mut rest = bytes;
    let mut lines = Vec::new();
    while !rest.is_empty() {
        let whole = match Frame::total_length(rest) {
            Ok(Some(length)) => rest.split_at_checked(length),
            Ok(None) => None,
            Err(why) => return Some(Err(why.to_string())),
        };
        let Some((whole, behind)) = whole else {
            return Some(Err(format!("the encapsulation frame is cut off after {}", count(rest.len(), "byte"))));
        };
        match Frame::parse(whole).map_err(|why| why.to_string()).and_then(|frame| frame_lines(&frame, device)) {
            Ok(own) => lines.extend(own),
            Err(why) => return Some(Err(why)),
        }
        rest = behind;
    }
    Some(Ok(DecodedBytes { lines, more: packet_map("frame"), data: None }))
}

fn frame_lines(frame: &Frame, device: Device) -> std::result::Result<Vec<String>, String> {
    let name = frame.command.name().map_or_else(|| format!("command 0x{:04X}", frame.command.code()), str::to_owned);
    let session = if frame.session == 0 { String::new() } else { format!(", session 0x{:08X}", frame.session) };
    let mut lines = vec![format!("{name}{session}: {}", count(frame.data.len(), "byte"))];
    if frame.status != EncapsulationStatus::OK {
        let remedy = frame.status.row().map_or(String::new(), |row| format!("; {}", row.remedy));
        lines.push(format!("status {}{remedy}", frame.status));
    }
    match frame.parse_body().map_err(|why| why.to_string())? {
        Body::Empty => {}
        Body::Register { version, .. } => lines.push(format!("version {version} of the protocol")),
        Body::List(items) | Body::Data { items, .. } => item_list_lines(&items, device, &mut lines),
        Body::Other(data) => lines.push(format!("data {}", hex(&data))),
    }
    Ok(lines)
}

fn item_list_lines(items: &ItemList, device: Device, lines: &mut Vec<String>) {
    for item in &items.0 {
        match item {
            Item::Null => {}
            Item::Identity(item) => {
                let own = &item.identity;
                lines.push(format!(
                    "identity: \"{}\", vendor {}, device type {}, product {}, revision {}, serial number {}, status 0x{:04X}, \
                     state {}",
                    own.product_name,
                    own.vendor,
                    own.device_type,
                    own.product_code,
                    own.revision,
                    own.serial_number,
                    own.status,
                    item.state
                ));
                lines.push(format!("answers at {}", format_socket_address(&item.socket)));
            }
            Item::ConnectedAddress(connection) => lines.push(format!("connection 0x{connection:08X}")),
            Item::SequencedAddress { connection, sequence } => {
                lines.push(format!("connection 0x{connection:08X}, packet {sequence}"));
            }
            Item::ConnectedData(data) => lines.push(format!("data {}", hex(data))),
            Item::UnconnectedData(data) => match cip::message(data, device) {
                Some((_, message)) => lines.extend(message),
                None => lines.push(format!("no CIP message: {}", hex(data))),
            },
            Item::SocketToTarget(address) => {
                lines.push(format!("cyclic data to the target at {}", format_socket_address(address)))
            }
            Item::SocketToOriginator(address) => {
                lines.push(format!("cyclic data to the originator at {}", format_socket_address(address)));
            }
            Item::Unknown { kind, data } => lines.push(format!("item 0x{kind:04X}: {}", hex(data))),
        }
    }
}

fn format_socket_address(address: &SocketAddress) -> String {
    format!("{}:{}", address.address, address.port)
}
