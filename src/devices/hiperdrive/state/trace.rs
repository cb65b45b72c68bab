//! Meaning of frames in the trace: which parameter is read or written, and why a device refuses.

use crate::app::explain::plain;
use crate::app::{Explained, Text, TraceFault};
use crate::buses::ethernet_ip::protocol::{
    Command, EncapsulationStatus, Frame, GeneralStatus, LogicalKind, Reply, Request, Service,
};
use crate::devices::hiperdrive::procedures::Damage;
use crate::devices::hiperdrive::protocol::ParameterNumber;
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as explained;
use crate::link::{Direction, TraceEntry};

pub(super) fn meaning(entry: &TraceEntry) -> Explained {
    let Some(bytes) = entry.bytes.to_bytes() else { return Explained::broken(Text::new("trace.hidden")) };
    let broken = |error| Explained::broken(explained::damage_text(&Damage::Packet(error)));
    let frame = match Frame::parse(&bytes) {
        Ok(frame) => frame,
        Err(error) => return broken(error),
    };
    let name: Vec<Text> = frame.command.name().map(plain).into_iter().collect();
    let is_reply = entry.direction == Direction::Received;
    if is_reply && frame.status != EncapsulationStatus::OK {
        return reported_fault(plain(frame.status));
    }
    if frame.command != Command::SEND_RR_DATA {
        return name.into();
    }
    let body = match frame.body() {
        Ok(body) => body,
        Err(error) if is_reply => return broken(error),
        Err(_) => return name.into(),
    };
    let Some(message) = body.message() else {
        return if is_reply { Explained::broken(explained::damage_text(&Damage::Empty)) } else { name.into() };
    };
    if !is_reply {
        return Request::parse(message).map_or(name, |request| vec![item_text(&request)]).into();
    }
    match Reply::parse(message) {
        Ok(reply) if reply.status == GeneralStatus::OK => vec![TEXTS.text("hd_trace.done")].into(),
        Ok(reply) => reported_fault(plain(reply.status)),
        Err(error) => broken(error),
    }
}

fn reported_fault(text: Text) -> Explained {
    Explained { meaning: vec![text], fault: Some(TraceFault::Reported) }
}

fn item_text(request: &Request) -> Text {
    let attribute = request.path.number(LogicalKind::Attribute);
    let number = request.class().zip(attribute).and_then(|(class, own)| ParameterNumber::from_attribute(class, own));
    match number {
        Some(number) => {
            let is_set = request.service == Service::SET;
            let id = if is_set { "hd_asked.set" } else { "hd_asked.parameter" };
            TEXTS.text(id).with("number", number).with_text("name", explained::parameter(number))
        }
        None => plain(request.service.name(request.class()).unwrap_or_default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::bits::{MaskedBytes, parse_hex};
    use crate::units::Moment;

    const HEAD: &str = "6F 00 14 00 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 \
                        00 00 00 00 00 00 02 00 00 00 00 00 B2 00 04 00";

    /// Issue 22.11: refusals and deliberately damaged explicit messages (reference 7) are explained and marked.
    #[test]
    fn damaged_replies_are_explained_and_marked() {
        let cases = [
            ("done", format!("{HEAD} 90 00 00 00"), None),
            ("a value that is refused", format!("{HEAD} 90 00 09 00"), Some(TraceFault::Reported)),
            (
                "a session that is not known",
                HEAD.replacen("00 00 00 00", "64 00 00 00", 1) + " 90 00 00 00",
                Some(TraceFault::Reported),
            ),
            ("no reply in it", format!("{HEAD} 10 00 00 00"), Some(TraceFault::Broken)),
            ("cut short", HEAD[..60].to_owned(), Some(TraceFault::Broken)),
            ("no frame", "55 AA 55".to_owned(), Some(TraceFault::Broken)),
        ];
        for (label, text, fault) in cases {
            let bytes = MaskedBytes::clear(&parse_hex(&text).unwrap());
            let told = meaning(&TraceEntry { at: Moment::START, direction: Direction::Received, bytes });
            let words: Vec<String> = told.meaning.iter().map(|text| text.words(Language::English)).collect();
            assert_eq!(told.fault, fault, "{label}: {words:?}");
            assert!(!words.concat().is_empty(), "{label}");
        }
    }
}
