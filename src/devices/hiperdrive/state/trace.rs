//! Explains frames in the trace: which parameter is read or written, its value, and why the device rejected a request.

use std::collections::VecDeque;

use crate::app::explain::literal_text;
use crate::app::{FrameExplanation, Text, TraceFault};
use crate::buses::ethernet_ip::protocol::{
    Command, EncapsulationStatus, Frame, GeneralStatus, LogicalKind, Reply, Request, Service,
};
use crate::devices::hiperdrive::procedures::ReplyDamage;
use crate::devices::hiperdrive::protocol::{ParameterNumber, Value, ValueError};
use crate::devices::hiperdrive::state::explain as explained;
use crate::devices::hiperdrive::state::{TEXTS, format};
use crate::link::{Direction, TraceEntry};

/// Decoder that explains frames. It remembers unanswered requests, because a reply does not contain the parameter.
#[derive(Default)]
pub(super) struct FrameDecoder {
    /// Latest requests, newest first.
    requests: VecDeque<(Frame, Request)>,
}

impl FrameDecoder {
    /// Maximum number of remembered requests. The host sends its next request after a reply or a time-out.
    const MAX_REQUESTS: usize = 8;

    pub(super) fn explain(&mut self, entry: &TraceEntry) -> FrameExplanation {
        let Some(bytes) = entry.bytes.to_bytes() else {
            return FrameExplanation::from_error(Text::new("trace.hidden"));
        };
        let broken = |error| FrameExplanation::from_error(explained::damage_text(&ReplyDamage::Packet(error)));
        let frame = match Frame::parse(&bytes) {
            Ok(frame) => frame,
            Err(error) => return broken(error),
        };
        let name: Vec<Text> = frame.command.name().map(literal_text).into_iter().collect();
        let is_reply = entry.direction == Direction::Received;
        if is_reply && frame.status != EncapsulationStatus::OK {
            return reported_fault(literal_text(frame.status));
        }
        if frame.command != Command::SEND_RR_DATA {
            return name.into();
        }
        let body = match frame.parse_body() {
            Ok(body) => body,
            Err(error) if is_reply => return broken(error),
            Err(_) => return name.into(),
        };
        let Some(message) = body.message() else {
            return if is_reply {
                FrameExplanation::from_error(explained::damage_text(&ReplyDamage::Empty))
            } else {
                name.into()
            };
        };
        let explained = match (is_reply, Request::parse(message), Reply::parse(message)) {
            (false, Ok(request), _) => {
                let meaning = request_texts(&request);
                self.remember_request(frame, request);
                meaning.into()
            }
            (false, Err(_), _) => name.into(),
            (true, _, Ok(reply)) => reply_meaning(&reply, self.take_request(&frame).as_ref()),
            (true, _, Err(error)) => broken(error),
        };
        // The message is preceded by the headers of the frame and of its items.
        let header = if bytes.ends_with(message) { bytes.len() - message.len() } else { 0 };
        FrameExplanation { header, ..explained }
    }

    fn remember_request(&mut self, frame: Frame, request: Request) {
        self.requests.truncate(Self::MAX_REQUESTS - 1);
        self.requests.push_front((frame, request));
    }

    /// Removes and returns the request that a frame answers.
    fn take_request(&mut self, reply: &Frame) -> Option<Request> {
        let index = self.requests.iter().position(|(request, _)| reply.is_reply_to(request))?;
        self.requests.remove(index).map(|(_, request)| request)
    }
}

fn reply_meaning(reply: &Reply, request: Option<&Request>) -> FrameExplanation {
    if reply.status != GeneralStatus::OK {
        return reported_fault(literal_text(reply.status));
    }
    let read = request.filter(|request| request.service == Service::GET && reply.service == Service::GET);
    match read.and_then(parameter_of).and_then(|number| value_texts(number, &reply.data)) {
        Some(Ok(texts)) => texts.into(),
        Some(Err(error)) => FrameExplanation::from_error(explained::damage_text(&ReplyDamage::Value(error))),
        None => vec![TEXTS.text("hd_trace.done")].into(),
    }
}

fn reported_fault(text: Text) -> FrameExplanation {
    FrameExplanation { fault: Some(TraceFault::Reported), ..vec![text].into() }
}

fn parameter_of(request: &Request) -> Option<ParameterNumber> {
    ParameterNumber::from_attribute(request.class_id()?, request.path.first_value(LogicalKind::Attribute)?)
}

fn request_texts(request: &Request) -> Vec<Text> {
    let Some(number) = parameter_of(request) else {
        return vec![literal_text(request.service.name(request.class_id()).unwrap_or_default())];
    };
    let is_set = request.service == Service::SET;
    let id = if is_set { "hd_asked.set" } else { "hd_asked.parameter" };
    let heading = TEXTS.text(id).with("number", number).with_text("name", explained::parameter_name_text(number));
    let value = is_set.then(|| value_texts(number, &request.data)?.ok()).flatten();
    [vec![heading], value.unwrap_or_default()].concat()
}

