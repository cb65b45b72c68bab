//! Decoding of UBICOM frames, which are assumed to contain the low byte of a register number first.

use super::form_map;
use crate::bits::{ByteOrder, hex, hex_compact};
use crate::buses::ubicom::protocol::{Frame, NODE, PositionWord, Reply, Request, WriteReply};
use crate::cli::decode::FrameExplanation;
use crate::devices::biss::commands::register_text;
use crate::devices::biss::protocol::{Layout, RegisterAddress};

/// Decodes frames. `requested` is the request to which the first frame may be the reply. It is updated with each
/// decoded request.
pub(super) fn explain_frames(bytes: &[u8], requested: &mut Option<Request>) -> Vec<FrameExplanation> {
    let mut explained = Vec::new();
    let mut request = *requested;
    let mut rest = bytes;
    while !rest.is_empty() {
        let (own, more) = rest.split_at_checked(first_frame_length(rest)).unwrap_or((rest, &[]));
        rest = more;
        let meaning = match Frame::parse(own) {
            Ok(frame) => explain_payload(&frame, &mut request),
            Err(error) => Err(format!("no UBICOM frame: {error}")),
        };
        explained.push(FrameExplanation {
            shown: hex(own),
            compact: hex_compact(own),
            meaning,
            more: form_map("UBICOM"),
        });
    }
    if explained.iter().all(|one| one.meaning.is_ok()) {
        *requested = request;
    }
    explained
}

/// Returns the length of the first frame according to its header.
fn first_frame_length(bytes: &[u8]) -> usize {
    match bytes {
        [_, _, _, low, high, ..] => usize::from(u16::from_le_bytes([*low, *high])) + Frame::OVERHEAD,
        _ => bytes.len(),
    }
}

fn explain_payload(frame: &Frame<'_>, request: &mut Option<Request>) -> Result<Vec<String>, String> {
    let mut lines = Vec::new();
    if frame.address != NODE {
        lines.push(format!("of node 0x{:02X}, which no encoder has", frame.address));
    }
    if let Ok(requested) = Request::parse(frame, ByteOrder::LowFirst) {
        lines.push(match requested {
            Request::Read { register } => format!("read register {}", register_number_text(register)),
            Request::Write { register, value } => {
                format!("write 0x{value:02X} to register {}", register_number_text(register))
            }
            Request::Position { argument: 0x01 } => "read the position".to_owned(),
            Request::Position { argument } => format!("read the position, with the argument 0x{argument:02X}"),
        });
        *request = Some(requested);
        return Ok(lines);
    }
    let unknown = |error: &dyn std::fmt::Display| format!("a UBICOM frame that is neither request nor reply: {error}");
    let command = crate::buses::ubicom::protocol::Command::from_byte(frame.command)
        .ok_or_else(|| unknown(&format!("0x{:02X} is not a command", frame.command)))?;
    let own = Frame { address: NODE, ..*frame };
    lines.push(match Reply::parse(&own, command).map_err(|error| unknown(&error))? {
        Reply::Value(value) => match request.take() {
            Some(Request::Read { register }) => value_description(register, value),
            _ => format!("value 0x{value:02X}"),
        },
        Reply::Written(WriteReply::Acknowledged) => "written".to_owned(),
        Reply::Written(WriteReply::Refused) => "refused: not written".to_owned(),
        Reply::Written(WriteReply::Unknown(byte)) => format!("neither acknowledged nor refused: 0x{byte:02X}"),
        Reply::Position(word) => position_text(word),
    });
    *request = None;
    Ok(lines)
}

/// Returns the number of a register, followed by its name if the kit encoder has the register.
fn register_number_text(register: u16) -> String {
    match RegisterAddress::from_global(register) {
        None => format!("0x{register:04X}, which is behind the last"),
        Some(address) => match register_text::name(address) {
            Some(name) => format!("{address} ({name})"),
            None => address.to_string(),
        },
    }
}

fn value_description(register: u16, value: u8) -> String {
    let Some(address) = RegisterAddress::from_global(register) else { return format!("value 0x{value:02X}") };
    match register_text::register_meaning(address, &[value]) {
        Some(meaning) => format!("register {} is 0x{value:02X}: {meaning}", register_number_text(register)),
        None => format!("register {} is 0x{value:02X}", register_number_text(register)),
    }
}

fn position_text(word: PositionWord) -> String {
    let layout = Layout::default();
    match layout.decode_position(word) {
        None => format!("position 0x{:X}, which has more than 33 bits", word.to_u64()),
        Some(reading) => {
            let (turns, steps) = (reading.multiturn, reading.singleturn);
            format!("position: turn {turns}, step {steps} of 131072, {:.6}°", layout.position_to_degrees(&reading))
        }
    }
}
