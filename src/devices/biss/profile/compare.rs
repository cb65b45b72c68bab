//! Comparison of two encoders, or of an encoder with a profile. Consecutive registers that differ are one item.

use super::{Bank, BissProfile, RegisterRange};
use crate::bits::hex_compact;
use crate::devices::biss::protocol::RegisterAddress;
use crate::profile::difference::differing_ranges;
use crate::profile::{Comparison, Difference};

/// Compares the filter, the preset value and the data areas. Recorded values are not compared.
pub(super) fn compare(left: &BissProfile, right: &BissProfile) -> Comparison {
    let mut comparison = Comparison::default();
    let filter = |profile: &BissProfile| profile.filter.map(|filter| vec![filter.byte()]);
    compare_bytes(BissProfile::FILTER, filter(left), filter(right), &mut comparison);
    let preset = |profile: &BissProfile| profile.preset.as_ref().map(|preset| preset.value.emit().to_vec());
    compare_bytes(BissProfile::PRESET, preset(left), preset(right), &mut comparison);
    let mut numbers: Vec<u8> = left.banks().chain(right.banks()).map(|bank| bank.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    for number in numbers {
        let bytes = |bank: Bank| bank.bytes.to_vec();
        let Some(place) = RegisterAddress::in_bank(number, 0) else { continue };
        let (left, right) = (left.bank(number).map(bytes), right.bank(number).map(bytes));
        compare_bytes(&format!("{place}+{}", Bank::SIZE), left, right, &mut comparison);
    }
    comparison
}

/// Compares the bytes of the registers `item`. The bytes are `None` for a side that does not have the registers.
fn compare_bytes(item: &str, left: Option<Vec<u8>>, right: Option<Vec<u8>>, comparison: &mut Comparison) {
    let (left, right) = match (left, right) {
        (Some(left), Some(right)) => (left, right),
        (Some(_), None) => return comparison.only_left.push(item.to_owned()),
        (None, Some(_)) => return comparison.only_right.push(item.to_owned()),
        (None, None) => return,
    };
    comparison.compared += left.len() as u64;
    let Ok(all) = item.parse::<RegisterRange>() else { return };
    for run in differing_ranges(&left, &right) {
        let part = |side: &[u8]| hex_compact(side.get(run.clone()).unwrap_or_default());
        let addresses = all.addresses().skip(run.start).take(run.len());
        let item = RegisterRange::from_addresses(addresses).first().map(ToString::to_string).unwrap_or_default();
        comparison.differences.push(Difference { item, left: part(&left), right: part(&right) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::biss::profile::test_profiles::{profile, set_bank_bytes};
    use crate::devices::biss::protocol::PositionFilter;

    fn listed(comparison: &Comparison) -> Vec<(&str, &str, &str)> {
        comparison.differences.iter().map(|d| (d.item.as_str(), d.left.as_str(), d.right.as_str())).collect()
    }

    #[test]
    fn only_differences_are_listed() {
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
        assert_eq!(listed(&comparison), expected);
        // One filter, six registers of the preset value, 64 banks.
        assert_eq!(comparison.compared, 1 + 6 + 64 * 64);
        assert_eq!(comparison.one_sided_items(), Vec::<String>::new());
        assert_eq!(compare(&right, &right).differences, []);
    }

    #[test]
    fn values_absent_on_one_side_are_listed() {
        let mut left = profile("1");
        let mut right = profile("1");
        left.data[1].empty = None;
        set_bank_bytes(&mut left, 0x30, &[(0, 1)]);
        (right.filter, right.preset) = (None, None);
        let comparison = compare(&left, &right);
        assert_eq!(comparison.only_left, ["0x6E", "0x01:0x02+6"]);
        assert_eq!(comparison.only_right.len(), 31);
        assert_eq!(comparison.only_right[0], "0x24:0x00+64");
        assert_eq!(listed(&comparison), [("0x30:0x00", "01", "00")]);
        assert_eq!(comparison.compared, 33 * 64);
    }
}