/// Describes the transmitted value of a parameter. Returns `None` if the manual does not list the parameter.
fn value_texts(number: ParameterNumber, data: &[u8]) -> Option<Result<Vec<Text>, ValueError>> {
    let row = number.row()?;
    let value = match row.kind.parse(data) {
        Ok(value) => value,
        Err(error) => return Some(Err(error)),
    };
    let meaning = match value {
        Value::Number(tenths) if row.unit == "0.1 rpm" => {
            Some(TEXTS.text("hd_entry.rpm").with_number("rpm", tenths as f64 / 10.0, 1))
        }
        Value::Number(value) => format::value_meaning(number, value),
        Value::Text(_) => None,
    };
    // If the meaning is given in whole units, it replaces the number of tenths.
    if let Some(meaning) = meaning.as_ref().filter(|_| row.unit.starts_with("0.1 ")) {
        return Some(Ok(vec![meaning.clone()]));
    }
    let shown = format::value_text(number, &value);
    let shown = match format::unit(row) {
        Some(unit) => TEXTS.text("hd_entry.place").with("value", shown).with_text("unit", unit),
        None => literal_text(shown),
    };
    Some(Ok([shown].into_iter().chain(meaning).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::bits::{MaskedBytes, parse_hex};
    use crate::units::Moment;

    const HEAD: &str = "6F 00 14 00 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 \
                        00 00 00 00 00 00 02 00 00 00 00 00 B2 00 04 00";

    /// Rejections and damaged explicit messages are explained and marked (reference, section 7; issue 22.11).
    #[test]
    fn explains_and_marks_corrupt_replies() {
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
            let told = FrameDecoder::default().explain(&entry(Direction::Received, &text));
            let words = english_texts(&told);
            assert_eq!(told.fault, fault, "{label}: {words:?}");
            assert!(!words.concat().is_empty(), "{label}");
        }
    }

    fn entry(direction: Direction, hex: &str) -> TraceEntry {
        let bytes = MaskedBytes::unmasked(&parse_hex(hex).unwrap());
        TraceEntry { at: Moment::START, direction, bytes }
    }

    fn english_texts(explained: &FrameExplanation) -> Vec<String> {
        explained.meaning.iter().map(|text| text.to_string_in(Language::English)).collect()
    }

    /// Wraps a message in a frame with the given context (reference, sections 7 and 9).
    fn around(context: u8, message: &str) -> String {
        let length = parse_hex(message).unwrap().len();
        format!(
            "6F 00 {:02X} 00 78 56 34 12 00 00 00 00 {context:02X} 00 00 00 00 00 00 00 00 00 00 00 \
             00 00 00 00 00 00 02 00 00 00 00 00 B2 00 {length:02X} 00 {message}",
            16 + length
        )
    }

    /// The messages are from section 9 of the reference: a read of parameter 107, a write of 158, and a reply to the
    /// last request but one.
    #[test]
    fn reply_shows_value_of_its_request() {
        let mut decoder = FrameDecoder::default();
        let mut frame = |direction, context, message: &str| {
            let told = decoder.explain(&entry(direction, &around(context, message)));
            assert_eq!(told.header, 40, "{message}");
            (english_texts(&told), told.fault)
        };
        let (sent, received) = (Direction::Sent, Direction::Received);
        let (words, _) = frame(sent, 1, "0E 03 20 65 24 01 30 6B");
        assert!(words.concat().contains("parameter 107"), "{words:?}");
        let (words, _) = frame(sent, 2, "10 03 20 65 24 01 30 9E 00 00 01 FE");
        assert!(words[0].contains("parameter 158") && words[1].contains("-33488896"), "{words:?}");
        assert_eq!(frame(received, 1, "8E 00 00 00 00 80 02 00"), (vec!["163840 steps".to_owned()], None));
        assert_eq!(frame(received, 2, "90 00 00 00"), (vec!["done".to_owned()], None));
        let (words, fault) = frame(received, 1, "8E 00 00 00 00 80 02 00");
        assert_eq!((words, fault), (vec!["done".to_owned()], None), "the request has been answered already");
        // Parameter 106 has a resolution of 0.1 rpm.
        frame(sent, 3, "0E 03 20 65 24 01 30 6A");
        assert_eq!(frame(received, 3, "8E 00 00 00 20 03").0, ["80.0 rpm"]);
        frame(sent, 3, "0E 03 20 65 24 01 30 6B");
        let (words, fault) = frame(received, 3, "8E 00 00 00 00 80");
        assert_eq!(fault, Some(TraceFault::Broken), "a value of the wrong length: {words:?}");
    }
}
