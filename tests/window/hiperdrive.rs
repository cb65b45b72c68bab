//! Tests of the HIPERDRIVE tab through actions: reading, edited parameters, a reviewed write, and the motion locks
//! after it.

use crate::tabs::Tabs as _;
use encoder_studio::app::review::Stage;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, DeviceCommand, ReviewAction, Severity, Studio, connect};
use encoder_studio::buses::ethernet_ip::protocol::{Identity, IdentityItem, Revision, SocketAddress};
use encoder_studio::devices::hiperdrive::procedures::DiscoveredDevice;
use encoder_studio::devices::hiperdrive::procedures::dead_man::{MotionLock, TargetState};
use encoder_studio::devices::hiperdrive::protocol::{
    Direction, DriveNumber, Length, ParameterNumber, PositionScale, VENDOR,
};
use encoder_studio::devices::hiperdrive::state::{
    Edit, EditFinding, HiperdriveAction as Hiperdrive, HiperdriveDevice, LimitsPolicy, MotorCommand, PositionUnit,
};

use crate::support::Desk;

pub(crate) const ONE: DriveNumber = DriveNumber::FIRST;

pub(crate) fn number(number: u16) -> ParameterNumber {
    ParameterNumber::new(number).unwrap()
}

pub(crate) fn read(link: &str) -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open(link);
    until_read(&mut desk);
    desk
}

#[track_caller]
pub(crate) fn until_read(desk: &mut Desk) {
    desk.until("everything is read", |studio| {
        studio.hiperdrive().is_some_and(|own| own.status.is_some() && own.session.is_ready() && own.key_is_listed())
    });
    desk.settle();
}

trait DeviceHistory {
    fn key_is_listed(&self) -> bool;
}

impl DeviceHistory for HiperdriveDevice {
    fn key_is_listed(&self) -> bool {
        self.session.backups.is_some()
    }
}

pub(crate) fn unit(desk: &Desk) -> &HiperdriveDevice {
    desk.studio.hiperdrive().unwrap()
}

pub(crate) fn command(desk: &mut Desk, command: DeviceCommand) {
    let id = unit(desk).session.id;
    desk.act(Action::Command(id, command));
}

pub(crate) fn act(desk: &mut Desk, action: Hiperdrive) {
    let id = unit(desk).session.id;
    desk.act(Action::device(id, action));
}

pub(crate) fn drive(desk: &mut Desk, motor: MotorCommand) {
    act(desk, Hiperdrive::Drive(motor));
}

pub(crate) fn edit(desk: &mut Desk, edit: Edit) {
    act(desk, Hiperdrive::Edit(Box::new(edit)));
}

/// Returns the number of requests in the trace that set a value.
fn sets(desk: &Desk) -> usize {
    let lines = unit(desk).session.trace.lines();
    lines.iter().filter(|line| line.meaning.iter().any(|text| text.id() == "hd_asked.set")).count()
}

/// Returns a device that replies to a discovery request on the network.
fn found(address: [u8; 4], port: u16, vendor: u16, name: &str) -> DiscoveredDevice {
    let identity = Identity {
        vendor,
        device_type: 0x0C,
        product_code: 1,
        revision: Revision { major: 1, minor: 2 },
        status: 0,
        serial_number: 17,
        product_name: name.to_owned(),
    };
    let socket = SocketAddress::new(address.into(), port);
    DiscoveredDevice {
        address: address.into(),
        port,
        identity: IdentityItem { version: 1, socket, identity, state: 3 },
    }
}

/// Reviews the edits and writes them.
#[track_caller]
pub(crate) fn write(desk: &mut Desk) {
    let action = desk.studio.selected_device().unwrap().command(DeviceCommand::Review);
    desk.act(action);
    write_as_shown(desk);
}

#[track_caller]
fn write_as_shown(desk: &mut Desk) {
    let stage = |studio: &Studio| studio.selected_device().unwrap().review_sheet().map(|sheet| sheet.stage);
    desk.until("there is a plan", |studio| {
        matches!(stage(studio), Some(Stage::Ready(_))) && studio.selected_device().unwrap().is_ready()
    });
    let Some(Stage::Ready(plan)) = stage(&desk.studio) else { panic!() };
    let id = unit(desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Write(plan)));
    desk.until("it is written", |studio| {
        matches!(stage(studio), Some(Stage::Done { .. })) && studio.selected_device().unwrap().is_ready()
    });
    desk.act(Action::Review(id, ReviewAction::Close));
}

