//! Position frames of the kit encoder, which consist of 16 multiturn bits, 17 singleturn bits, an error bit, a warning
//! bit and a CRC-6. A position word consists only of the multiturn and singleturn bits.

use serde_json::{Map, Value as Json, json};

use super::form_map;
use crate::bits::{hex, hex_compact};
use crate::buses::ubicom::protocol::PositionWord;
use crate::cli::decode::FrameExplanation;
use crate::devices::biss::protocol::{FrameError, Layout, PositionData};

/// Number of bytes in a right-justified frame.
pub(super) const BYTES: usize = 6;

/// Number of hexadecimal digits in a 33-bit position word, as shown by the `position` command and in the window.
pub(super) const WORD_DIGITS: usize = 9;

/// Decodes the bytes of one frame. Returns `None` if the number of bytes is wrong or surplus bits are set.
pub(super) fn decode_bytes(bytes: &[u8]) -> Option<FrameExplanation> {
    let raw = bytes.iter().fold(0, |raw: u64, byte| raw << 8 | u64::from(*byte));
    let fits = bytes.len() == BYTES && raw >> Layout::default().bits() == 0;
    fits.then(|| FrameExplanation { compact: hex_compact(bytes), ..explain_frame(raw, hex(bytes)) })
}

/// Decodes a frame. `shown` is the frame as the user typed it.
pub(super) fn explain_frame(raw: u64, shown: String) -> FrameExplanation {
    let mut more = form_map("position frame");
    let meaning = explain_fields(raw, &mut more);
    FrameExplanation { compact: shown.clone(), shown, meaning, more }
}

pub(super) fn explain_position_word(raw: u64, shown: String) -> FrameExplanation {
    let layout = Layout::default();
    let mut more = form_map("position word");
    let bits = layout.multiturn_bits() + layout.singleturn_bits();
    let meaning = match PositionWord::new(raw).and_then(|word| layout.decode_position(word)) {
        Some(reading) => Ok(vec![describe_position(&layout, &reading, raw, &mut more)]),
        None => Err(format!("the position word of this encoder has {bits} bits, this one more")),
    };
    FrameExplanation { compact: shown.clone(), shown, meaning, more }
}

/// Describes a position in turns, steps and degrees, and adds these values to the JSON output.
fn describe_position(layout: &Layout, reading: &PositionData, raw: u64, more: &mut Map<String, Json>) -> String {
    let (turns, steps, degrees) = (reading.multiturn, reading.singleturn, layout.position_to_degrees(reading));
    let pairs = [("raw", json!(raw)), ("turns", json!(turns)), ("steps", json!(steps)), ("degrees", json!(degrees))];
    more.extend(pairs.map(|(key, value)| (key.to_owned(), value)));
    format!("turn {turns}, step {steps} of {}, {degrees:.6}°", 1u64 << layout.singleturn_bits())
}

/// Returns one line per field of a frame, or an error if the bits are not a valid frame.
pub(super) fn explain_fields(raw: u64, more: &mut Map<String, Json>) -> Result<Vec<String>, String> {
    let layout = Layout::default();
    match layout.parse(raw) {
        Ok(reading) => {
            let word = layout.position_to_steps(&reading);
            let mut lines = vec![describe_position(&layout, &reading, word, more)];
            let flags = [("error", reading.error), ("warning", reading.warning)];
            more.extend(flags.map(|(key, value)| (key.to_owned(), json!(value))));
            lines.push(match (reading.error, reading.warning) {
                (true, true) => "error and warning bit: the position is invalid".to_owned(),
                (true, false) => "error bit: the position is invalid".to_owned(),
                (false, true) => "warning bit: the position is valid".to_owned(),
                (false, false) => "no error, no warning".to_owned(),
            });
            Ok(lines)
        }
        Err(FrameError::Crc { expected, got }) => {
            let bits = layout.crc_bits();
            Err(format!("CRC-{bits} of the position frame is {got:02X} where {expected:02X} was expected"))
        }
        Err(FrameError::StuckLow) => Err("all bits are 0: the line stays low".to_owned()),
        Err(FrameError::StuckHigh) => Err("all bits are 1: the line stays high".to_owned()),
        Err(FrameError::Long { bits }) => Err(format!("the position frame of this encoder has {bits} bits")),
    }
}
