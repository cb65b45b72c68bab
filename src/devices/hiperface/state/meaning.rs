//! Explains frames in the trace. A reply is explained together with the preceding request.

use crate::app::{FrameExplanation, Text, TraceFault};
use crate::devices::hiperface::procedures::ReplyDamage;
use crate::devices::hiperface::protocol::{Answer, Frame, FrameDetail, Reply, Request, StatusCode, describe_frame};
use crate::devices::hiperface::state::explain as words;
use crate::link::{Direction, TraceEntry};

/// A decoder that explains frames in the order of transmission. It remembers the last request to explain the reply.
#[derive(Debug, Default)]
pub(super) struct FrameDecoder {
    request: Option<(u8, Request)>,
}

impl FrameDecoder {
    /// Explains a frame without revealing access codes.
    pub(super) fn explain(&mut self, entry: &TraceEntry) -> FrameExplanation {
        match (entry.bytes.to_bytes(), entry.direction) {
            (Some(bytes), Direction::Sent) => self.explain_sent(&bytes),
            (None, Direction::Sent) => self.explain_sent(&with_checksum(entry.bytes.with_placeholder(0))),
            (Some(bytes), Direction::Received) => self.explain_received(&bytes),
            (None, Direction::Received) => {
                self.request = None;
                FrameExplanation::from_error(Text::new("trace.hidden"))
            }
        }
    }

    fn explain_sent(&mut self, bytes: &[u8]) -> FrameExplanation {
        let frame = Frame::parse(bytes).ok();
        self.request = frame.and_then(|frame| Some((frame.address, Request::parse(&frame).ok()?)));
        let facts = describe_frame(bytes, None).unwrap_or_default();
        facts.iter().map(words::detail_text).collect::<Vec<Text>>().into()
    }

    fn explain_received(&mut self, bytes: &[u8]) -> FrameExplanation {
        let asked = self.request.take();
        let answer = match asked.as_ref().map(|(address, request)| request.parse_reply(*address, bytes)) {
            Some(Err(error)) => return FrameExplanation::from_error(words::damage_text(&ReplyDamage::Reply(error))),
            Some(Ok(answer)) => Some(answer),
            None => None,
        };
        let facts = match describe_frame(bytes, asked.as_ref().map(|(_, request)| request)) {
            Ok(facts) => facts,
            Err(error) => return FrameExplanation::from_error(words::damage_text(&ReplyDamage::Reply(error.into()))),
        };
        // If the request is known, the heading of the reply is omitted, because it only repeats the heading of the
        // request.
        let known = |facts: &FrameDetail| asked.is_some() && matches!(facts, FrameDetail::Heading { .. });
        let meaning: Vec<Text> = facts.iter().filter(|facts| !known(facts)).map(words::detail_text).collect();
        let fault = answer.filter(is_status_report).map(|_| TraceFault::Reported);
        FrameExplanation { fault, ..meaning.into() }
    }
}

fn is_status_report(answer: &Answer) -> bool {
    match answer {
        Answer::Rejected { .. } => true,
        Answer::Reply { reply: Reply::Status(codes), .. } => codes.iter().any(|code| *code != StatusCode::OK),
        Answer::Reply { pending, .. } => *pending,
    }
}

/// Replaces the last byte of a frame with the checksum of the bytes before it.
fn with_checksum(mut frame: Vec<u8>) -> Vec<u8> {
    if frame.pop().is_some() {
        frame.push(frame.iter().fold(0, |sum, byte| sum ^ byte));
    }
    frame
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::bits::MaskedBytes;
    use crate::units::Moment;

    fn entry(direction: Direction, bytes: &[u8]) -> TraceEntry {
        TraceEntry { at: Moment::START, direction, bytes: MaskedBytes::unmasked(bytes) }
    }

    /// Damaged replies are marked, and their explanation names the error. The frames are valid replies that were
    /// corrupted on purpose (issue 22.11).
    #[test]
    fn explains_and_marks_damaged_replies() {
        let position = [0x40, 0x42, 0x02];
        let cases: [(&str, &[u8], Option<TraceFault>, &str); 6] = [
            ("good", &[0x40, 0x42, 0x00, 0x0E, 0x05, 0x31, 0x38], None, "position"),
            ("a bit flipped", &[0x40, 0x42, 0x00, 0x0E, 0x05, 0x31, 0x39], Some(TraceFault::Broken), "checksum"),
            ("cut short", &[0x40, 0x42], Some(TraceFault::Broken), "(2)"),
            ("another address", &[0x41, 0x42, 0x00, 0x0E, 0x05, 0x31, 0x39], Some(TraceFault::Broken), "41h"),
            ("refused", &[0x40, 0x50, 0x1F, 0x0F], Some(TraceFault::Reported), "1Fh"),
            ("with a warning", &[0x40, 0xC2, 0x00, 0x01, 0x23, 0x45, 0xE5], Some(TraceFault::Reported), "position"),
        ];
        for (label, reply, fault, words) in cases {
            let mut meaning = FrameDecoder::default();
            assert_eq!(meaning.explain(&entry(Direction::Sent, &position)).fault, None);
            let said = meaning.explain(&entry(Direction::Received, reply));
            let text: Vec<String> = said.meaning.iter().map(|text| text.to_string_in(Language::English)).collect();
            assert_eq!(said.fault, fault, "{label}: {text:?}");
            assert!(text.join(" ").contains(words), "{label}: {text:?}");
        }
        let mut meaning = FrameDecoder::default();
        let hidden = TraceEntry { bytes: MaskedBytes::fully_masked(3), ..entry(Direction::Received, &[]) };
        assert_eq!(meaning.explain(&hidden).fault, Some(TraceFault::Broken));
    }
}
