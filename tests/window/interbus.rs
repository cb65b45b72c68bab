//! Tests of the INTERBUS tab through actions: reading, edited parameters and cams, a reviewed write, cam tables, and
//! the confirmation before a running machine is disturbed.

use crate::tabs::Tabs as _;
use std::time::Duration;

use encoder_studio::analysis::history::Value;
use encoder_studio::app::review::Stage;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, DeviceCommand, DeviceModel as _, ReviewAction, Severity, Studio};
use encoder_studio::devices::interbus::profile::Scale;
use encoder_studio::devices::interbus::protocol::{CamNumber, ProgramNumber, ReadOutNumber, StartupMode};
use encoder_studio::devices::interbus::state::{Edit, Encoder, InterbusAction as Interbus};

use crate::support::{Desk, GATE};

/// A link to a virtual encoder that contains cams.
const CAMS: &str = "sim:?steps=3600&revolutions=1&cams=demo";

fn connected(link: &str) -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::INTERBUS));
    desk.open(link);
    desk
}

fn read(link: &str) -> Desk {
    let mut desk = connected(link);
    until_read(&mut desk);
    desk
}

#[track_caller]
fn until_read(desk: &mut Desk) {
    desk.until("everything is read", |studio| {
        studio
            .interbus()
            .is_some_and(|own| own.survey.is_some() && own.known_program_count() == 8 && own.session.is_ready())
    });
    desk.settle();
}

#[track_caller]
fn until_ready(desk: &mut Desk) {
    desk.until("it is ready", |studio| studio.interbus().is_some_and(|own| own.session.is_ready()));
}

fn encoder(desk: &Desk) -> &Encoder {
    desk.studio.interbus().unwrap()
}

fn command(desk: &mut Desk, command: DeviceCommand) {
    let id = encoder(desk).session.id;
    desk.act(Action::Command(id, command));
}

fn act(desk: &mut Desk, action: Interbus) {
    let id = encoder(desk).session.id;
    desk.act(Action::device(id, action));
}

fn edit(desk: &mut Desk, edit: Edit) {
    act(desk, Interbus::Edit(Box::new(edit)));
}

fn wish(desk: &mut Desk, wish: DeviceCommand) {
    let action = desk.studio.selected_device().unwrap().command(wish);
    desk.act(action);
}

fn program(number: u8) -> ProgramNumber {
    ProgramNumber::new(number).unwrap()
}

fn cam(number: u8) -> CamNumber {
    CamNumber::new(number).unwrap()
}

/// Reviews and writes the edits, and returns the write cost in the plan.
#[track_caller]
fn write(desk: &mut Desk) -> String {
    wish(desk, DeviceCommand::Review);
    desk.until("the plan is there", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
    });
    until_ready(desk);
    let sheet = desk.studio.selected_device().unwrap().review_sheet().unwrap();
    let Stage::Ready(plan) = sheet.stage else { panic!("no plan") };
    let id = encoder(desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Write(plan)));
    desk.until("it is written", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Done { .. }))
    });
    until_ready(desk);
    desk.settle();
    sheet.cost.unwrap().to_string_in(encoder_studio::app::Language::English)
}

#[test]
fn reads_virtual_encoder_automatically() {
    let mut desk = read(CAMS);
    // Leaving a program may store it, so each of the eight programs counts (issue 22.3).
    desk.until("stores are counted", |studio| {
        studio.interbus().unwrap().store_count() == Some(encoder_studio::worker::commit::CycleCount::complete(8))
    });
    let own = encoder(&desk);
    let parameters = own.staged.device().unwrap().parameters;
    assert_eq!((parameters.steps, parameters.revolutions), (3600, 1));
    assert!(own.position().is_some() && !own.is_dirty());
    assert!(desk.notice_ids(Severity::Warning).is_empty());
}

