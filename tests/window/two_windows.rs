//! Tests of two windows that share a settings file, in this process and in separate ones. The changes of one window
//! survive the writes of the other, and limits that are not confirmed in one lock motion in the other.

use crate::hiperdrive::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use std::{env, fs, thread};

use encoder_studio::app::{Action, ColorScheme, Language, Settings, Studio, StudioEnvironment};
use encoder_studio::devices::hiperdrive::procedures::dead_man::MotionLock;
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, Length, Value};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, MotorCommand, PositionUnit};
use encoder_studio::kinds::program;
use encoder_studio::store::Store;
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, act, drive, number, unit, until_read};
use crate::support::{Desk, LONG, Outside};

const HUB: &str = "sim:?hub=4&drives=1,1&requested=1";

/// Returns two windows that share a settings folder.
fn two() -> (Desk, Desk) {
    let first = Desk::fresh("");
    let second = Desk { studio: first.outside.studio(), outside: Outside::new("") };
    (first, second)
}

/// Returns the settings that a new window would load.
fn found(desk: &Desk) -> Settings {
    desk.outside.studio().settings
}

/// Polls both windows until a condition holds.
#[track_caller]
fn poll_both_until(windows: [&mut Desk; 2], what: &str, condition: impl Fn(&Desk, &Desk) -> bool) {
    let [first, second] = windows;
    let began = Instant::now();
    while !condition(first, second) {
        assert!(began.elapsed() < LONG, "never: {what}\n{}", crate::support::log(&second.studio));
        first.studio.poll();
        second.studio.poll();
        thread::sleep(Duration::from_millis(1));
    }
}

/// Returns whether the settings file contains all of the given words.
fn settings_contain(desk: &Desk, words: &[&str]) -> bool {
    let text = fs::read_to_string(desk.outside.store().settings_path()).unwrap_or_default();
    words.iter().all(|word| text.contains(word))
}

fn with_drives(desk: &mut Desk) {
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open(HUB);
    until_read(desk);
}

fn take(desk: &mut Desk) {
    act(desk, Hiperdrive::Take);
    desk.until("the drives are in hand", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && !matches!(own.may_move(ONE), Err(why) if why.id() != "hd_lock.limits")
    });
}

/// Changes the scale of the drive as another master would, and reads the drive again.
fn scale(desk: &mut Desk, numerator: i64) {
    let target = unit(desk).target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), number(154), &Value::Number(numerator)).unwrap());
    command(desk, DeviceCommand::Read);
    desk.until("it is read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.parameter_value(ONE, 154) == Some(numerator)
    });
}

fn is_locked(desk: &Desk) -> bool {
    unit(desk).moves.motion_locks(ONE).contains(&MotionLock::LimitsUnconfirmed)
}

/// Settings are merged by key, so each window's changes survive, however often the windows write in turn (issue 21.11).
#[test]
fn concurrent_changes_survive() {
    let (mut first, mut second) = two();
    first.act(Action::SetTheme(ColorScheme::Light));
    first.studio.settings.use_link(crate::tabs::HIPERFACE, "tcp:first:1");
    second.act(Action::SetLanguage(Language::German));
    second.act(Action::StoreWindowSize(1500, 900));
    second.studio.settings.use_link(crate::tabs::HIPERFACE, "tcp:second:1");
    let all = ["Light", "German", "1500", "tcp:first:1", "tcp:second:1"];
    poll_both_until([&mut first, &mut second], "both are kept", |first, _| settings_contain(first, &all));
    first.act(Action::KeepLayout("(a layout)".to_owned()));
    poll_both_until([&mut first, &mut second], "it is kept", |first, _| settings_contain(first, &["(a layout)"]));
    let kept = found(&first);
    assert_eq!((kept.theme, kept.language, kept.size), (ColorScheme::Light, Language::German, Some((1500, 900))));
    assert_eq!(kept.layout.as_deref(), Some("(a layout)"));
    let mut links = kept.links_of(crate::tabs::HIPERFACE).to_vec();
    links.sort();
    assert_eq!(links, ["tcp:first:1", "tcp:second:1"]);
    // The settings of a window do not change while the user works in it.
    assert_eq!((first.studio.settings.language, second.studio.settings.theme), (Language::English, ColorScheme::Dark));
}

