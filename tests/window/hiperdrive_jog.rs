//! Tests of the jog panel: visibility without scrolling, the speed presets, and the travel bar.

use egui::Rect;
use egui::accesskit::Role;
use egui_kittest::Node;
use egui_kittest::kittest::{AccessKitNode, NodeT, Queryable};
use encoder_studio::app::{Action, DeviceCommand};
use encoder_studio::devices::hiperdrive::procedures::dead_man::SpeedTorque;
use encoder_studio::devices::hiperdrive::protocol::Percent;
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, MotorCommand};

use crate::hiperdrive::{ONE, command, drive, unit};
use crate::hiperdrive_motion::in_control;
use crate::screen::Screen;
use crate::tabs::Tabs as _;

/// Height of the open lower panel, in points.
const LOWER_PANEL_HEIGHT: f32 = 170.0;
/// Height of everything above the page, in points.
const HEIGHT_ABOVE_PAGE: f32 = 155.0;

/// Opens a window of this size with control over the drives of a virtual device.
pub(crate) fn screen_in_control(link: &str, size: [f32; 2]) -> Screen {
    let mut screen = Screen::open_in_tab(crate::tabs::HIPERDRIVE, link, size);
    screen.until("it is read", |studio| {
        studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready())
    });
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Take));
    screen.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    screen.steps();
    screen
}

fn travel(screen: &Screen) -> Node<'_> {
    let label = screen.say("hd_travel.title");
    let is_it = move |node: &AccessKitNode<'_>| node.role() == Role::Image && node.label().as_ref() == Some(&label);
    screen.harness.query_all_by(is_it).next().unwrap()
}

fn travel_text(screen: &Screen) -> String {
    travel(screen).accesskit_node().value().unwrap_or_default()
}

fn preset<'s>(screen: &'s Screen, percent: &str) -> Node<'s> {
    let label = format!("{}: {percent} %", screen.say("hd_jog.speed"));
    screen.harness.query_all_by(move |node| node.label().as_ref() == Some(&label)).next().unwrap()
}

/// Returns the jog speed entry, which is the first speed entry on the page.
fn typed_speed(screen: &Screen) -> Node<'_> {
    let label = screen.say("hd_effort.speed");
    let is_it = move |node: &AccessKitNode<'_>| node.role() == Role::TextInput && node.label().as_ref() == Some(&label);
    let mut entries: Vec<Node<'_>> = screen.harness.query_all_by(is_it).collect();
    entries.sort_by(|one, other| one.rect().top().total_cmp(&other.rect().top()));
    entries.remove(0)
}

/// Returns the smallest rectangle around the pads, the state indicators and the travel bar.
fn essential_controls_rect(screen: &Screen) -> Rect {
    let pads = ["hd_jog.down", "hd_jog.up"].map(|id| screen.button(id).rect());
    let states = ["Moving", "Fault"].map(|name| screen.harness.get_by_role_and_label(Role::Button, name).rect());
    [pads, states].into_iter().flatten().fold(travel(screen).rect(), Rect::union)
}

/// The pads, the state and the travel bar are visible together: at 1280 × 800 with the trace open, and at 1024 × 640
/// after at most one scroll (issue 26.2).
#[test]
fn shows_pads_state_and_travel_together() {
    let needed = essential_controls_rect(&screen_in_control("sim:", [1280.0, 800.0]));
    assert!(needed.top() > 48.0 && needed.bottom() <= 800.0 - LOWER_PANEL_HEIGHT, "{needed:?}");
    let needed = essential_controls_rect(&screen_in_control("sim:", [1024.0, 640.0]));
    let page = 640.0 - LOWER_PANEL_HEIGHT - HEIGHT_ABOVE_PAGE;
    assert!(needed.bottom() <= HEIGHT_ABOVE_PAGE + 2.0 * page, "{needed:?}");
}

/// Tab moves on from a speed preset that was clicked (issue 26).
#[test]
fn tab_continues_after_clicked_preset() {
    let mut screen = screen_in_control("sim:", [1280.0, 800.0]);
    preset(&screen, "50").click();
    screen.steps();
    assert!(preset(&screen, "50").accesskit_node().is_focused());
    screen.key(egui::Key::Tab);
    assert!(preset(&screen, "100").accesskit_node().is_focused());
}

/// A preset sets the speed but does not start a motion. It also replaces typed text, even if that is not a percentage
/// (issue 26.2).
#[test]
fn preset_sets_speed_without_moving() {
    let mut screen = screen_in_control("sim:", [1280.0, 900.0]);
    let speed = |screen: &Screen| screen.studio().hiperdrive().unwrap().moves.jog_speed_torque(ONE).speed.get();
    assert_eq!(speed(&screen), 10);
    for percent in ["1", "50", "100", "10"] {
        preset(&screen, percent).click();
        screen.steps();
        assert_eq!(speed(&screen).to_string(), percent);
        assert_eq!(typed_speed(&screen).accesskit_node().value().unwrap_or_default(), percent);
        assert!(!screen.studio().is_motion_active() && !screen.studio().is_moving(), "{percent}");
    }
    let torque = screen.studio().hiperdrive().unwrap().moves.jog_speed_torque(ONE).torque.get();
    assert_eq!(torque, 25);
    typed_speed(&screen).focus();
    screen.steps();
    typed_speed(&screen).type_text("x");
    screen.steps();
    assert!(!screen.is_enabled("hd_jog.up"), "{}", typed_speed(&screen).accesskit_node().value().unwrap_or_default());
    preset(&screen, "10").click();
    screen.steps();
    assert_eq!(typed_speed(&screen).accesskit_node().value().unwrap_or_default(), "10");
    assert!(screen.is_enabled("hd_jog.up") && speed(&screen) == 10);
}

/// The jog speed is 10 % after every connection, not only after a program start (issue 26.2).
#[test]
fn reconnecting_resets_jog_speed() {
    let mut desk = in_control("sim:");
    let fast = SpeedTorque { speed: Percent::FULL, torque: Percent::FULL };
    drive(&mut desk, MotorCommand::JogEffort(fast));
    assert_eq!(unit(&desk).moves.jog_speed_torque(ONE), fast);
    command(&mut desk, DeviceCommand::Reconnect);
    desk.until("it is connected again", |studio| {
        studio.hiperdrive().is_some_and(|own| own.session.is_ready() && !own.moves.is_open())
    });
    assert_eq!(unit(&desk).moves.jog_speed_torque(ONE), SpeedTorque::DEFAULT_JOG);
}

/// The travel bar shows the limits, the position and the target in the user's unit. If the position is outside the
/// limits, it shows the way back (issue 26.2).
#[test]
fn travel_bar_shows_return_direction() {
    let inside = screen_in_control("sim:?position=65536", [1280.0, 800.0]);
    let said = travel_text(&inside);
    assert!(said.contains("65536 steps") && said.contains("-33488896 steps … 33488896 steps"), "{said}");
    assert!(!said.contains(&inside.say("hd_outside.short")), "{said}");
    for (link, way) in
        [("sim:?position=40000000", "hd_travel.back_down"), ("sim:?position=-40000000", "hd_travel.back_up")]
    {
        let screen = screen_in_control(link, [1280.0, 800.0]);
        assert!(travel_text(&screen).starts_with(&screen.say(way)), "{}", travel_text(&screen));
        let pads = ["hd_jog.down", "hd_jog.up"].map(|id| screen.is_enabled(id));
        assert_eq!(pads, if way == "hd_travel.back_down" { [true, false] } else { [false, true] });
    }
}
