//! Tests that drafts in users' files keep their format.

use crate::app::recorded::assert_recorded;
use crate::devices::hiperface::jobs::Hiperface;

#[test]
fn draft_matches_recorded_text() {
    assert_recorded::<Hiperface>("hiperface", "[(0,2,60),(3,15,255)]");
}