/// Limits that one window marks as unconfirmed are locked in another one that controls the drives, even if that one
/// neither reads nor writes anything. They are also locked in a window opened later, whatever the others write (issue
/// 21.11).
#[test]
fn other_window_locks_limits() {
    let (mut first, mut second) = two();
    let mut bystander = first.outside.studio();
    let path = first.outside.store().settings_path();
    with_drives(&mut first);
    with_drives(&mut second);
    take(&mut second);
    assert!(!is_locked(&first) && !is_locked(&second));
    scale(&mut first, 400);
    assert!(is_locked(&first));
    poll_both_until([&mut first, &mut second], "the other one is locked", |_, second| is_locked(second));
    drive(&mut second, MotorCommand::Step { by: 64 });
    assert_eq!(unit(&second).may_move(ONE).unwrap_err().id(), "hd_lock.limits");
    second.act(Action::SetTheme(ColorScheme::Light));
    poll_both_until([&mut first, &mut second], "that is kept", |first, _| settings_contain(first, &["Light"]));
    bystander.handle_action(Action::SetLanguage(Language::German));
    first.until("that is kept", |_| fs::read_to_string(&path).is_ok_and(|text| text.contains("German")));
    let mut later = Desk { studio: first.outside.studio(), outside: Outside::new("") };
    with_drives(&mut later);
    assert!(is_locked(&later));
}

/// Limits are confirmed only for the window in which the user does so. Another window keeps its lock, and marks the
/// limits again if the scale changes again (issue 21.11).
#[test]
fn confirms_limits_in_each_window() {
    let (mut first, mut second) = two();
    with_drives(&mut first);
    with_drives(&mut second);
    take(&mut second);
    scale(&mut first, 400);
    poll_both_until([&mut first, &mut second], "both are locked", |_, second| is_locked(second));
    drive(&mut second, MotorCommand::ConfirmLimits(ONE));
    assert!(!is_locked(&second));
    poll_both_until([&mut first, &mut second], "that is kept", |first, _| {
        settings_contain(first, &["unconfirmed: []"])
    });
    assert!(is_locked(&first) && !is_locked(&second));
    // The lock remains after further writes by both windows.
    first.act(Action::SetTheme(ColorScheme::Light));
    second.act(Action::SetLanguage(Language::German));
    poll_both_until([&mut first, &mut second], "that is kept", |first, _| {
        settings_contain(first, &["Light", "German"])
    });
    let began = Instant::now();
    poll_both_until([&mut first, &mut second], "some time passes", |_, _| began.elapsed() > Duration::from_secs(3));
    assert!(is_locked(&first) && !is_locked(&second));
    scale(&mut first, 100);
    poll_both_until([&mut first, &mut second], "the other one is locked again", |_, second| is_locked(second));
    assert!(settings_contain(&first, &["unconfirmed: [", "1,"]));
}

/// A value typed for a drive stays in its window, and is saved together with the values from the other window (issue
/// 21.11).
#[test]
fn typed_values_stay_in_their_window() {
    let (mut first, mut second) = two();
    with_drives(&mut first);
    with_drives(&mut second);
    let two = DriveNumber::new(2).unwrap();
    let pitch = |nanometres| Some(Length { nanometres });
    act(&mut first, Hiperdrive::SetPitch(ONE, pitch(4_000_000)));
    act(&mut second, Hiperdrive::SetPitch(two, pitch(5_000_000)));
    act(&mut second, Hiperdrive::SetMeasure(PositionUnit::Degrees));
    let all = ["1: 4000000", "2: 5000000", "Degrees"];
    poll_both_until([&mut first, &mut second], "both are kept", |first, _| settings_contain(first, &all));
    assert_eq!((unit(&first).spindle_pitch(two), unit(&second).spindle_pitch(ONE)), (None, None));
    assert_eq!(unit(&first).measure, PositionUnit::Steps);
    let mut later = Desk { studio: first.outside.studio(), outside: Outside::new("") };
    with_drives(&mut later);
    assert_eq!(
        (unit(&later).spindle_pitch(ONE), unit(&later).spindle_pitch(two)),
        (pitch(4_000_000), pitch(5_000_000))
    );
    assert_eq!(unit(&later).measure, PositionUnit::Degrees);
}

