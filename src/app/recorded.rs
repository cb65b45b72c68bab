//! Names that stand in people's files: settings and drafts of today are read and written word for word the same.

use std::fmt::Debug;

use super::session::Kind;
use super::{Settings, Tab};
use crate::devices::biss::jobs::Biss;
use crate::devices::hiperdrive::jobs::Hiperdrive;
use crate::devices::hiperface::jobs::Hiperface;
use crate::devices::interbus::jobs::Interbus;
use crate::devices::ssi::jobs::Ssi;

/// Every entry, tab, measure and mark.
pub(crate) const SETTINGS: &str = include_str!("../../tests/fixtures/settings/settings.ron");

#[test]
fn settings_are_read_and_written_as_recorded() {
    let settings = Settings::parse(SETTINGS).unwrap();
    assert_eq!(settings.emit(), SETTINGS.trim_end());
    let tabs = [Tab::Hiperface, Tab::Biss, Tab::Ssi, Tab::Interbus, Tab::Hiperdrive, Tab::Signals];
    assert!(tabs.iter().all(|tab| settings.links(*tab).len() == 1));
    assert_eq!(Settings::salvage(SETTINGS), settings);
}

fn assert_recorded<D: Kind>(kind: &str, draft: &str)
where
    D::Edits: Debug,
{
    assert_eq!(D::KIND, kind, "the name of a folder");
    let edits: D::Edits = ron::from_str(draft).unwrap();
    assert_eq!(ron::to_string(&edits).unwrap(), draft, "{kind}");
}

#[test]
fn drafts_are_read_and_written_as_recorded() {
    assert_recorded::<Hiperface>("hiperface", "[(0,2,60),(3,15,255)]");
    assert_recorded::<Biss>("biss", "[(2304,7),(2367,255)]");
    assert_recorded::<Hiperdrive>("hiperdrive", "[(166,Some(200)),(358,Some(-4000)),(24,None)]");
    let kept = "[Gear(3600,1),Direction(4),Preset(17),ZeroShift(3),Shift(2),Cam(1,7,10,20),NoCam(2,0),On(1,7,true),\
                Name(1,7,\"Door\"),ProgramName(1,\"Fill\")]";
    assert_recorded::<Interbus>("interbus", kept);
    assert_recorded::<Ssi>("ssi", "[\"(path:[Entry(\\\"clocks\\\")],from:Some(\\\"24\\\"))\"]");
}

/// A change of a text, as it stands in a draft of an SSI layout.
#[test]
fn a_change_is_read_and_written_as_recorded() {
    let change = "(path:[Entry(\"ranges\"),Named(\"name\",\"error\"),At(2)],from:Some(\"24\"),to:None,\
                  behind:[Entry(\"clocks\")],comments:(Some(\"was\"),None),heading:[\"above\"])";
    let read: crate::profile::Change = ron::from_str(change).unwrap();
    assert_eq!(ron::to_string(&read).unwrap(), change);
}
