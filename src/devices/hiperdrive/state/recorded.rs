//! Tests of the format in which drafts are stored in users' files.

use crate::app::recorded::assert_recorded;
use crate::devices::hiperdrive::jobs::Hiperdrive;

#[test]
fn draft_matches_recorded_text() {
    assert_recorded::<Hiperdrive>("hiperdrive", "[(166,Some(200)),(358,Some(-4000)),(24,None)]");
}
