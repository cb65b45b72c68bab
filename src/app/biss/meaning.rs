//! What the frames of the trace say: a reply is read with the request before it, a register over the bus with the bank that
//! was selected.

use crate::app::Text;
use crate::app::explain::{plain, traced as adapter};
use crate::link::{Direction, TraceEntry};
use crate::protocol::biss::{ByteOrder, RegisterAddress};
use crate::protocol::bridge;
use crate::protocol::ubicom::{Frame, Reply, Request, SYNC, Written};

/// Reads frames in the order in which they went over the line.
#[derive(Debug, Default)]
pub(super) struct Meaning {
    /// Which byte of a register's number comes first, once it is known.
    pub(super) order: Option<ByteOrder>,
    asked: Option<Request>,
    bank: Option<u8>,
}

impl Meaning {
    /// What a frame says, and nothing for bytes that are no frame.
    pub(super) fn of(&mut self, entry: &TraceEntry) -> Vec<Text> {
        let Some(bytes) = entry.bytes.to_bytes() else { return Vec::new() };
        let ubicom = bytes.first() == Some(&SYNC);
        let said = match entry.direction {
            Direction::Sent if ubicom => self.request(&bytes),
            Direction::Received if ubicom => self.reply(&bytes),
            _ => self.packet(&bytes),
        };
        said.into_iter().collect()
    }

    fn request(&mut self, bytes: &[u8]) -> Option<Text> {
        let frame = Frame::parse(bytes).ok()?;
        self.asked = Request::parse(&frame, self.order.unwrap_or(ByteOrder::LowFirst)).ok();
        let place = |register| RegisterAddress::from_global(register).map_or_else(String::new, |at| at.to_string());
        Some(match self.asked? {
            Request::Read { register } => Text::new("trace.read").with("address", place(register)),
            Request::Write { register, value } => written("trace.write", place(register), value),
            Request::Position { .. } => Text::new("trace.position"),
        })
    }

    fn reply(&mut self, bytes: &[u8]) -> Option<Text> {
        let asked = self.asked.take()?;
        let frame = Frame::parse(bytes).ok()?;
        Some(match Reply::parse(&frame, asked.command()).ok()? {
            Reply::Value(value) => plain(format!("0x{value:02X}")),
            Reply::Written(Written::Acknowledged) => Text::new("trace.taken"),
            Reply::Written(Written::Refused) => Text::new("trace.refused"),
            Reply::Written(Written::Unknown(code)) => plain(format!("0x{code:02X}")),
            Reply::Position(word) => plain(format!("0x{:X}", word.word())),
        })
    }

    fn packet(&mut self, bytes: &[u8]) -> Option<Text> {
        let packet = adapter::packet(bytes)?;
        match bridge::Request::parse(&packet) {
            Ok(request) => Some(self.asked_of_adapter(&request)),
            Err(_) => adapter::said(&packet),
        }
    }

    fn asked_of_adapter(&mut self, request: &bridge::Request) -> Text {
        let place = |address| {
            let at = if address < RegisterAddress::BANK_SIZE {
                self.bank.and_then(|bank| RegisterAddress::banked(bank, address))
            } else {
                RegisterAddress::direct(address)
            };
            at.map_or_else(|| format!("0x{address:02X}"), |at| at.to_string())
        };
        match *request {
            bridge::Request::BissRegisterRead { address, .. } => {
                Text::new("trace.read").with("address", place(address))
            }
            bridge::Request::BissRegisterWrite { address, value, .. } => {
                let said = written("trace.write", place(address), value);
                if address == RegisterAddress::BANK_SELECT.address() {
                    self.bank = Some(value);
                }
                said
            }
            ref other => adapter::asked(other),
        }
    }
}

fn written(id: &'static str, address: String, value: u8) -> Text {
    Text::new(id).with("address", address).with("value", format!("0x{value:02X}"))
}
