//! Explanations of frames in the trace. A reply can only be decoded if the preceding request is known, and a register
//! access over the bus only if the selected bank is known.

use crate::app::explain::literal_text;
use crate::app::{FrameExplanation, Text, TraceFault};
use crate::bits::ByteOrder;
use crate::buses::bridge::protocol as bridge;
use crate::buses::bridge::state::traced as adapter;
use crate::buses::ubicom::protocol::{Frame, Reply, Request, SYNC, WriteReply};
use crate::devices::biss::procedures::ReplyDamage;
use crate::devices::biss::protocol::RegisterAddress;
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::explain as words;
use crate::link::{Direction, TraceEntry};

/// A decoder that explains frames in the order of transmission, because their meaning depends on earlier ones.
#[derive(Debug, Default)]
pub(super) struct FrameDecoder {
    /// Byte order of register numbers, once known.
    pub(super) order: Option<ByteOrder>,
    requested: Option<Request>,
    /// Whether the last request was sent over the configuration pin.
    is_pin: bool,
    bank: Option<u8>,
}

impl FrameDecoder {
    pub(super) fn explain(&mut self, entry: &TraceEntry) -> FrameExplanation {
        let Some(bytes) = entry.bytes.to_bytes() else {
            return FrameExplanation::from_error(Text::new("trace.hidden"));
        };
        let meaning = match entry.direction {
            Direction::Sent if bytes.first() == Some(&SYNC) => self.request(&bytes),
            Direction::Sent => {
                self.is_pin = false;
                self.explain_packet(&bytes)
            }
            Direction::Received if self.is_pin => return self.reply(&bytes),
            Direction::Received => match adapter::explain_received(&bytes) {
                Some(fault) => return fault,
                None => self.explain_packet(&bytes),
            },
        };
        meaning.into_iter().collect::<Vec<_>>().into()
    }

    fn request(&mut self, bytes: &[u8]) -> Option<Text> {
        let frame = Frame::parse(bytes).ok()?;
        self.is_pin = true;
        self.requested = Request::parse(&frame, self.order.unwrap_or(ByteOrder::LowFirst)).ok();
        let place = |register| RegisterAddress::from_global(register).map_or_else(String::new, |at| at.to_string());
        Some(match self.requested? {
            Request::Read { register } => TEXTS.text("trace.read").with("address", place(register)),
            Request::Write { register, value } => written_text("trace.write", place(register), value),
            Request::Position { .. } => Text::new("trace.position"),
        })
    }

    /// Decodes what was received over the configuration pin after a request. The reply may follow damaged bytes.
    fn reply(&mut self, bytes: &[u8]) -> FrameExplanation {
        let broken = |damage| FrameExplanation::from_error(words::damage_text(&damage));
        let Ok(frame) = Frame::parse(bytes) else { return broken(ReplyDamage::NoFrame { bytes: bytes.len() }) };
        let Some(requested) = self.requested else { return FrameExplanation::default() };
        let reply = match Reply::parse(&frame, requested.command()) {
            Ok(reply) => reply,
            Err(error) => return broken(ReplyDamage::Reply(error)),
        };
        self.requested = None;
        let text = match reply {
            Reply::Value(value) => literal_text(format!("0x{value:02X}")),
            Reply::Written(WriteReply::Acknowledged) => Text::new("trace.taken"),
            Reply::Written(WriteReply::Refused) => {
                return FrameExplanation {
                    fault: Some(TraceFault::Reported),
                    ..vec![TEXTS.text("trace.refused")].into()
                };
            }
            Reply::Written(WriteReply::Unknown(code)) => literal_text(format!("0x{code:02X}")),
            Reply::Position(word) => literal_text(format!("0x{:X}", word.to_u64())),
        };
        vec![text].into()
    }

