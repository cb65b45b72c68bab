//! Descriptions of the packets exchanged with an adapter, for all buses.

use crate::app::explain::literal_text;
use crate::app::{FrameExplanation, Text, TraceFault};
use crate::buses::bridge::protocol::{Message, Packet, Reply, Request};
use crate::buses::bridge::state::TEXTS;

/// Parses the first packet in the transmitted bytes, or returns `None` if they contain no packet.
pub fn parse_packet(bytes: &[u8]) -> Option<Packet> {
    let stuffed = bytes.split(|byte| *byte == 0).find(|stuffed| !stuffed.is_empty())?;
    Packet::parse(stuffed).ok()
}

/// Explains a received packet that is damaged or rejects a request. Returns `None` for any other packet.
pub fn explain_received(bytes: &[u8]) -> Option<FrameExplanation> {
    let Some(packet) = parse_packet(bytes) else {
        return Some(FrameExplanation::from_error(TEXTS.text("trace.no_packet")));
    };
    match Message::parse(&packet) {
        Ok(Message::Error { .. }) => {
            let meaning: Vec<Text> = message_text(&packet).into_iter().collect();
            Some(FrameExplanation { fault: Some(TraceFault::Reported), ..meaning.into() })
        }
        Ok(_) => None,
        Err(error) => Some(FrameExplanation::from_error(literal_text(error))),
    }
}

pub fn request_text(request: &Request) -> Text {
    match request {
        Request::BissRead | Request::SsiRead => Text::new("trace.position"),
        Request::Hello => TEXTS.text("trace.hello"),
        _ => TEXTS.text("trace.set_up"),
    }
}

/// Describes a packet of an adapter, or returns `None` if it is not a valid message.
pub fn message_text(packet: &Packet) -> Option<Text> {
    Some(match Message::parse(packet).ok()? {
        Message::Reply(Reply::BissRead { raw, .. } | Reply::SsiRead { raw, .. }) => literal_text(format!("0x{raw:X}")),
        Message::Reply(Reply::BissRegisterRead { value } | Reply::BissRegisterWrite { value }) => {
            literal_text(format!("0x{value:02X}"))
        }
        Message::Reply(Reply::Hello(hello)) => literal_text(format!("{} {}", hello.name, hello.firmware)),
        Message::Reply(_) => Text::new("trace.taken"),
        Message::Error { text, .. } => TEXTS.text("trace.adapter_refuses").with("why", text),
        Message::Data(_) => TEXTS.text("trace.stream"),
    })
}
