//! Describes the extended type label byte by byte.

use crate::app::Text;
use crate::bits::hex;
use crate::devices::hiperface::protocol::{ExtendedLabel, LabelPart};
use crate::devices::hiperface::state::TEXTS;

/// Group of bytes in the extended type label, with its meaning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelRow {
    /// Address of the byte, or first and last address.
    pub addresses: String,
    pub bytes: String,
    pub meaning: Text,
}

/// Returns the rows of an extended type label, or an empty list if the bytes are not a label. Invalid limits are
/// omitted.
pub fn label_rows(bytes: &[u8]) -> Vec<LabelRow> {
    let Ok(parts) = ExtendedLabel::parse_parts(bytes) else { return Vec::new() };
    let flags = bytes.get(1).copied().unwrap_or(0);
    let linear = flags & ExtendedLabel::LINEAR != 0;
    let fits = ExtendedLabel::parse(bytes).is_ok_and(|label| label.checksum_fits);
    parts
        .into_iter()
        .filter_map(|(address, count, part)| {
            let own = bytes.get(address..address + count)?;
            let addresses = match count {
                1 => format!("{address:02X}h"),
                _ => format!("{address:02X}…{:02X}h", address + count - 1),
            };
            Some(LabelRow { addresses, bytes: hex(own), meaning: part_meaning(part, linear, flags, fits)? })
        })
        .collect()
}

fn part_meaning(part: LabelPart, linear: bool, flags: u8, fits: bool) -> Option<Text> {
    Some(match part {
        LabelPart::Checksum => TEXTS.text(if fits { "label.checksum" } else { "label.checksum_other" }),
        LabelPart::Flags => {
            let kind = TEXTS.text(if linear { "label.linear" } else { "label.rotary" });
            let bipolar = flags & ExtendedLabel::BIPOLAR != 0;
            let counting = TEXTS.text(if bipolar { "label.bipolar" } else { "label.unipolar" });
            TEXTS.text("label.flags").with_text("kind", kind).with_text("counting", counting)
        }
        LabelPart::Resolution(number) => {
            TEXTS.text(if linear { "label.period" } else { "label.periods" }).with("number", number)
        }
        LabelPart::Range(number) => {
            TEXTS.text(if linear { "label.range" } else { "label.turns" }).with("number", number)
        }
        LabelPart::Designation => TEXTS.text("label.designation"),
        LabelPart::Selector(_) => TEXTS.text("label.selector"),
        LabelPart::Limit { valid: false, .. } => return None,
        LabelPart::Limit { number, value, .. } => TEXTS.text("label.limit").with("number", number).with("value", value),
    })
}