    fn explain_packet(&mut self, bytes: &[u8]) -> Option<Text> {
        let packet = adapter::parse_packet(bytes)?;
        match bridge::Request::parse(&packet) {
            Ok(request) => Some(self.adapter_request_text(&request)),
            Err(_) => adapter::message_text(&packet),
        }
    }

    fn adapter_request_text(&mut self, request: &bridge::Request) -> Text {
        let place = |address| {
            let at = if address < RegisterAddress::BANK_SIZE {
                self.bank.and_then(|bank| RegisterAddress::in_bank(bank, address))
            } else {
                RegisterAddress::direct_register(address)
            };
            at.map_or_else(|| format!("0x{address:02X}"), |at| at.to_string())
        };
        match *request {
            bridge::Request::BissRegisterRead { address, .. } => {
                TEXTS.text("trace.read").with("address", place(address))
            }
            bridge::Request::BissRegisterWrite { address, value, .. } => {
                let meaning = written_text("trace.write", place(address), value);
                if address == RegisterAddress::BANK_SELECT.address() {
                    self.bank = Some(value);
                }
                meaning
            }
            ref other => adapter::request_text(other),
        }
    }
}

fn written_text(id: &'static str, address: String, value: u8) -> Text {
    TEXTS.text(id).with("address", address).with("value", format!("0x{value:02X}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::bits::{MaskedBytes, parse_hex};
    use crate::units::Moment;

    fn decode(meaning: &mut FrameDecoder, direction: Direction, text: &str) -> (Option<TraceFault>, String) {
        let bytes = MaskedBytes::unmasked(&parse_hex(text).unwrap());
        let said = meaning.explain(&TraceEntry { at: Moment::START, direction, bytes });
        let words: Vec<String> = said.meaning.iter().map(|text| text.to_string_in(Language::English)).collect();
        (said.fault, words.join(" "))
    }

    /// Damaged frames on the configuration pin (section 6 of the UBICOM reference) are explained and marked even if the
    /// reply follows (issue 22.11).
    #[test]
    fn explains_and_marks_corrupt_replies() {
        let request = "80 01 01 02 00 26 00 55";
        let cases = [
            ("good", "80 01 01 01 00 4B 31", None, "0x4B"),
            ("a bit flipped", "80 01 01 01 00 4A 31", Some(TraceFault::Broken), "7"),
            ("cut short", "80 01 01", Some(TraceFault::Broken), "3"),
            ("no frame", "55 55", Some(TraceFault::Broken), "2"),
            ("the reply to a write", "80 01 02 01 00 90 EB", Some(TraceFault::Broken), ""),
        ];
        for (label, reply, fault, words) in cases {
            let mut meaning = FrameDecoder::default();
            assert_eq!(decode(&mut meaning, Direction::Sent, request).0, None);
            let told = decode(&mut meaning, Direction::Received, reply);
            assert!(told.0 == fault && told.1.contains(words) && !told.1.is_empty(), "{label}: {told:?}");
            if fault.is_some() {
                let then = decode(&mut meaning, Direction::Received, "80 01 01 01 00 4B 31");
                assert_eq!(then, (None, "0x4B".to_owned()), "{label}");
            }
        }
        let mut meaning = FrameDecoder::default();
        decode(&mut meaning, Direction::Sent, "80 01 02 03 00 2B 00 2A 24");
        assert_eq!(decode(&mut meaning, Direction::Received, "80 01 02 01 00 A0 DB").0, Some(TraceFault::Reported));
        // On the link to an adapter, a packet with a wrong checksum is marked.
        let sent = bridge::Request::Hello.emit(1).emit();
        let mut broken = sent.clone();
        broken[2] ^= 1;
        let hex = |bytes: &[u8]| crate::bits::hex(bytes);
        assert_eq!(decode(&mut meaning, Direction::Sent, &hex(&sent)).0, None);
        assert_eq!(decode(&mut meaning, Direction::Received, &hex(&broken)).0, Some(TraceFault::Broken));
    }
}
