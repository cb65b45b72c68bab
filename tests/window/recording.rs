//! Tests of the recording of a polled encoder, and of the actions for it.

use crate::tabs::Tabs as _;
use encoder_studio::app::{DeviceCommand, DeviceModel as _};
use std::fs;
use std::time::Duration;

use encoder_studio::analysis::history::Flags;
use encoder_studio::app::recorder::{self, Recorder, Series};
use encoder_studio::app::{Action, FileQuestion, Picture, RecorderOwner as Of, Severity, Studio};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::losing::lost;
use crate::support::Desk;
use encoder_studio::devices::hiperface::procedures::WatchedQuantity;

const FAST: DeviceCommand = DeviceCommand::Poll(Some(Duration::from_millis(2)));

fn recorded(studio: &Studio) -> u64 {
    studio.hiperface().unwrap().record.position_count()
}

fn own(desk: &Desk) -> Of {
    Of::Device(desk.encoder().session.id)
}

fn recorder(desk: &Desk) -> &Recorder {
    desk.encoder().recording().recorder()
}

fn line<'a>(recorder: &'a Recorder, name: &str) -> &'a Series {
    recorder.series().iter().find(|line| line.heading == name).unwrap()
}

/// Returns the minimum and maximum of a line over the whole recording, in its unit.
fn extent(recorder: &Recorder, name: &str) -> (f64, f64) {
    let line = line(recorder, name);
    let history = recorder.history(line).unwrap();
    let statistics = history.statistics(line.column(), history.indices()).unwrap();
    (statistics.min.to_f64() * line.factor(), statistics.max.to_f64() * line.factor())
}

/// At the end of the range of 4096 turns, position and speed would jump without unwrapping.
#[test]
fn range_wrap_does_not_look_like_spike() {
    let mut desk = Desk::new_form("rpm=600&position=16600000");
    desk.command(FAST);
    desk.until("the range has ended", |studio| {
        recorded(studio) > 200 && studio.hiperface().unwrap().record.last().is_some_and(|reading| reading.raw < 1 << 23)
    });
    desk.act(Action::Stop);
    let (least, most) = extent(recorder(&desk), "position");
    assert!(least < 4096.0 && most > 4096.0 && most < 4300.0, "{least} {most}");
    let (slowest, fastest) = extent(recorder(&desk), "speed");
    assert!(slowest > 550.0 && fastest < 650.0, "{slowest} {fastest}");
    assert_eq!(desk.bad_positions(), 0);
}

#[test]
fn records_linear_encoder_in_millimetres() {
    let mut desk = Desk::new_form("type=0x90");
    desk.command(FAST);
    desk.until("samples come", |studio| recorded(studio) > 5);
    let line = line(recorder(&desk), "position");
    assert_eq!(line.scale().unwrap().unit.id(), "unit.millimetres");
    let reading = desk.encoder().record.last().unwrap();
    let (_, most) = extent(recorder(&desk), "position");
    assert!((most - reading.position.unwrap().millimetres().unwrap()).abs() < 1e-6);
}

#[test]
fn pulled_cable_leaves_gap() {
    let mut desk = Desk::connected_at_port("rpm=60");
    desk.command(FAST);
    desk.until("samples come", |studio| recorded(studio) > 20);
    let before = recorded(&desk.studio);
    desk.wire().unplug();
    desk.until("it is lost", lost);
    assert!(recorded(&desk.studio) >= before);
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    desk.command(FAST);
    let before = recorded(&desk.studio);
    desk.until("samples go on", |studio| recorded(studio) > before + 20);
    let recorder = recorder(&desk);
    let history = recorder.history(line(recorder, "position")).unwrap();
    let flags = |index| history.sample(0, index).unwrap().flags;
    let breaks = history.indices().filter(|index| flags(*index).contains(Flags::BREAK)).count();
    assert!(breaks >= 1, "the line is broken where the cable was out");
    let times: Vec<_> = history.indices().map(|index| history.time(index).unwrap()).collect();
    assert!(times.is_sorted());
}

#[test]
fn another_encoder_starts_new_recording() {
    let mut desk = Desk::connected_at_port("rpm=60");
    desk.command(FAST);
    desk.until("samples come", |studio| recorded(studio) > 20);
    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().exchange("serial=OTHER0001&model=sks36");
    desk.wire().plug();
    desk.studio.settings.live_stopped = true;
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    assert!(recorded(&desk.studio) <= 1, "the position that is read with the rest");
}