#[test]
fn connecting_reads_everything_and_writes_nothing() {
    let desk = read("sim:?hub=4&drives=1,0,1");
    let unit = unit(&desk);
    assert_eq!(unit.session.phase, Phase::Connected);
    assert_eq!(unit.drives().iter().map(|own| own.get()).collect::<Vec<_>>(), [1, 3]);
    assert!(!unit.session.trace.lines().is_empty());
    assert_eq!(sets(&desk), 0);
    assert!(!unit.moves.is_open() && !desk.studio.is_moving() && desk.studio.has_drives());
    // There are rows for drive 1, and none for the slot without a drive.
    assert!(unit.rows(Some(ONE)).len() > 40 && unit.rows(DriveNumber::new(2)).is_empty());
    let requested = unit.rows(Some(ONE)).into_iter().find(|row| row.number == number(152)).unwrap();
    assert_eq!((requested.factory.as_str(), requested.is_editable), ("0", true), "of a hub");
    let speed = unit.rows(Some(ONE)).into_iter().find(|row| row.number == number(166)).unwrap();
    assert_eq!((speed.shown.as_str(), speed.factory.as_str()), ("350", "350"));
    assert!(desk.notice_ids(Severity::Warning).is_empty());
}

#[test]
fn polls_and_records_selected_drive() {
    let mut desk = read("sim:?hub=4&drives=1,0,1");
    desk.until("it is recorded", |studio| studio.hiperdrive().unwrap().record.last().is_some());
    let three = DriveNumber::new(3).unwrap();
    act(&mut desk, Hiperdrive::SelectDrive(DriveNumber::new(2).unwrap()));
    assert_eq!(unit(&desk).drive(), ONE, "there is none");
    act(&mut desk, Hiperdrive::SelectDrive(three));
    assert!(unit(&desk).record.last().is_none(), "that was another drive");
    desk.until("the other one is recorded", |studio| {
        studio.hiperdrive().unwrap().record.last().is_some_and(|own| own.drive == three)
    });
}

#[test]
fn writes_edit_after_review() {
    let mut desk = read("sim:");
    edit(&mut desk, Edit::Set(number(166), 351));
    assert_eq!(unit(&desk).refusal.as_ref().unwrap().id(), "hd_said.out_of_range");
    edit(&mut desk, Edit::Set(number(166), 200));
    edit(&mut desk, Edit::Set(number(24), 7));
    assert!(unit(&desk).refusal.is_none() && unit(&desk).is_dirty());
    write(&mut desk);
    assert!(!unit(&desk).is_dirty());
    assert_eq!(unit(&desk).parameter_value(ONE, 166), Some(200));
    assert_eq!(unit(&desk).staged.previous_value(number(166)), Some(350));
    let target = unit(&desk).target.clone().unwrap();
    assert_eq!(target.with_station(|station| station.save_count()), 1, "saved once");
}

#[test]
fn rejects_limits_excluding_position() {
    let mut desk = read("sim:");
    edit(&mut desk, Edit::Limits { drive: ONE, lower: 65_536, upper: 131_072 });
    assert!(
        matches!(unit(&desk).findings()[..], [EditFinding::Outside { position: 0, .. }]),
        "{:?}",
        unit(&desk).findings()
    );
    let action = desk.studio.selected_device().unwrap().command(DeviceCommand::Review);
    desk.act(action);
    desk.until("it is refused", |studio| {
        let sheet = studio.selected_device().unwrap().review_sheet();
        sheet.is_some_and(|sheet| matches!(sheet.stage, Stage::Failed { begun: false, .. }))
    });
    let Some(Stage::Failed { texts, .. }) =
        desk.studio.selected_device().unwrap().review_sheet().map(|sheet| sheet.stage)
    else {
        panic!()
    };
    assert_eq!(texts[0].id(), "hd_plan.outside");
    assert_eq!(sets(&desk), 0);
}

#[test]
fn remembers_pitch_and_unit() {
    let mut desk = read("sim:");
    assert_eq!(unit(&desk).ruler(ONE).available_units().count(), 3, "no millimetres without a spindle");
    let pitch = Length { nanometres: 4_000_000 };
    act(&mut desk, Hiperdrive::SetPitch(ONE, Some(pitch)));
    act(&mut desk, Hiperdrive::SetMeasure(PositionUnit::Millimetres));
    // 2.5 turns of 65536 steps with a pitch of 4 mm are 10 mm.
    let place = unit(&desk).position_text(ONE, 163_840).to_string_in(encoder_studio::app::Language::English);
    assert_eq!(place, "10.00000 mm");
    let path = desk.outside.store().settings_path();
    desk.until("it is kept", |_| {
        std::fs::read_to_string(&path).is_ok_and(|text| text.contains("4000000") && text.contains("Millimetres"))
    });
    let mut desk = desk.crash();
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open("sim:");
    until_read(&mut desk);
    assert_eq!((unit(&desk).spindle_pitch(ONE), unit(&desk).measure), (Some(pitch), PositionUnit::Millimetres));
    assert!(desk.notice_ids(Severity::Warning).is_empty(), "that is no edit");
}