#[test]
fn edits_need_minimum_eeprom_writes() {
    let mut desk = read(CAMS);
    edit(&mut desk, Edit::Gear { steps: 7200, revolutions: 2 });
    edit(&mut desk, Edit::Cam { program: program(2), cam: cam(5), start: 7000, stop: 40, on: true });
    edit(&mut desk, Edit::Cam { program: program(2), cam: cam(6), start: 100, stop: 200, on: true });
    assert!(encoder(&desk).has_parameter_edits() && encoder(&desk).has_cam_edits());
    wish(&mut desk, DeviceCommand::Undo);
    wish(&mut desk, DeviceCommand::Redo);
    // The write costs one parameterisation and one program.
    let cost = write(&mut desk);
    assert!(cost.starts_with("EEPROM write cycles required: 2. The logbook has counted 9 of"), "{cost}");
    let own = encoder(&desk);
    assert!(!own.is_dirty());
    let wanted = own.staged.device().unwrap().program(program(2)).unwrap().cams[5].unwrap();
    assert_eq!((wanted.start.get(), wanted.stop.get()), (7000, 40));
    // Programs were read for the window, the plan, the write and after it: 8 + 1 + 1 + 1. Two stores were written.
    desk.until("stores are counted", |studio| {
        studio.interbus().unwrap().store_count() == Some(encoder_studio::worker::commit::CycleCount::complete(13))
    });
    // The entry rejects the cam, and nothing changes.
    edit(&mut desk, Edit::Cam { program: program(1), cam: cam(0), start: 7200, stop: 1, on: true });
    assert!(encoder(&desk).refusal.is_some() && !encoder(&desk).is_dirty());
}

/// The plot shows positions within the range, like the values next to it. A turn of the shaft is the whole range (issue
/// 26).
#[test]
fn plot_matches_row_positions() {
    let mut desk = read("sim:?steps=3600&revolutions=1&rpm=60");
    command(&mut desk, DeviceCommand::Poll(Some(Duration::from_millis(1))));
    let shown = |studio: &Studio| {
        let recorder = studio.interbus().unwrap().recording().recorder();
        let line = &recorder.series()[0];
        let (_, last) = recorder.recorded_span()?;
        let sample = recorder.nearest_sample(line, last)?;
        let Value::Whole(continuous) = sample.value else { return None };
        Some((continuous, line.value(&sample) * 3600.0))
    };
    desk.until("the range has been passed", |studio| shown(studio).is_some_and(|(steps, _)| steps.abs() > 3600));
    command(&mut desk, DeviceCommand::Poll(None));
    until_ready(&mut desk);
    let (continuous, shown) = shown(&desk.studio).unwrap();
    let row = encoder(&desk).position().unwrap();
    assert_eq!(shown.round() as i64, i64::from(row));
    assert_eq!(continuous.rem_euclid(3600), i64::from(row));
}

#[test]
fn selects_encoder_mode() {
    let mut desk = read(CAMS);
    act(&mut desk, Interbus::Select(StartupMode::Cams(program(1))));
    desk.until("outputs come", |studio| {
        studio.interbus().unwrap().record.last().is_some_and(|reading| reading.cams().is_some())
    });
    until_ready(&mut desk);
    command(&mut desk, DeviceCommand::Poll(Some(Duration::from_millis(1))));
    desk.until("outputs were compared", |studio| studio.interbus().unwrap().preview.same > 20);
    assert_eq!(encoder(&desk).preview.other, 0);
    command(&mut desk, DeviceCommand::Poll(None));
    act(&mut desk, Interbus::Select(StartupMode::Velocity));
    desk.until("a speed comes", |studio| {
        studio.interbus().unwrap().record.last().is_some_and(|reading| reading.rpm().is_some())
    });
    until_ready(&mut desk);
    act(&mut desk, Interbus::Select(StartupMode::K3));
    desk.until("a position comes", |studio| studio.interbus().unwrap().position().is_some());
    until_ready(&mut desk);
    act(&mut desk, Interbus::ReadOut(ReadOutNumber::chip_register(5).unwrap()));
    desk.until("it is read out", |studio| {
        studio.interbus().unwrap().read_out(ReadOutNumber::chip_register(5).unwrap()).is_some()
    });
    assert_eq!(encoder(&desk).mode(), Some(StartupMode::K3));
    assert!(!encoder(&desk).handshake.is_empty());
}

