//! Names and values of parameters as shown in comparisons, the logbook and reports.

use std::collections::BTreeMap;

use super::rows::Row;
use super::{HiperdriveDevice, TEXTS, explain};
use crate::app::explain::literal_text;
use crate::app::session::Session;
use crate::app::{ItemValue, ItemValues, Text};
use crate::devices::hiperdrive::profile::{HiperdriveProfile, Item};
use crate::profile::ProfileDocument;

/// Returns the name of an item, or `None` if the manual does not list the parameter.
pub(super) fn item_name(item: &str) -> Option<Text> {
    match item {
        "network" => Some(TEXTS.text("hd_op.network")),
        item => Some(explain::item_text(item.parse::<Item>().ok()?)),
    }
}

/// Returns the heading of the group that a parameter belongs to: its drive, or the device.
pub(super) fn item_group(item: &str) -> Option<Text> {
    Some(match item.parse::<Item>().ok()?.0.drive() {
        Some(drive) => TEXTS.text("report.hd_drive").with("drive", drive.get()),
        None => TEXTS.text("hd_params.device"),
    })
}

/// Returns a function that gives the values of a profile with unit and meaning.
pub(super) fn item_values(profile: &HiperdriveProfile, document: &ProfileDocument) -> ItemValues {
    let mut unit = HiperdriveDevice::from_session(Session::without_tab(document));
    unit.adopt_profile(profile);
    let drives = unit.drives().into_iter().map(Some).chain([None]);
    let rows = drives.flat_map(|drive| unit.rows(drive)).filter(|row| row.value.is_some());
    let values: BTreeMap<String, Text> = rows.map(|row| (Item(row.number).to_string(), value_text(row))).collect();
    Box::new(move |item, _| values.get(item).cloned().map(ItemValue::Text))
}

fn value_text(row: Row) -> Text {
    let value = literal_text(row.shown);
    let value = match row.unit {
        Some(unit) => Text::new("item_value.unit").with_text("value", value).with_text("unit", unit),
        None => value,
    };
    match row.meaning {
        Some(meaning) => Text::new("item_value.meaning").with_text("value", value).with_text("meaning", meaning),
        None => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};

    #[test]
    fn translates_parameter_names() {
        for (item, english, german) in [
            ("158", "158 Lower limit", "158 Untere Grenze"),
            ("158 drive 2", "158 Lower limit, drive 2", "158 Untere Grenze, Antrieb 2"),
        ] {
            let name = item_name(item).unwrap();
            assert_eq!((name.to_string_in(English).as_str(), name.to_string_in(German).as_str()), (english, german));
        }
        assert!(item_name("network").is_some());
        assert_eq!(item_name("155"), None);
    }
}
