//! Differences between two encoders, or between an encoder and a profile: one item for each run of differing bytes.

use super::{FieldImage, FieldRange, Item};
use crate::bits::hex_compact;
use crate::profile::difference::differing_ranges;
use crate::profile::{Comparison, Difference};

pub(super) fn compare(left: &[FieldImage], right: &[FieldImage]) -> Comparison {
    let mut comparison = Comparison::default();
    let mut numbers: Vec<u8> = left.iter().chain(right).map(|field| field.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let find = |side: &[FieldImage], number| side.iter().find(|field| field.number == number).cloned();
    for number in numbers {
        match (find(left, number), find(right, number)) {
            (Some(left), Some(right)) => compare_fields(&left, &right, &mut comparison),
            (Some(_), None) => comparison.only_left.push(field_name(number)),
            (None, _) => comparison.only_right.push(field_name(number)),
        }
    }
    comparison
}

fn compare_fields(left: &FieldImage, right: &FieldImage, comparison: &mut Comparison) {
    comparison.compared += 1;
    if left.status != right.status {
        comparison.differences.push(Difference {
            item: Item::Status(left.number).to_string(),
            left: format!("{:02X}", left.status.byte()),
            right: format!("{:02X}", right.status.byte()),
        });
    }
    match (&left.bytes, &right.bytes) {
        (Some(a), Some(b)) => compare_bytes(left.number, a, b, comparison),
        (None, None) => {}
        (Some(_), None) => comparison.only_left.push(field_name(left.number)),
        (None, Some(_)) => comparison.only_right.push(field_name(left.number)),
    }
}

fn compare_bytes(number: u8, left: &[u8], right: &[u8], comparison: &mut Comparison) {
    let common = left.len().min(right.len());
    comparison.compared += common as u64;
    for run in differing_ranges(left, right) {
        let part = |side: &[u8]| hex_compact(side.get(run.clone()).unwrap_or_default());
        comparison.differences.push(Difference {
            item: FieldRange::new(number, run.start, run.len()).to_string(),
            left: part(left),
            right: part(right),
        });
    }
    let rest = |side: &[u8]| FieldRange::new(number, common, side.len() - common).to_string();
    if left.len() > common {
        comparison.only_left.push(rest(left));
    } else if right.len() > common {
        comparison.only_right.push(rest(right));
    }
}

fn field_name(number: u8) -> String {
    FieldRange { field: number, start: 0, count: None }.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperface::protocol::DataFieldStatus;

    fn field(number: u8, status: u8, bytes: Option<&[u8]>) -> FieldImage {
        FieldImage { number, status: DataFieldStatus::from_byte(status), bytes: bytes.map(<[u8]>::to_vec) }
    }

    #[test]
    fn only_differences_are_listed() {
        let mut changed = [0u8; 16];
        changed[3..5].copy_from_slice(&[0x08, 0x15]);
        changed[15] = 1;
        let left = [field(0, 0xC8, Some(&[0; 16])), field(1, 0xE8, None), field(2, 0xC8, Some(&[0; 16]))];
        let right = [field(0, 0x88, Some(&changed)), field(1, 0xE8, None)];
        let comparison = compare(&left, &right);
        let items: Vec<(&str, &str, &str)> =
            comparison.differences.iter().map(|d| (d.item.as_str(), d.left.as_str(), d.right.as_str())).collect();
        assert_eq!(items, [("status:0", "C8", "88"), ("field:0@3+2", "0000", "0815"), ("field:0@15+1", "00", "01")]);
        assert_eq!(comparison.only_left, ["field:2"]);
        assert_eq!(comparison.compared, 1 + 16 + 1);
    }

    #[test]
    fn longer_and_unreadable_fields_are_missing_on_one_side() {
        let comparison = compare(
            &[field(0, 0xC8, Some(&[0; 16])), field(1, 0xE8, Some(&[0; 16]))],
            &[field(0, 0xC9, Some(&[0; 32])), field(1, 0xE8, None)],
        );
        assert_eq!(comparison.only_right, ["field:0@16+16"]);
        assert_eq!(comparison.only_left, ["field:1"]);
    }
}
