//! Tests of the parts around the page: the lower panel and the status line, widgets that must not move while messages
//! come and go, and live values that start automatically.

use std::time::Duration;

use egui::{Key, Modifiers, Rect};
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, DeviceCommand, FileQuestion, Studio, connect};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::screen::Screen;
use crate::support::{Desk, GATE, Outside, PORT, only_master};
use crate::tabs::Tabs as _;

const LARGE: [f32; 2] = [1280.0, 800.0];
const SMALL: [f32; 2] = [1024.0, 640.0];

/// Starts the application with the default settings and, if a link is given, connects to it.
fn usual(query: &str, link: Option<&str>) -> Desk {
    let outside = Outside::new(query);
    let mut desk = Desk { studio: outside.usual_studio(), outside };
    desk.studio.start_with(link.map(|link| link.parse().unwrap()), None);
    only_master(&mut desk.studio);
    desk
}

fn is_live(studio: &Studio) -> bool {
    studio.selected_device().is_some_and(|device| device.is_polling())
}

/// Returns the rectangles of the given buttons on the open page.
fn places(screen: &Screen, ids: &[&'static str]) -> Vec<Rect> {
    ids.iter().map(|id| screen.button(id).rect()).collect()
}

#[test]
fn remembers_lower_panel_state() {
    let mut screen = Screen::new_form(LARGE);
    let trace = screen.say("panel.trace");
    let is_open = |screen: &Screen| screen.harness.query_all_by_label(&trace).next().is_some();
    use egui_kittest::kittest::Queryable;
    assert!(!is_open(&screen));
    let last = screen.encoder().session.trace.lines().back().unwrap().clone();
    assert!(screen.shows(&last.bytes), "the last frame");
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::T);
    screen.steps();
    assert!(is_open(&screen) && screen.studio().settings.lower_open);
    screen.click("status_line.close");
    assert!(!is_open(&screen));
    screen.click("status_line.open");
    assert!(is_open(&screen));
    let path = screen.outside.store().settings_path();
    screen.until("it is kept", |_| std::fs::read_to_string(&path).is_ok_and(|text| text.contains("lower_open: true")));
    let studio = screen.outside.usual_studio();
    assert!(studio.settings.lower_open);
    // Another window opens with the saved layout.
    let Screen { outside, .. } = screen;
    let again = Screen::of(outside, studio, LARGE);
    assert!(is_open(&again));
}

#[test]
fn messages_and_jobs_do_not_shift_widgets() {
    for size in [LARGE, SMALL] {
        let mut screen = Screen::new_form(size);
        screen.click("page.memory");
        screen.ask(Hiperface::Put { field: 0, address: 0, bytes: vec![0xEE] });
        let ids = ["memory.undo", "memory.review", "shell.stop", "live.start", "status_line.open", "page.encoder"];
        let before = places(&screen, &ids);
        // A notice appears.
        screen.command(DeviceCommand::AskSave);
        screen.act(Action::Open("/no/such/profile.ron".into()));
        screen.until("it is told", |studio| studio.services.log.current().is_some());
        assert!(screen.has_button("shell.dismiss"));
        assert_eq!(places(&screen, &ids), before, "a notice");
        // A job starts beside the notice, and later without it.
        let wire = screen.outside.wire(PORT).clone();
        wire.hold_at(0x56, 1);
        screen.command(DeviceCommand::Read);
        wire.wait_until_held();
        screen.steps();
        assert!(screen.encoder().session.is_busy() && screen.has_button("shell.cancel"));
        assert_eq!(places(&screen, &ids), before, "a job beside a notice");
        wire.release();
        screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
        screen.act(Action::Dismiss);
        assert_eq!(places(&screen, &ids), before, "the notice is gone");
        wire.hold_at(0x56, 1);
        screen.command(DeviceCommand::Read);
        wire.wait_until_held();
        screen.steps();
        assert!(screen.has_button("shell.cancel"));
        assert_eq!(places(&screen, &ids), before, "a job");
        wire.release();
        screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
        // The encoder falls silent, and the buttons to reconnect appear.
        screen.outside.wire(PORT).unplug();
        screen.command(DeviceCommand::Read);
        screen.until("it is lost", |studio| {
            matches!(studio.hiperface().unwrap().session.phase, Phase::Lost(_) | Phase::Silent(_))
        });
        assert_eq!(places(&screen, &ids), before, "no connection");
        assert!(screen.has_button("shell.reconnect") || screen.has_button("memory.read"));
    }
}

