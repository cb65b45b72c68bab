//! Comparison of two encoders, or of an encoder with a profile. Consecutive registers that differ form one item.

use super::{Bank, BissProfile, RegisterRange};
use crate::bits::hex_compact;
use crate::devices::biss::protocol::RegisterAddress;
use crate::profile::{ComparedItem, Comparison};

/// Compares the filter, the preset value and the data areas. Values that are only recorded are ignored.
pub(super) fn compare(left: &BissProfile, right: &BissProfile) -> Comparison {
    let mut comparison = Comparison::default();
    let filter = |profile: &BissProfile| profile.filter.map(|filter| vec![filter.byte()]);
    compare_bytes((BissProfile::FILTER, None), filter(left), filter(right), &mut comparison);
    let preset = |profile: &BissProfile| profile.preset.as_ref().map(|preset| preset.value.emit().to_vec());
    compare_bytes((BissProfile::PRESET, None), preset(left), preset(right), &mut comparison);
    let mut numbers: Vec<u8> = left.banks().chain(right.banks()).map(|bank| bank.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    for number in numbers {
        let bytes = |bank: Bank| bank.bytes.to_vec();
        let Some(place) = RegisterAddress::in_bank(number, 0) else { continue };
        let name = left.area_name(number).or_else(|| right.area_name(number));
        let (left, right) = (left.bank(number).map(bytes), right.bank(number).map(bytes));
        compare_bytes((&format!("{place}+{}", Bank::SIZE), name), left, right, &mut comparison);
    }
    comparison
}

/// Compares the bytes of the registers `item`, which are `None` on a side without these registers. `name` is the name
/// of the data area.
fn compare_bytes(
    (item, name): (&str, Option<&str>),
    left: Option<Vec<u8>>,
    right: Option<Vec<u8>>,
    comparison: &mut Comparison,
) {
    let named = |item: String| ComparedItem { item, name: name.map(str::to_owned), ..ComparedItem::default() };
    let (left, right) = match (left, right) {
        (Some(left), Some(right)) => (left, right),
        (None, None) => return,
        (left, right) => {
            let [left, right] = [left, right].map(|bytes| bytes.as_deref().map(hex_compact));
            comparison.items.push(ComparedItem { left, right, ..named(item.to_owned()) });
            return;
        }
    };
    let Ok(all) = item.parse::<RegisterRange>() else { return };
    comparison.compare_bytes(&left, &right, |run| {
        let addresses = all.addresses().skip(run.start).take(run.len());
        named(RegisterRange::from_addresses(addresses).first().map(ToString::to_string).unwrap_or_default())
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::profile::test_profiles::{profile, set_bank_bytes};
    use crate::devices::biss::protocol::PositionFilter;

    fn listed(comparison: &Comparison) -> Vec<(String, String, String)> {
        comparison.differences().into_iter().map(|own| (own.item, own.left, own.right)).collect()
    }

    #[test]
    fn lists_only_differences() {
        let left = profile("1");
        let mut right = profile("2");
        set_bank_bytes(&mut right, 0x24, &[(0x10, 0xA1), (0x11, 0xA2), (0x13, 0xA3)]);
        set_bank_bytes(&mut right, 0x23, &[(0x3F, 0x01)]);
        right.filter = Some(PositionFilter::Dynamic);
        right.preset.as_mut().unwrap().value = crate::devices::biss::protocol::PresetValue::new(0x18000, 0).unwrap();
        let comparison = compare(&left, &right);
        let expected = [
            ("0x6E", "03", "04"),
            ("0x01:0x03+2", "0000", "8001"),
            ("0x23:0x3F", "00", "01"),
            ("0x24:0x10+2", "0000", "A1A2"),
            ("0x24:0x13", "00", "A3"),
        ];
        let expected = expected.map(|(item, left, right)| (item.to_owned(), left.to_owned(), right.to_owned()));
        assert_eq!(listed(&comparison), expected);
        // One filter, six registers of the preset value, 64 banks.
        assert_eq!(comparison.compared, 1 + 6 + 64 * 64);
        assert_eq!(comparison.one_sided_items(), Vec::<String>::new());
        assert_eq!(compare(&right, &right).differences(), []);
    }

    #[test]
    fn lists_values_missing_on_one_side() {
        let mut left = profile("1");
        let mut right = profile("1");
        left.data[1].empty = None;
        set_bank_bytes(&mut left, 0x30, &[(0, 1)]);
        (right.filter, right.preset) = (None, None);
        let comparison = compare(&left, &right);
        assert_eq!(comparison.only_left(), ["0x6E", "0x01:0x02+6"]);
        assert_eq!(comparison.only_right().len(), 31);
        assert_eq!(comparison.only_right()[0], "0x24:0x00+64");
        assert_eq!(listed(&comparison), [("0x30:0x00".to_owned(), "01".to_owned(), "00".to_owned())]);
        assert_eq!(comparison.compared, 33 * 64);
    }
}
