//! Tests of the last step in which a write is rejected or interrupted.

use super::*;

/// The restart marker is never saved, so a failed write of it does not change what is saved (issue 21.6 e).
#[test]
fn failed_marker_write_keeps_saved_values() {
    for begun in [false, true] {
        let (mut axis, seen) = at_power_cycle_step();
        let ask = axis.request(AxisButton::Do, &seen).unwrap();
        axis.begin_request(ask, &seen);
        axis.handle_write_failure(begun);
        assert_eq!((axis.is_saved(), axis.is_partly_written()), (true, false), "{begun}");
        assert_eq!(axis.request(AxisButton::Do, &seen), Ok(DriveRequest::Try(vec![(182, 1001)])), "{begun}: once more");
    }
}

/// If the connection is lost during the write of the restart marker, a reading shows whether the marker was written
/// (issue 21.6 e).
#[test]
fn reads_back_interrupted_marker_write() {
    let cut_off = |value: i64| {
        let (mut axis, mut seen) = at_power_cycle_step();
        let ask = axis.request(AxisButton::Do, &seen).unwrap();
        axis.begin_request(ask, &seen);
        axis.handle_connection_loss();
        seen.values.insert(182, value);
        axis.on_survey(&seen, false);
        axis.update(&seen);
        (axis, seen)
    };
    let off_and_on = |axis: &mut Axis, seen: &mut DriveFacts| {
        axis.handle_connection_loss();
        seen.values.insert(182, 1000);
        axis.on_survey(seen, false);
        axis.update(seen);
        let Some(Power::Back { restart, .. }) = axis.power() else { panic!("{:?}", axis.power()) };
        (restart, axis.has_survived(), axis.is_saved())
    };
    // The marker has arrived. The drive was not off, whatever the user states, and a restart can be detected.
    let (mut axis, mut seen) = cut_off(1001);
    assert_eq!(axis.request(AxisButton::Restarted, &seen).unwrap_err().id(), "hd_axis.not_restarted");
    assert_eq!(axis.request(AxisButton::Do, &seen).unwrap_err().id(), "hd_axis.already");
    assert_eq!(off_and_on(&mut axis, &mut seen), (RestartEvidence::Read, true, true));
    // The marker has not arrived. The check can be prepared again without leaving the step.
    let (mut axis, mut seen) = cut_off(1000);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_proof");
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::Try(vec![(182, 1001)]));
    assert_eq!(axis.request(AxisButton::Restarted, &seen).unwrap_err().id(), "hd_axis.not_restarted");
    assert_eq!(off_and_on(&mut axis, &mut seen), (RestartEvidence::Read, true, true));
}