#[test]
fn live_values_start_automatically() {
    for (link, starts) in [
        (None, true),
        (Some(format!("serial:{PORT}")), true),
        (Some(format!("modbus:{GATE}")), false),
        (Some("bridge:tcp:adapter:5000".to_owned()), false),
    ] {
        let mut desk = usual("", link.as_deref());
        desk.until("it is read", |studio| {
            studio.selected_device().is_some_and(|own| own.is_ready() && !own.state().just_connected)
        });
        desk.settle();
        assert_eq!(is_live(&desk.studio), starts, "{link:?}");
    }
    // Live values of the virtual INTERBUS encoder do not start automatically either.
    let mut desk = usual("", Some("serial:/dev/nothing"));
    desk.act(Action::ShowTab(crate::tabs::INTERBUS));
    desk.act(Action::OpenVirtual);
    desk.until("it is read", |studio| studio.interbus().is_some_and(|own| own.session.is_ready()));
    desk.settle();
    assert!(!is_live(&desk.studio));
}

#[test]
fn stopped_live_values_stay_stopped() {
    let mut desk = usual("", None);
    desk.until("it starts", is_live);
    // STOP applies only for now, while the button in the panel changes the setting.
    desk.act(Action::Stop);
    assert!(!is_live(&desk.studio) && !desk.studio.settings.live_stopped);
    desk.command(DeviceCommand::Reconnect);
    desk.until("it starts again", is_live);
    desk.command(DeviceCommand::Poll(None));
    assert!(desk.studio.settings.live_stopped);
    let path = desk.outside.store().settings_path();
    desk.until("it is kept", |_| std::fs::read_to_string(&path).is_ok_and(|text| text.contains("live_stopped: true")));
    let Desk { studio, outside } = desk;
    drop(studio);
    let mut desk = Desk { studio: outside.usual_studio(), outside };
    desk.studio.start_with(None, None);
    desk.until_read();
    assert!(!is_live(&desk.studio));
    desk.command(DeviceCommand::Poll(Some(Duration::from_millis(20))));
    assert!(!desk.studio.settings.live_stopped);
    desk.command(DeviceCommand::Reconnect);
    desk.until("it starts again", is_live);
}

/// Live values that start automatically only send requests for the position.
#[test]
fn automatic_live_values_only_request_positions() {
    let mut desk = usual("", None);
    desk.until("it starts", is_live);
    let wire = desk.wire();
    let (before, sent) = (wire.count(0x42), wire.sent());
    desk.until("some positions", |_| wire.count(0x42) > before + 5);
    desk.command(DeviceCommand::Poll(None));
    desk.until("it stands", |studio| !is_live(studio));
    assert_eq!(wire.sent() - sent, wire.count(0x42) - before, "nothing but 42h");
}

