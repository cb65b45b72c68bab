//! Tests of keys, dropped files, the system's close button, and an idle window, which requests no frames.

use crate::tabs::Tabs as _;
use std::time::Duration;

use egui::{Key, Modifiers, ViewportEvent, ViewportId};
use encoder_studio::app::Severity;
use encoder_studio::app::session::Phase;
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::screen::Screen;
use crate::support::PORT;

const SIZE: [f32; 2] = [1280.0, 800.0];

/// Returns the delay until the next frame requested by the window.
fn next_picture(screen: &Screen) -> Duration {
    screen.harness.output().viewport_output[&ViewportId::ROOT].repaint_delay
}

#[test]
fn idle_window_requests_no_frame() {
    let mut screen = Screen::new_form(SIZE);
    for page in encoder_studio::kinds::program().tabs.page_text_ids(crate::tabs::HIPERFACE) {
        screen.click(page);
        for _ in 0..30 {
            screen.harness.step();
            std::thread::sleep(Duration::from_millis(1));
        }
        assert!(next_picture(&screen) > Duration::from_secs(1), "{page}: {:?}", next_picture(&screen));
    }
    screen.click("live.start");
    screen.steps();
    assert!(next_picture(&screen) <= Duration::from_millis(50), "live values are drawn as they come");
}

#[test]
fn thread_results_wake_window() {
    let mut screen = Screen::new_form(SIZE);
    let wakes = screen.outside.wakes.clone();
    let before = wakes.load(std::sync::atomic::Ordering::SeqCst);
    screen.ask(Hiperface::ReadCounter);
    screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
    assert!(wakes.load(std::sync::atomic::Ordering::SeqCst) > before + 1);
}

#[test]
fn f5_reloads() {
    let mut screen = Screen::new_form(SIZE);
    let before = screen.outside.wire(PORT).count(0x56);
    screen.key(Key::F5);
    screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
    assert_eq!(screen.outside.wire(PORT).count(0x56), before + 1);
    // The open dialog has the keyboard focus.
    screen.click("shell.connect");
    screen.key(Key::F5);
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    screen.steps();
    assert_eq!(screen.outside.wire(PORT).count(0x56), before + 1);
}

#[test]
fn reports_control_enter_without_edits() {
    let mut screen = Screen::new_form(SIZE);
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    screen.steps();
    assert!(screen.shows(&screen.say("session.nothing_edited")));
    assert!(screen.encoder().session.review.is_none());
}

#[test]
fn close_button_asks_before_losing_edits() {
    let mut screen = Screen::new_form(SIZE);
    screen.ask(Hiperface::Put { field: 0, address: 0, bytes: vec![0] });
    let viewport = screen.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
    viewport.events.push(ViewportEvent::Close);
    screen.harness.step();
    let viewport = screen.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default();
    viewport.events.clear();
    screen.steps();
    assert!(screen.studio().question.is_some() && !screen.studio().can_close());
    screen.key(Key::Escape);
    assert!(screen.studio().question.is_none());
    assert!(screen.studio().services.log.notices().all(|notice| notice.severity < Severity::Error));
    assert_eq!(screen.encoder().session.phase, Phase::Connected);
}
