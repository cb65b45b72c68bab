//! Drafts in users' files, which must be readable and must be the same after they are written back.

use crate::app::recorded::assert_recorded;
use crate::devices::ssi::jobs::Ssi;

#[test]
fn a_draft_matches_the_recorded_text() {
    assert_recorded::<Ssi>("ssi", "[\"(path:[Entry(\\\"clocks\\\")],from:Some(\\\"24\\\"))\"]");
}