#[test]
fn pause_names_job_without_layout_shift() {
    let mut screen = Screen::new_form(LARGE);
    screen.click("live.start");
    let ids = ["live.pause", "live.hide_plot"];
    let before = places(&screen, &ids);
    let paused = screen.words(&crate::texts::text("live.paused_by_job").with("job", ""));
    let wire = screen.outside.wire(PORT).clone();
    wire.hold_at(0x56, 1);
    screen.command(DeviceCommand::Read);
    let began = std::time::Instant::now();
    while !screen.shows(paused.trim()) {
        screen.harness.step();
        assert!(began.elapsed() < Duration::from_secs(10), "never paused");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(places(&screen, &ids), before);
    wire.release();
    screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
}

#[test]
fn remembers_narrow_live_panel() {
    let mut screen = Screen::new_form(LARGE);
    let wide = screen.button("live.start").rect().left();
    screen.click("live.hide_plot");
    assert!(!screen.has_button("recorder.large") && screen.studio().settings.values_alone);
    assert!(screen.button("live.start").rect().left() > wide + 60.0, "the page has the room");
    screen.click("live.show_plot");
    assert!(screen.has_button("recorder.large") && !screen.studio().settings.values_alone);
    assert!((screen.button("live.start").rect().left() - wide).abs() < 1.0, "as it was");
}

#[test]
fn last_frames_stay_visible() {
    use egui_kittest::kittest::Queryable;
    let mut screen = Screen::new_form(SMALL);
    screen.act(Action::OpenLowerPanel(true));
    screen.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    screen.until("many frames", |studio| studio.hiperface().unwrap().session.trace.lines().len() > 200);
    screen.command(DeviceCommand::Poll(None));
    screen.steps();
    let last = screen.encoder().session.trace.lines().back().unwrap().clone();
    let time = |screen: &Screen, line| {
        screen.encoder().session.trace.line_time(line).unwrap().strftime("%H:%M:%S%.3f").to_string()
    };
    let time = time(&screen, &last);
    let row = screen.harness.query_all_by_label(&time).last().expect("the last frame is drawn").rect();
    let line = screen.button("status_line.close").rect();
    assert!(row.bottom() <= line.top(), "{row:?} above {line:?}");
    // After the user has scrolled away, the list does not follow new frames until the user requests it.
    screen.harness.event(egui::Event::PointerMoved(row.center()));
    screen.harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 900.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    for _ in 0..60 {
        screen.harness.step();
    }
    assert!(screen.harness.query_all_by_label(&time).next().is_none(), "scrolled away");
    screen.click("trace.follow");
    for _ in 0..10 {
        screen.harness.step();
    }
    assert!(screen.harness.query_all_by_label(&time).next().is_some(), "back at the end");
}

#[test]
fn searches_and_pauses_trace() {
    use egui_kittest::kittest::Queryable;
    let mut screen = Screen::new_form(LARGE);
    screen.act(Action::OpenLowerPanel(true));
    screen.until("frames", |studio| studio.hiperface().unwrap().session.trace.lines().len() > 20);
    screen.steps();
    let read_position = "40 42 02";
    let count = |screen: &Screen, bytes: &str| screen.harness.query_all_by_label(bytes).count();
    let no_match = screen.say("trace.no_match");
    let word = screen.say("trace.search");
    let search = |screen: &mut Screen, text: &str| {
        let entry = screen.harness.get_by_role_and_label(egui::accesskit::Role::TextInput, &word);
        entry.focus();
        screen.steps();
        screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        screen.harness.key_press(Key::Delete);
        screen.harness.event(egui::Event::Text(text.to_owned()));
        screen.steps();
    };
    search(&mut screen, "no such bytes");
    assert!(screen.shows(&no_match));
    screen.command(DeviceCommand::ReadPosition);
    screen.until("a position", |studio| {
        studio.hiperface().unwrap().session.trace.lines().iter().any(|line| line.bytes == read_position)
    });
    search(&mut screen, read_position);
    assert!(count(&screen, read_position) > 0);
    // All replies of the virtual encoder are valid.
    screen.click("trace.faults");
    assert!(screen.shows(&no_match));
    screen.click("trace.faults");
    // While the list is paused, it does not change.
    let before = count(&screen, read_position);
    screen.click("trace.follow");
    let frames = screen.encoder().session.trace.next_number();
    screen.command(DeviceCommand::ReadPosition);
    screen.until("another position", |studio| studio.hiperface().unwrap().session.trace.next_number() >= frames + 2);
    screen.steps();
    assert_eq!(count(&screen, read_position), before);
    assert!(screen.shows("Newer frames") || screen.shows("Neuere"));
    screen.click("trace.follow");
    assert!(count(&screen, read_position) > before);
}

/// A clicked frame is shown with all of its bytes next to the list. The arrow keys select its neighbours.
#[test]
fn shows_bytes_of_selected_frame() {
    use egui_kittest::kittest::Queryable;
    let mut screen = Screen::new_form(LARGE);
    screen.act(Action::OpenLowerPanel(true));
    screen.command(DeviceCommand::ReadPosition);
    screen.until("two positions", |studio| {
        studio.hiperface().unwrap().session.trace.lines().iter().filter(|line| line.bytes == "40 42 02").count() > 1
    });
    screen.steps();
    screen.click("trace.follow");
    let row = screen.harness.query_all_by_label("40 42 02").next().unwrap().rect().center();
    let press = |pressed| egui::Event::PointerButton {
        pos: row,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    screen.harness.event(egui::Event::PointerMoved(row));
    screen.steps();
    screen.harness.event(press(true));
    screen.harness.event(press(false));
    screen.steps();
    assert!(screen.shows("0000  40 42 02"));
    screen.harness.key_press(Key::ArrowDown);
    screen.steps();
    assert!(screen.shows("0000  40 42 00 0E 05 31 38"), "the reply to it");
    screen.harness.key_press(Key::ArrowUp);
    screen.steps();
    assert!(screen.shows("0000  40 42 02"));
    screen.click("trace.close_frame");
    assert!(!screen.shows("0000  "));
}

/// A saved trace contains the frames in the list, in the format read by `replay:`.
#[test]
fn saves_trace_as_recording() {
    let mut desk = usual("", Some("sim:"));
    desk.until("it is read", |studio| studio.selected_device().is_some_and(|own| !own.trace().lines().is_empty()));
    let session = desk.studio.selected_device().unwrap().id();
    desk.act(Action::AskTrace(session));
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question.suggested_path().and_then(|path| path.extension()).unwrap(), "trace");
    let path = desk.outside.path("bench.trace");
    let frames = desk.studio.selected_device().unwrap().trace().lines().len();
    desk.act(Action::Chosen(question, path.clone()));
    desk.until("it is saved", |_| path.exists());
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(encoder_studio::link::read_trace(&text).unwrap().len() >= frames);
    assert!(text.starts_with("# encoder-studio trace 1\n"));
}

/// While the window asks for a path, the dialog is on top, and the key for the lower panel has no effect.
#[test]
fn lower_panel_key_waits_for_dialogs() {
    let mut screen = Screen::new_form(SMALL);
    screen.act(Action::TypePath(FileQuestion::Open));
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::T);
    screen.steps();
    assert!(!screen.studio().settings.lower_open);
    screen.act(Action::Connect(connect::ConnectAction::Close));
}
