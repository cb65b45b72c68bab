//! Tests of the draft format in users' files. Drafts must remain readable, and writing them back must not change them.

use crate::app::recorded::assert_recorded;
use crate::devices::biss::jobs::Biss;

#[test]
fn draft_matches_recorded_text() {
    assert_recorded::<Biss>("biss", "[(2304,7),(2367,255)]");
}
