//! What the frames of the trace say: which parameter is asked for or set, and what a device refuses.

use crate::app::Text;
use crate::app::explain;
use crate::app::explain::plain;
use crate::link::{Direction, TraceEntry};
use crate::protocol::ethernet_ip::{Command, Frame, GeneralStatus, LogicalKind, Reply, Request, Service};
use crate::protocol::hiperdrive::ParameterNumber;

/// What a frame says, and nothing for bytes that are none.
pub(super) fn meaning(entry: &TraceEntry) -> Vec<Text> {
    let Some(frame) = entry.bytes.to_bytes().and_then(|bytes| Frame::parse(&bytes).ok()) else { return Vec::new() };
    let name = frame.command.name().map(plain).into_iter().collect();
    if frame.command != Command::SEND_RR_DATA {
        return name;
    }
    let Ok(body) = frame.body() else { return name };
    let Some(message) = body.message() else { return name };
    match entry.direction {
        Direction::Sent => Request::parse(message).map_or(name, |request| vec![asked(&request)]),
        Direction::Received => Reply::parse(message).map_or(name, |reply| vec![answered(&reply)]),
    }
}

fn asked(request: &Request) -> Text {
    let attribute = request.path.number(LogicalKind::Attribute);
    let number = request.class().zip(attribute).and_then(|(class, own)| ParameterNumber::of_attribute(class, own));
    match number {
        Some(number) => {
            let is_set = request.service == Service::SET;
            let id = if is_set { "hd_asked.set" } else { "hd_asked.parameter" };
            Text::new(id).with("number", number).with_text("name", explain::hiperdrive::parameter(number))
        }
        None => plain(request.service.name(request.class()).unwrap_or_default()),
    }
}

fn answered(reply: &Reply) -> Text {
    if reply.status == GeneralStatus::OK { Text::new("hd_trace.done") } else { plain(reply.status) }
}