#[test]
fn asks_for_standstill_before_disturbing_machine() {
    let mut desk = connected(&format!("modbus:{GATE}"));
    desk.until("a word has come", |studio| {
        studio.interbus().is_some_and(|own| own.record.last().is_some() && own.session.is_ready())
    });
    desk.settle();
    assert!(encoder(&desk).survey.is_none() && encoder(&desk).needs_standstill_confirmation());
    let sent = |desk: &Desk| desk.outside.wire(GATE).outs();
    assert_eq!(sent(&desk), 0, "no OUT word");
    wish(&mut desk, DeviceCommand::Read);
    desk.settle();
    assert_eq!((desk.notice_count("ib_stop.first"), sent(&desk)), (1, 0));
    // Saving a profile of the encoder selects cam programs, so the machine must be stopped for it as well
    // (issue 22.31).
    command(&mut desk, DeviceCommand::AskSave);
    act(&mut desk, Interbus::Save("k3.ron".into()));
    desk.settle();
    assert!(desk.studio.take_file_question().is_none());
    assert_eq!((desk.notice_count("ib_stop.first"), sent(&desk)), (3, 0));
    act(&mut desk, Interbus::ConfirmStandstill(true));
    wish(&mut desk, DeviceCommand::Read);
    desk.until("it is read", |studio| studio.interbus().unwrap().survey.is_some());
    until_ready(&mut desk);
    assert_eq!(encoder(&desk).known_program_count(), 0, "another program switches outputs: only when asked");
    act(&mut desk, Interbus::ReadPrograms(vec![program(3)]));
    desk.until("the program is read", |studio| studio.interbus().unwrap().known_program_count() == 1);
    until_ready(&mut desk);
    // After a lost connection, it is unknown whether the machine is stopped.
    desk.outside.wire(GATE).unplug();
    desk.until("it is lost", |studio| matches!(studio.interbus().unwrap().session.phase, Phase::Lost(_)));
    desk.outside.wire(GATE).plug();
    command(&mut desk, DeviceCommand::Reconnect);
    until_ready(&mut desk);
    assert!(!encoder(&desk).is_stopped());
}

#[test]
fn previews_rounding_of_pasted_edges() {
    let mut desk = read(CAMS);
    // The machine has 360 degrees over 3600 steps, so a tenth of a degree is a step.
    act(&mut desk, Interbus::SetScale(Scale::in_degrees(3600.0, 0).unwrap()));
    let table = "program;cam;name;start;stop\n3;0;glue;10,05;20\n3;1;glue;30;40\n3;2;knife;350;400\n9;0;x;1;2\n";
    act(&mut desk, Interbus::PasteTable(program(1), table.to_owned()));
    let import = encoder(&desk).import.as_ref().unwrap();
    assert_eq!((import.table.rows.len(), import.table.problems.len()), (3, 1), "{:?}", import.table.problems);
    assert!(import.table.rounded_rows().next().is_some());
    act(&mut desk, Interbus::TakeTable(true));
    assert!(!encoder(&desk).is_dirty(), "the line that is left out would switch its cam off");
    act(&mut desk, Interbus::PasteTable(program(1), table.replace("9;0;x;1;2\n", "")));
    act(&mut desk, Interbus::TakeTable(true));
    let own = encoder(&desk);
    assert!(own.import.is_none() && own.has_cam_edits());
    let wanted = own.staged.edited_values().unwrap();
    let edges = |number| wanted.cam(program(3), cam(number)).map(|own| (own.start.get(), own.stop.get()));
    // 350 to 400 degrees cross the end of the range, so 400 degrees become 40.
    assert_eq!((edges(1), edges(2)), (Some((300, 400)), Some((3500, 400))));
    assert_eq!(wanted.name(program(3), cam(2)), Some("knife"));
    // The table is exported to a file and imported again.
    let path = desk.outside.path("cams.csv");
    act(&mut desk, Interbus::SaveTable { path: path.clone(), decimal_comma: true });
    desk.until("it is written", |_| path.exists());
    desk.settle();
    let before = encoder(&desk).staged.edited_values().unwrap().clone();
    act(&mut desk, Interbus::OpenTable(path));
    desk.until("it is read", |studio| studio.interbus().unwrap().import.is_some());
    assert!(encoder(&desk).import.as_ref().unwrap().table.problems.is_empty());
    act(&mut desk, Interbus::TakeTable(true));
    assert_eq!(encoder(&desk).staged.edited_values().unwrap().image, before.image);
}
