//! Tests of the format in which drafts are stored.

use crate::app::recorded::assert_recorded;
use crate::devices::ssi::jobs::Ssi;

#[test]
fn draft_matches_recorded_text() {
    assert_recorded::<Ssi>("ssi", "[\"(path:[Entry(\\\"clocks\\\")],from:Some(\\\"24\\\"))\"]");
}
