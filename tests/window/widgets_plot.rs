//! Tests of the plot in the window: its tools by their labels, and its chart by pointer and keyboard.

use crate::tabs::Tabs as _;
use encoder_studio::app::{DeviceCommand, DeviceModel as _};
use std::time::Duration;

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Role};
use egui_kittest::kittest::Queryable;
use encoder_studio::app::recorder::{Cursor, Recorder, TriggerCondition, TriggerState};
use encoder_studio::app::{Action, FileQuestion};
use encoder_studio::app::{Language, RecorderOwner as Of, recorder};

use crate::screen::Screen;
use crate::support::Outside;

/// Returns a window with a recording of a turning encoder that is no longer polled.
fn recorded() -> Screen {
    let mut screen = Screen::opened(Outside::new("rpm=600"), None, [1280.0, 800.0]);
    screen.until("it is read", |studio| {
        studio.hiperface().is_some_and(|encoder| encoder.session.is_ready() && encoder.identity.is_some())
    });
    screen.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    screen.until("samples come", |studio| studio.hiperface().unwrap().record.position_count() > 300);
    screen.act(Action::Stop);
    screen.steps();
    screen
}

fn recorder(screen: &Screen) -> &Recorder {
    screen.encoder().recording().recorder()
}

fn chart(screen: &Screen) -> Rect {
    let label = screen.say("recorder.chart");
    let bounds = screen.harness.get_by_role_and_label(Role::Image, &label).rect();
    Rect::from_min_max(bounds.min, bounds.max)
}

/// Returns a point in the chart from relative coordinates, excluding the area of the axis labels.
fn inside(screen: &Screen, x: f32, y: f32) -> Pos2 {
    let chart = chart(screen);
    let chart = Rect::from_min_max(chart.min + egui::vec2(80.0, 10.0), chart.max - egui::vec2(10.0, 30.0));
    chart.lerp_inside([x, y])
}

fn drag(screen: &mut Screen, button: PointerButton, from: Pos2, to: Pos2) {
    let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    screen.harness.event(Event::PointerMoved(from));
    screen.harness.step();
    screen.harness.event(press(from, true));
    screen.harness.step();
    for part in [0.3, 0.7, 1.0] {
        screen.harness.event(Event::PointerMoved(from.lerp(to, part)));
        screen.harness.step();
    }
    screen.harness.event(press(to, false));
    screen.steps();
}

#[test]
fn plot_pauses_and_continues() {
    let mut screen = recorded();
    assert!(recorder(&screen).follows_newest());
    screen.click("recorder.pause");
    assert!(!recorder(&screen).follows_newest());
    screen.click("recorder.follow");
    assert!(recorder(&screen).follows_newest());
    screen.click("recorder.fit");
    let (first, last) = recorder(&screen).recorded_span().unwrap();
    let (from, to) = recorder(&screen).window_bounds();
    assert!(from <= first && to >= last && !recorder(&screen).follows_newest());
    screen.click("recorder.export");
    screen.click("live.clear");
    assert!(recorder(&screen).is_empty());
}

#[test]
fn drag_zooms_and_double_click_resets() {
    let mut screen = recorded();
    screen.click("recorder.fit");
    let (whole_from, whole_to) = recorder(&screen).window_bounds();
    let (from, to) = (inside(&screen, 0.25, 0.05), inside(&screen, 0.5, 0.06));
    drag(&mut screen, PointerButton::Primary, from, to);
    let (from, to) = recorder(&screen).window_bounds();
    let share = to.seconds_since(from) / whole_to.seconds_since(whole_from);
    assert!(from > whole_from && to < whole_to && (0.15..0.35).contains(&share), "{share}");
    let first = recorder(&screen).series().first().unwrap();
    assert_eq!(first.range, None, "a flat box is about time alone");
    let (a, b) = (inside(&screen, 0.2, 0.1), inside(&screen, 0.6, 0.35));
    drag(&mut screen, PointerButton::Primary, a, b);
    assert!(recorder(&screen).series().first().unwrap().range.is_some());
    // Dragging with the right button moves the visible span without changing its length.
    let span = recorder(&screen).window_length();
    let before = recorder(&screen).window_bounds().0;
    let (a, b) = (inside(&screen, 0.2, 0.5), inside(&screen, 0.5, 0.5));
    drag(&mut screen, PointerButton::Secondary, a, b);
    assert_eq!(recorder(&screen).window_length(), span);
    assert!(recorder(&screen).window_bounds().0 < before, "what lay at the left came into sight");
    let pos = inside(&screen, 0.5, 0.5);
    // Each event is a separate frame here, a quarter of a second after the previous one.
    screen.harness.ctx.options_mut(|options| options.input_options.max_double_click_delay = 2.0);
    screen.harness.event(Event::PointerMoved(pos));
    screen.harness.step();
    for pressed in [true, false, true, false] {
        let button = PointerButton::Primary;
        screen.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    }
    screen.steps();
    assert_eq!(recorder(&screen).window_bounds(), (whole_from, whole_to));
    assert_eq!(recorder(&screen).series().first().unwrap().range, None);
}

fn switch_cursors(screen: &mut Screen) {
    let label = screen.say("recorder.cursors");
    screen.harness.get_by_role_and_label(Role::Switch, &label).click();
    screen.steps();
}

