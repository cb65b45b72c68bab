//! Compares two encoders, or an encoder with a profile. Each run of differing or equal bytes is one item.

use super::{FieldImage, FieldRange, Item};
use crate::bits::hex_compact;
use crate::profile::{ComparedItem, Comparison};

pub(super) fn compare(left: &[FieldImage], right: &[FieldImage]) -> Comparison {
    let mut comparison = Comparison::default();
    let mut numbers: Vec<u8> = left.iter().chain(right).map(|field| field.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let find = |side: &[FieldImage], number| side.iter().find(|field| field.number == number).cloned();
    for number in numbers {
        match (find(left, number), find(right, number)) {
            (Some(left), Some(right)) => compare_fields(&left, &right, &mut comparison),
            (left, right) => {
                let [left, right] = [left, right].map(|field| field.map(|field| bytes_text(&field)));
                comparison.items.push(ComparedItem { left, right, ..item(FieldRange::whole_field(number)) });
            }
        }
    }
    comparison
}

fn compare_fields(left: &FieldImage, right: &FieldImage, comparison: &mut Comparison) {
    let status = |field: &FieldImage| Some(format!("{:02X}", field.status.byte()));
    comparison.compare_item(Item::Status(left.number).to_string(), status(left), status(right));
    match (&left.bytes, &right.bytes) {
        (Some(a), Some(b)) => compare_bytes(left.number, a, b, comparison),
        (None, None) => {}
        (one, other) => {
            let range = FieldRange::whole_field(left.number);
            let [left, right] = [one, other].map(|bytes| bytes.as_deref().map(hex_compact));
            comparison.items.push(ComparedItem { left, right, ..item(range) });
        }
    }
}

fn compare_bytes(number: u8, left: &[u8], right: &[u8], comparison: &mut Comparison) {
    comparison.compare_bytes(left, right, |run| item(FieldRange::new(number, run.start, run.len())));
    let common = left.len().min(right.len());
    let longer = left.len().max(right.len());
    if longer > common {
        let rest = |side: &[u8]| side.get(common..).filter(|rest| !rest.is_empty()).map(hex_compact);
        let range = FieldRange::new(number, common, longer - common);
        comparison.items.push(ComparedItem { left: rest(left), right: rest(right), ..item(range) });
    }
}

fn item(range: FieldRange) -> ComparedItem {
    ComparedItem { item: range.to_string(), ..ComparedItem::default() }
}

/// Returns the bytes of a field in hexadecimal, or an empty string if they could not be read.
fn bytes_text(field: &FieldImage) -> String {
    field.bytes.as_deref().map(hex_compact).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperface::protocol::DataFieldStatus;

    fn field(number: u8, status: u8, bytes: Option<&[u8]>) -> FieldImage {
        FieldImage { number, status: DataFieldStatus::from_byte(status), bytes: bytes.map(<[u8]>::to_vec) }
    }

    #[test]
    fn lists_only_differences() {
        let mut changed = [0u8; 16];
        changed[3..5].copy_from_slice(&[0x08, 0x15]);
        changed[15] = 1;
        let left = [field(0, 0xC8, Some(&[0; 16])), field(1, 0xE8, None), field(2, 0xC8, Some(&[0; 16]))];
        let right = [field(0, 0x88, Some(&changed)), field(1, 0xE8, None)];
        let comparison = compare(&left, &right);
        let differences = comparison.differences();
        let items: Vec<(&str, &str, &str)> =
            differences.iter().map(|d| (d.item.as_str(), d.left.as_str(), d.right.as_str())).collect();
        assert_eq!(items, [("status:0", "C8", "88"), ("field:0@3+2", "0000", "0815"), ("field:0@15+1", "00", "01")]);
        assert_eq!(comparison.only_left(), ["field:2"]);
        assert_eq!(comparison.compared, 1 + 16 + 1);
    }

    #[test]
    fn lists_bytes_missing_on_one_side() {
        let comparison = compare(
            &[field(0, 0xC8, Some(&[0; 16])), field(1, 0xE8, Some(&[0; 16]))],
            &[field(0, 0xC9, Some(&[0; 32])), field(1, 0xE8, None)],
        );
        assert_eq!(comparison.only_right(), ["field:0@16+16"]);
        assert_eq!(comparison.only_left(), ["field:1"]);
    }
}
