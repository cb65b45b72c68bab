//! Tests that recordings of HIPERDRIVE drives survive any change on the page.

use crate::hiperdrive::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::{DeviceCommand, DeviceModel as _};
use std::fs;

use encoder_studio::app::recorder::Recorder;
use encoder_studio::app::{Action, FileQuestion, RecorderOwner as Whose, Severity};
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, Length, Value};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, PositionUnit};
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, act, number, read, unit};
use crate::support::Desk;

fn recorder(desk: &Desk) -> &Recorder {
    unit(desk).recording().recorder()
}

/// Returns the number of samples in the line with a matching heading, or 0 if there is none.
fn samples(recorder: &Recorder, is_it: impl Fn(&str) -> bool) -> u64 {
    let line = recorder.series().iter().find(|line| is_it(&line.heading));
    let all = line.and_then(|line| recorder.history(line)).map(|history| history.indices());
    all.map_or(0, |all| all.end - all.start)
}

fn positions(desk: &Desk) -> u64 {
    samples(recorder(desk), |heading| heading == "position")
}

#[track_caller]
fn wait_for_new_samples(desk: &mut Desk, more: u64) {
    let before = positions(desk);
    desk.until("some is recorded", |studio| {
        let own = studio.hiperdrive().unwrap();
        samples(own.recording().recorder(), |heading| heading == "position") >= before + more
    });
}

/// Each drive of a hub keeps its own recording while another drive is selected (issue 21.12).
#[test]
fn each_hub_drive_has_recording() {
    let mut desk = read("sim:?hub=4&drives=1,0,1");
    let three = DriveNumber::new(3).unwrap();
    wait_for_new_samples(&mut desk, 3);
    let before = positions(&desk);
    act(&mut desk, Hiperdrive::SelectDrive(three));
    assert_eq!(positions(&desk), 0, "that was another drive");
    wait_for_new_samples(&mut desk, 3);
    let third = positions(&desk);
    act(&mut desk, Hiperdrive::SelectDrive(ONE));
    assert!(unit(&desk).record.last().is_none(), "where it is now is not known yet");
    assert_eq!(positions(&desk), before);
    wait_for_new_samples(&mut desk, 2);
    act(&mut desk, Hiperdrive::SelectDrive(three));
    assert_eq!(positions(&desk), third);
}

/// A recording survives changes of the unit, the pitch and the scale (issue 21.12).
#[test]
fn recording_survives_unit_and_scale_changes() {
    let mut desk = read("sim:");
    wait_for_new_samples(&mut desk, 3);
    let before = positions(&desk);
    act(&mut desk, Hiperdrive::SetPitch(ONE, Some(Length { nanometres: 4_000_000 })));
    act(&mut desk, Hiperdrive::SetMeasure(PositionUnit::Millimetres));
    wait_for_new_samples(&mut desk, 1);
    act(&mut desk, Hiperdrive::SetPitch(ONE, None));
    wait_for_new_samples(&mut desk, 1);
    assert!(positions(&desk) >= before + 2);
    assert!(recorder(&desk).series().iter().all(|line| !line.ended));
    let before = positions(&desk);
    let target = unit(&desk).target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), number(154), &Value::Number(400)).unwrap());
    command(&mut desk, DeviceCommand::Read);
    desk.until("it is read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.parameter_value(ONE, 154) == Some(400)
    });
    desk.until("the new scale is recorded", |studio| {
        studio.hiperdrive().unwrap().recording().recorder().series().iter().any(|line| line.ended)
    });
    assert!(samples(recorder(&desk), |heading| heading.starts_with("position until ")) >= before);
}

/// One drive's exported table is complete even if another drive is selected during the export (issue 21.12).
#[test]
fn table_export_survives_drive_selection() {
    let mut desk = read("sim:?hub=4&drives=1,0,1");
    wait_for_new_samples(&mut desk, 5);
    let path = desk.outside.path("table.csv");
    let whose = Whose::Device(unit(&desk).session.id);
    let question = FileQuestion::Table { owner: whose, visible: false, suggested: path.clone() };
    desk.act(Action::Chosen(question, path.clone()));
    act(&mut desk, Hiperdrive::SelectDrive(DriveNumber::new(3).unwrap()));
    desk.until("it is written", |studio| {
        studio
            .services
            .log
            .notices()
            .any(|notice| notice.severity == Severity::Good && notice.texts[0].id() == "recorder.written")
    });
    let rows = fs::read_to_string(&path).unwrap().lines().count();
    assert!(rows > 5, "{rows}");
    act(&mut desk, Hiperdrive::SelectDrive(ONE));
    assert_eq!(recorder(&desk).export().map(|own| own.progress()), None, "it is over");
}