const FOLDER: &str = "ENCODER_STUDIO_TEST_FOLDER";
const NAME: &str = "ENCODER_STUDIO_TEST_NAME";

/// Runs an ignored test of this module in a separate process, as a second window that uses the same folder as `desk`.
fn process(desk: &Desk, test: &str, name: &str) -> Child {
    let mut own = Command::new(env::current_exe().unwrap());
    own.args(["--ignored", "--exact", &format!("two_windows::{test}")]);
    own.env(FOLDER, desk.outside.folder.path()).env(NAME, name).stdout(Stdio::null()).spawn().unwrap()
}

fn child_process_studio() -> (Studio, String) {
    let folder = env::var_os(FOLDER).expect("run by a test of this module");
    let world = StudioEnvironment::production(Store::at_root(folder.as_ref()), program().studio);
    (Studio::new(world, Arc::new(|| {})), env::var(NAME).unwrap())
}

#[test]
#[ignore = "run in processes of their own by `concurrent_processes_lose_no_settings`"]
fn process_using_links() {
    let (mut studio, name) = child_process_studio();
    let path = Store::at_root(env::var_os(FOLDER).unwrap().as_ref()).settings_path();
    for number in 0..6 {
        let link = format!("tcp:{name}:{number}");
        studio.settings.use_link(crate::tabs::HIPERFACE, &link);
        let began = Instant::now();
        while !fs::read_to_string(&path).is_ok_and(|text| text.contains(&link)) {
            assert!(began.elapsed() < LONG, "{link}");
            studio.poll();
        }
    }
}

/// Two processes write six links each as fast as they can, and none is lost. No more than twelve links are remembered
/// (issue 21.11).
#[test]
fn concurrent_processes_lose_no_settings() {
    let desk = Desk::fresh("");
    let windows = ["one", "two"].map(|name| process(&desk, "process_using_links", name));
    for mut window in windows {
        assert!(window.wait().unwrap().success());
    }
    let mut links = found(&desk).links_of(crate::tabs::HIPERFACE).to_vec();
    links.sort();
    let expected = ["one", "two"].iter().flat_map(|name| (0..6).map(move |number| format!("tcp:{name}:{number}")));
    assert_eq!(links, expected.collect::<Vec<_>>());
}

#[test]
#[ignore = "run in a process of its own by `killed_process_leaves_complete_file`"]
fn process_writing_forever() {
    let (mut studio, name) = child_process_studio();
    for number in 0_u32.. {
        studio.handle_action(Action::StoreWindowSize(number, 900));
        studio.settings.use_link(crate::tabs::BISS, &format!("tcp:{name}:{}", number % 7));
        studio.poll();
    }
}

/// The process is killed at a random moment while it writes (issue 21.11).
#[test]
fn killed_process_leaves_complete_file() {
    let mut desk = Desk::fresh("");
    let path = desk.outside.store().settings_path();
    for round in 0..8_u64 {
        let _ = fs::remove_file(&path);
        let mut window = process(&desk, "process_writing_forever", "killed");
        let began = Instant::now();
        while !path.exists() {
            assert!(began.elapsed() < LONG, "it never wrote");
            thread::sleep(Duration::from_millis(1));
        }
        thread::sleep(Duration::from_micros(1_700 * round));
        window.kill().unwrap();
        window.wait().unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let kept = Settings::parse(&text).expect("a whole file");
        assert!(
            kept.size.is_some() && kept.links_of(crate::tabs::BISS).iter().all(|link| link.starts_with("tcp:killed:"))
        );
        let layout = format!("(layout {round})");
        desk.act(Action::KeepLayout(layout.clone()));
        desk.until("it is written", |_| fs::read_to_string(&path).is_ok_and(|text| text.contains(&layout)));
    }
}

/// If the settings folder is not writable, only the settings are lost. Motion is still possible (issue 21.11).
#[cfg(unix)]
#[test]
fn unwritable_settings_do_not_prevent_motion() {
    let mut desk = Desk::fresh("");
    fs::write(desk.outside.path("config"), "a file in the way").unwrap();
    with_drives(&mut desk);
    take(&mut desk);
    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    scale(&mut desk, 400);
    assert!(is_locked(&desk), "here all the same");
}
