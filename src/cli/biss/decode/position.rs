//! A position frame of the kit encoder: 16 bits of turns, 17 of steps, error, warning, CRC-6.

use serde_json::{Map, Value as Json, json};

use super::form;
use crate::bits::{hex, hex_compact};
use crate::cli::decode::Explained;
use crate::protocol::biss::{FrameError, Layout};

/// Bytes that hold a frame, right-justified.
pub(super) const BYTES: usize = 6;

/// As many bytes as a frame needs; `None` where they are more or have other bits than it.
pub(super) fn of_bytes(bytes: &[u8]) -> Option<Explained> {
    let raw = bytes.iter().fold(0, |raw: u64, byte| raw << 8 | u64::from(*byte));
    let fits = bytes.len() == BYTES && raw >> Layout::default().bits() == 0;
    fits.then(|| Explained { compact: hex_compact(bytes), ..explain(raw, hex(bytes)) })
}

/// What the bits say that were written like this.
pub(super) fn explain(raw: u64, shown: String) -> Explained {
    let mut more = form("position frame");
    let meaning = meaning(raw, &mut more);
    Explained { compact: shown.clone(), shown, meaning, more }
}

/// A line each; or why they are no frame.
pub(super) fn meaning(raw: u64, more: &mut Map<String, Json>) -> Result<Vec<String>, String> {
    let layout = Layout::default();
    match layout.parse(raw) {
        Ok(reading) => {
            let degrees = layout.degrees(&reading);
            let (turns, steps) = (reading.multiturn, reading.singleturn);
            for (key, value) in [
                ("raw", json!(raw)),
                ("turns", json!(turns)),
                ("steps", json!(steps)),
                ("degrees", json!(degrees)),
                ("error", json!(reading.error)),
                ("warning", json!(reading.warning)),
            ] {
                more.insert(key.to_owned(), value);
            }
            let steps_of_turn = 1u64 << layout.singleturn_bits();
            let mut lines = vec![format!("turn {turns}, step {steps} of {steps_of_turn}, {degrees:.6}°")];
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