#[test]
fn shows_drags_and_reads_cursors() {
    let mut screen = recorded();
    screen.click("recorder.fit");
    switch_cursors(&mut screen);
    let a = recorder(&screen).cursor(Cursor::A).unwrap();
    assert!(recorder(&screen).cursor_distance().unwrap() > 0);
    let (mut from, to) = (inside(&screen, 0.0, 0.5), inside(&screen, 0.9, 0.5));
    // The cursor is at the first third of the visible part. The width of the gutter is unknown here, so the test
    // searches for the cursor.
    let mut moved = false;
    for _ in 0..120 {
        from.x += 2.0;
        drag(&mut screen, PointerButton::Primary, from, to);
        if recorder(&screen).cursor(Cursor::A) != Some(a) {
            moved = true;
            break;
        }
        screen.click("recorder.fit");
    }
    assert!(moved);
    assert!(recorder(&screen).cursor(Cursor::A).unwrap() > a);
    assert!(screen.shows("Δt"));
    switch_cursors(&mut screen);
    assert_eq!(recorder(&screen).cursor_distance(), None);
}

#[test]
fn hides_lines_and_changes_units() {
    let mut screen = recorded();
    screen.click("recorder.lines");
    let speed = screen.say("recorder.speed");
    screen.harness.get_by_role_and_label(Role::CheckBox, &speed).click();
    screen.steps();
    assert_eq!(recorder(&screen).visible_series().count(), 1);
    let degrees = format!("{}: °", screen.say("recorder.position"));
    screen.harness.get_by_role_and_label(Role::RadioButton, &degrees).click();
    screen.steps();
    assert_eq!(recorder(&screen).series().first().unwrap().scale().unwrap().unit.id(), "unit.degrees");
    let one_axis = screen.say("recorder.one_axis");
    screen.harness.get_by_role_and_label(Role::CheckBox, &one_axis).click();
    screen.steps();
    assert!(recorder(&screen).has_one_axis());
}

#[test]
fn sets_arms_and_disables_trigger() {
    let mut screen = recorded();
    for (level, works) in [("high", false), ("", false), ("1e999", false), ("250,5", true)] {
        screen.click("recorder.trigger");
        let label = screen.say("trigger.level");
        screen.harness.get_by_role_and_label(Role::TextInput, &label).focus();
        screen.harness.step();
        screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        screen.harness.step();
        screen.harness.event(Event::Text(level.to_owned()));
        if level.is_empty() {
            screen.harness.key_press(Key::Backspace);
        }
        screen.steps();
        screen.click("trigger.arm");
        assert_eq!(recorder(&screen).trigger().is_some(), works, "{level:?}");
        if !works {
            assert!(screen.shows(&crate::texts::text("trigger.no_level").to_string_in(Language::English)), "{level:?}");
            screen.key(Key::Escape);
        }
    }
    // Another trigger condition is chosen in a panel that stays open.
    screen.click("recorder.trigger");
    let falling = format!("{}: {}", screen.say("trigger.when"), screen.say("trigger.falling"));
    screen.harness.get_by_role_and_label(Role::RadioButton, &falling).click();
    screen.steps();
    screen.click("trigger.arm");
    assert_eq!(recorder(&screen).trigger().unwrap().0.when, TriggerCondition::Falling);
    let (trigger, state) = recorder(&screen).trigger().unwrap();
    assert_eq!((trigger.level, state), (250.5, TriggerState::Armed));
    screen.click("recorder.disarm");
    assert!(recorder(&screen).trigger().is_none());
}

#[test]
fn enlarges_and_restores_plot() {
    let mut screen = recorded();
    let small = chart(&screen).width();
    screen.click("recorder.large");
    assert!(chart(&screen).width() > small * 1.5);
    screen.key(Key::Escape);
    assert_eq!(chart(&screen).width(), small);
    screen.click("recorder.large");
    screen.click("page.memory");
    assert_eq!(chart(&screen).width(), small, "whoever wants to see a page sees it");
}

#[test]
fn keyboard_pans_and_zooms() {
    let mut screen = recorded();
    screen.click("recorder.fit");
    let whole = recorder(&screen).window_length();
    let label = screen.say("recorder.chart");
    screen.harness.get_by_role_and_label(Role::Image, &label).focus();
    screen.steps();
    screen.key(Key::Plus);
    assert!((recorder(&screen).window_length() - whole / 2).abs() <= 1);
    let before = recorder(&screen).window_bounds().0;
    screen.key(Key::ArrowRight);
    assert!(recorder(&screen).window_bounds().0 > before);
    screen.key(Key::A);
    assert!(recorder(&screen).cursor(Cursor::A).is_some());
    screen.key(Key::Home);
    assert_eq!(recorder(&screen).window_length(), whole);
    screen.key(Key::End);
    assert!(recorder(&screen).follows_newest());
}

#[test]
fn menu_exports_table() {
    let mut screen = recorded();
    let of = Of::Device(screen.encoder().session.id);
    screen.click("recorder.export");
    screen.click("recorder.csv_visible");
    // Without a portal, the window asks for a path itself, and this question is still on the way.
    screen.until("it asks for a path", |_| true);
    let question = FileQuestion::Table { owner: of, visible: true, suggested: "x".into() };
    let path = screen.outside.path("samples.csv");
    screen.act(Action::Chosen(question, path.clone()));
    screen.until("it is written", |studio| {
        studio.services.log.notices().any(|notice| notice.texts[0].id() == "recorder.written")
    });
    assert!(path.exists());
    screen.act(Action::Recorder(of, recorder::RecorderAction::Clear));
    assert!(recorder(&screen).is_empty());
}
