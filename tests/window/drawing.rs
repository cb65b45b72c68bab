//! Tests of how often the window is drawn while nothing changes. Time is simulated: each frame is drawn at the time
//! that the previous one requested (issue 22.32).

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::sync::atomic::Ordering;

use egui::ViewportId;
use encoder_studio::app::{Action, FileQuestion, Studio, Tab};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::hiperdrive_stop::in_hand;
use crate::screen::Screen;
use crate::support::Outside;

const SIZE: [f32; 2] = [1280.0, 900.0];
/// Duration of an observation in seconds.
const WATCHED: f64 = 10.0;
/// Delay in seconds up to which a repaint counts as immediate.
const IMMEDIATE_REPAINT_DELAY: f64 = 1.0 / 60.0;
/// Maximum number of frames for a text cursor, which blinks at most once per second.
const MAX_CURSOR_FRAMES: usize = 2 * WATCHED as usize + 2;
/// Maximum number of frames for live values, which are drawn every 50 ms.
const MAX_LIVE_FRAMES: usize = (WATCHED / 0.05) as usize + 2;

/// A named state of the window, and the function that puts the window into it.
type Situation = (&'static str, fn(&mut Screen));

const SITUATIONS: [Situation; 8] = [
    ("in front", |_| {}),
    ("not in front", |screen| screen.harness.input_mut().focused = false),
    ("help", |screen| screen.click("shell.help")),
    ("about", |screen| screen.click("shell.about")),
    ("connecting", |screen| screen.click("shell.connect")),
    ("a path is typed", |screen| screen.act(Action::TypePath(FileQuestion::Open))),
    ("a question", |screen| {
        screen.act(Action::Close);
        assert!(screen.studio().question.is_some());
    }),
    ("a review", |screen| {
        let id = screen.studio().selected_device().unwrap().id();
        screen.act(Action::Command(id, DeviceCommand::Review));
        screen.until("the review is open", |studio| studio.selected_device().unwrap().is_reviewing());
    }),
];

/// Returns the number of frames that the window requests within [`WATCHED`] seconds.
fn pictures(screen: &mut Screen) -> usize {
    let (mut passed, mut count) = (0.0, 0);
    loop {
        let next = screen.harness.output().viewport_output[&ViewportId::ROOT].repaint_delay.as_secs_f64();
        passed += next.max(IMMEDIATE_REPAINT_DELAY);
        if passed > WATCHED {
            screen.harness.input_mut().time = None;
            return count;
        }
        let now = screen.harness.ctx.input(|input| input.time);
        screen.harness.input_mut().time = Some(now + next.max(IMMEDIATE_REPAINT_DELAY));
        screen.harness.step();
        count += 1;
    }
}

/// Returns a window with an encoder that has been read and edited, so there are edits to review and to lose.
fn edited() -> Screen {
    let mut screen = Screen::new_form(SIZE);
    screen.ask(Hiperface::Put { field: 0, address: 0, bytes: vec![0] });
    screen
}

/// Waits for all temporary changes to end, such as notices, animations and results from threads.
fn settle(screen: &mut Screen) {
    for _ in 0..2 {
        screen.until("nothing runs", |studio| !studio.is_working());
        // Drafts and settings are written on threads.
        for _ in 0..50 {
            screen.harness.step();
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        pictures(screen);
    }
}

/// An idle window requests no frames. Previously, the release of keys requested a new frame in every frame, even when
/// no keys were held (issue 22.32).
#[test]
fn draws_nothing_while_idle() {
    for (what, begin) in SITUATIONS {
        let mut screen = edited();
        begin(&mut screen);
        settle(&mut screen);
        let wakes = screen.outside.wakes.load(Ordering::SeqCst);
        let count = pictures(&mut screen);
        let most = if ["connecting", "a path is typed"].contains(&what) { MAX_CURSOR_FRAMES } else { 0 };
        assert!(count <= most, "{what}: {count} pictures in {WATCHED} s");
        // A frame does not cause the next one through a thread either.
        for _ in 0..50 {
            screen.harness.step();
        }
        assert_eq!(screen.outside.wakes.load(Ordering::SeqCst), wakes, "{what}");
    }
}

/// Without a device, the window is drawn only when something changes, on every tab (issue 22.32).
#[test]
fn redraws_changes_without_device() {
    let mut screen = Screen::opened(Outside::new(""), Some("serial:/dev/nothing"), SIZE);
    for tab in [
        crate::tabs::HIPERFACE,
        crate::tabs::BISS,
        crate::tabs::SSI,
        crate::tabs::INTERBUS,
        crate::tabs::HIPERDRIVE,
        crate::tabs::SIGNALS,
    ] {
        screen.act(Action::ShowTab(tab));
        for focused in [true, false] {
            screen.harness.input_mut().focused = focused;
            for page in encoder_studio::kinds::program().tabs.page_text_ids(tab) {
                if screen.has_button(page) {
                    screen.click(page);
                }
                settle(&mut screen);
                assert_eq!(pictures(&mut screen), 0, "{tab:?}, {page}, {focused}");
            }
        }
    }
}

/// With a device that is not polled, the window is drawn only when something changes (issue 22.32).
#[test]
fn redraws_changes_without_polling() {
    type Ready = fn(&Studio) -> bool;
    let kinds: [(Tab, &str, Ready); 3] = [
        (crate::tabs::BISS, "sim:?bridge=on", |studio| studio.biss().is_some_and(|own| own.survey.is_some())),
        (crate::tabs::INTERBUS, "sim:?steps=3600&revolutions=1&cams=demo", |studio| {
            studio.interbus().is_some_and(|own| own.known_program_count() == 8)
        }),
        (crate::tabs::HIPERDRIVE, "sim:", |studio| studio.hiperdrive().is_some_and(|own| own.survey.is_some())),
    ];
    for (tab, link, is_read) in kinds {
        let mut screen = Screen::open_in_tab(tab, link, SIZE);
        screen.until("it is read", |studio| is_read(studio) && !studio.is_working());
        if screen.studio().is_live() {
            screen.click("live.pause");
            screen.until("it is not polled", |studio| !studio.is_live());
        }
        for focused in [true, false] {
            screen.harness.input_mut().focused = focused;
            for page in encoder_studio::kinds::program().tabs.page_text_ids(tab) {
                screen.click(page);
                settle(&mut screen);
                assert_eq!(pictures(&mut screen), 0, "{tab:?}, {page}, {focused}");
            }
        }
    }
}

/// Live values are drawn only as often as they change, with any dialog open and even in the background (issue 22.32).
#[test]
fn background_window_keeps_frame_rate() {
    let mut screen = in_hand();
    for (what, begin) in [SITUATIONS[0], SITUATIONS[1], SITUATIONS[2]] {
        begin(&mut screen);
        screen.steps();
        let count = pictures(&mut screen);
        assert!(count <= MAX_LIVE_FRAMES, "{what}: {count} pictures in {WATCHED} s");
        screen.harness.input_mut().focused = true;
    }
}
