//! Tests that stored names never change: settings and edits from existing files must be read and written back
//! unchanged. Tests of drafts are in the folders of their devices.

use std::fmt::Debug;

use super::session::Kind;
use super::{Settings, Tab};

/// A settings file that contains every entry, tab, unit and mark.
pub(crate) const SETTINGS: &str = include_str!("../../tests/fixtures/settings/settings.ron");

#[test]
fn settings_match_recorded_file() {
    let settings = Settings::parse(SETTINGS).unwrap();
    assert_eq!(settings.emit(), SETTINGS.trim_end());
    let tabs = [
        Tab::named("Hiperface"),
        Tab::named("Biss"),
        Tab::named("Ssi"),
        Tab::named("Interbus"),
        Tab::named("Hiperdrive"),
        Tab::named("Signals"),
    ];
    assert!(tabs.iter().all(|tab| settings.links_of(*tab).len() == 1));
    assert_eq!(Settings::parse_partial(SETTINGS), settings);
}

/// Checks that a device's draft is read and written back unchanged under the name of its kind.
pub(crate) fn assert_recorded<D: Kind>(kind: &str, draft: &str)
where
    D::Edits: Debug,
{
    assert_eq!(D::KIND, kind, "the name of a folder");
    let edits: D::Edits = ron::from_str(draft).unwrap();
    assert_eq!(ron::to_string(&edits).unwrap(), draft, "{kind}");
}

#[test]
fn settings_changes_match_recorded_file() {
    let change = "(path:[Entry(\"ranges\"),Named(\"name\",\"error\"),At(2)],from:Some(\"24\"),to:None,\
                  behind:[Entry(\"clocks\")],comments:(Some(\"was\"),None),heading:[\"above\"])";
    let read: crate::profile::Change = ron::from_str(change).unwrap();
    assert_eq!(ron::to_string(&read).unwrap(), change);
}