#[test]
fn new_scaling_locks_motion() {
    let mut desk = read("sim:");
    let hundredths = PositionScale::new(400, 256).unwrap();
    edit(&mut desk, Edit::Scale { drive: ONE, scale: hundredths, limits: LimitsPolicy::InPlace });
    write(&mut desk);
    // 511 turns of 400 steps each.
    assert_eq!(unit(&desk).limits_to_confirm(ONE), Some((-204_400, 204_400)));
    command(&mut desk, DeviceCommand::Reconnect);
    desk.until("it is read again", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.session.phase == Phase::Connected && own.moves.motion().is_some()
    });
    until_read(&mut desk);
    assert!(unit(&desk).moves.motion_locks(ONE).contains(&MotionLock::LimitsUnconfirmed), "also over a connection");
    desk.settle();
    let mut desk = desk.crash();
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open("sim:");
    until_read(&mut desk);
    assert!(unit(&desk).moves.motion_locks(ONE).contains(&MotionLock::LimitsUnconfirmed), "and over a crash");
    drive(&mut desk, MotorCommand::ConfirmLimits(ONE));
    assert!(unit(&desk).limits_to_confirm(ONE).is_none() && unit(&desk).moves.motion_locks(ONE).is_empty());
}

#[test]
fn requests_no_motion_without_control() {
    let mut desk = read("sim:");
    for motor in
        [MotorCommand::Lead(TargetState::Enabled), MotorCommand::Move { target: 64 }, MotorCommand::Step { by: 64 }]
    {
        drive(&mut desk, motor);
        assert_eq!(desk.notice_ids(Severity::Warning).last(), Some(&"hd_refused.not_taken"));
    }
    drive(&mut desk, MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false });
    assert!(!unit(&desk).moves.is_held() && unit(&desk).reachable_states(ONE).is_empty());
}

#[test]
fn discovered_device_fills_form() {
    let mut outside = crate::support::Outside::new("");
    outside.found =
        vec![found([10, 0, 0, 9], 2222, 1, "a switch"), found([10, 0, 0, 7], 44818, VENDOR, "HIPERDRIVE HUB-4")];
    let mut desk = Desk { studio: outside.studio(), outside };
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.connect(connect::ConnectAction::Open);
    desk.connect(crate::tabs::discover());
    assert!(crate::tabs::discovery(desk.studio.connect.as_ref().unwrap()).unwrap().is_running());
    desk.until("they have answered", |studio| {
        crate::tabs::discovery(studio.connect.as_ref().unwrap()).is_some_and(|own| !own.is_running())
    });
    let discovery = crate::tabs::discovery(desk.studio.connect.as_ref().unwrap()).cloned().unwrap();
    let names: Vec<&str> = discovery.devices().iter().map(|own| own.name.as_str()).collect();
    assert_eq!(names, ["HIPERDRIVE HUB-4", "a switch"], "ours come first");
    desk.connect(crate::tabs::choose_answer(0));
    assert_eq!(desk.studio.connect.as_ref().unwrap().typed_link(), "enip:10.0.0.7:44818");
    desk.connect(crate::tabs::choose_answer(1));
    assert_eq!(desk.studio.connect.as_ref().unwrap().typed_link(), "enip:10.0.0.9:2222");
    desk.connect(crate::tabs::choose_answer(2));
    assert_eq!(desk.studio.connect.as_ref().unwrap().typed_link(), "enip:10.0.0.9:2222", "there is none");
}

/// An HDA30 has 512 turns in each direction: 33 554 432 steps, or 204 800 at 400 steps per turn (reference, section 5).
#[test]
fn limits_may_span_full_range() {
    let mut desk = read("sim:");
    let range = |desk: &Desk| {
        let rows = unit(desk).rows(Some(ONE));
        let row = rows.into_iter().find(|row| row.number == number(158)).unwrap();
        row.range.unwrap().terminal_text()
    };
    assert!(range(&desk).contains("-33554432") && range(&desk).contains("33554432"), "{}", range(&desk));
    let scale = PositionScale::new(400, 256).unwrap();
    edit(&mut desk, Edit::Scale { drive: ONE, scale, limits: LimitsPolicy::InPlace });
    assert!(range(&desk).contains("-204800 to 204800"), "{}", range(&desk));
}
