//! Tests that saved drafts keep their format.

use crate::app::recorded::assert_recorded;
use crate::devices::interbus::jobs::Interbus;

#[test]
fn draft_matches_recorded_text() {
    let kept = "[Gear(3600,1),Direction(4),Preset(17),ZeroShift(3),Shift(2),Cam(1,7,10,20),NoCam(2,0),On(1,7,true),\
                Name(1,7,\"Door\"),ProgramName(1,\"Fill\")]";
    assert_recorded::<Interbus>("interbus", kept);
}