#[test]
fn saves_recording_as_table() {
    let mut desk = Desk::new_form("rpm=60");
    let desk_of = own(&desk);
    desk.act(Action::Recorder(desk_of, recorder::RecorderAction::Clear));
    let path = desk.outside.path("samples.csv");
    let question = |visible| FileQuestion::Table { owner: desk_of, visible, suggested: "x.csv".into() };
    desk.act(Action::Chosen(question(false), path.clone()));
    assert_eq!(desk.notice_ids(Severity::Warning), ["recorder.nothing_to_write"]);
    desk.command(FAST);
    desk.until("samples come", |studio| recorded(studio) > 50);
    desk.act(Action::Stop);
    desk.settle();
    desk.act(Action::AskTable { owner: desk_of, visible: false });
    let asked = desk.studio.take_file_question().unwrap();
    let FileQuestion::Table { visible: false, suggested, .. } = &asked else { panic!("{asked:?}") };
    let name = suggested.to_str().unwrap();
    assert!(name.starts_with("SKM36-GB0450179-2") && name.ends_with(".csv"), "{name}");
    desk.act(Action::Chosen(asked, path.clone()));
    desk.until("it is written", |studio| {
        studio.services.log.notices().any(|own| own.texts[0].id() == "recorder.written")
    });
    let text = fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().next(), Some("time [s],position [turns],speed [rpm],remark"));
    assert_eq!(text.lines().count() as u64, 1 + recorded(&desk.studio));
    // An existing file at a typed path is replaced only after a question.
    desk.act(Action::Typed(question(false), path.clone()));
    desk.until("it asks", |studio| studio.question.is_some());
    desk.act(Action::Escape);
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    let nowhere = desk.outside.path("no/samples.csv");
    desk.act(Action::Chosen(question(false), nowhere));
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.severity == Severity::Error));
    assert!(recorder(&desk).export().is_none());
}

#[test]
fn saves_snapshot() {
    let mut desk = Desk::new_form("");
    let picture = Picture::new(1, 1, vec![1, 2, 3]).unwrap();
    desk.act(Action::AskPicture(picture));
    let asked = desk.studio.take_file_question().unwrap();
    let path = desk.outside.path("plot.png");
    desk.act(Action::Chosen(asked, path.clone()));
    desk.until("it is saved", |_| path.exists());
    assert_eq!(fs::read(&path).unwrap()[..4], [0x89, b'P', b'N', b'G']);
}

#[test]
fn records_watched_values_with_position() {
    let mut desk = Desk::new_form("rpm=60&temperature=37");
    for what in [WatchedQuantity::Analogue(0x48), WatchedQuantity::Analogue(0x07), WatchedQuantity::Counter] {
        desk.ask(Hiperface::Watch(what, true));
    }
    desk.command(FAST);
    desk.until("the counter has come", |studio| {
        let recorder = &studio.hiperface().unwrap().recording().recorder();
        recorder.history(line(recorder, "counter")).is_some_and(|history| history.indices().end > 0)
    });
    let recording = recorder(&desk);
    assert_eq!(extent(recording, "temperature"), (37.0, 37.0));
    let absent = line(recording, "analogue 07h");
    assert_eq!(absent.remark.as_ref().unwrap().id(), "recorder.absent", "said where it would stand");
    assert!(line(recording, "temperature").remark.is_none());
    desk.ask(Hiperface::Watch(WatchedQuantity::Counter, false));
    assert!(recorder(&desk).series().iter().all(|line| line.heading != "counter"));
    // The watched values remain after the cable was pulled.
    assert_eq!(
        desk.encoder().record.watched_values(),
        [WatchedQuantity::Analogue(0x48), WatchedQuantity::Analogue(0x07)]
    );
}

#[test]
fn single_reading_does_not_disturb_polling() {
    let mut desk = Desk::new_form("rpm=600");
    desk.command(FAST);
    for round in 1..=5 {
        desk.until("samples come", |studio| recorded(studio) > round * 40);
        desk.command(DeviceCommand::ReadPosition);
        desk.until_ready();
    }
    desk.act(Action::Stop);
    let recording = recorder(&desk);
    let history = recording.history(line(recording, "position")).unwrap();
    let times: Vec<_> = history.indices().map(|index| history.time(index).unwrap()).collect();
    assert!(times.is_sorted_by(|one, other| one < other), "none stands at another's time");
    let (slowest, fastest) = extent(recording, "speed");
    assert!(slowest > 590.0 && fastest < 610.0, "{slowest} {fastest}");
}

/// Closing a session discards its recording, so the window asks first if it is at least two minutes long (issue 21.12).
#[test]
fn asks_before_closing_long_recording() {
    let mut desk = Desk::new_form("");
    let id = desk.encoder().session.id;
    desk.command(FAST);
    desk.until("samples come", |studio| recorded(studio) > 5);
    desk.act(Action::Stop);
    desk.until_ready();
    desk.settle();
    let clock = desk.wire().clock();
    clock.sleep_until(clock.now() + Duration::from_secs(121));
    let before = recorded(&desk.studio);
    desk.command(FAST);
    desk.until("two minutes have passed", |studio| recorded(studio) > before + 5);
    desk.act(Action::Stop);
    desk.until_ready();
    desk.act(Action::CloseSession(id));
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.session_recording");
    desk.act(Action::Escape);
    assert!(desk.studio.question.is_none() && desk.studio.device(id).is_some());
    desk.act(Action::CloseSession(id));
    desk.act(Action::Confirm);
    assert!(desk.studio.device(id).is_none());
}
