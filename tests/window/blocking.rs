//! Tests that the window never waits for a hanging link, a hanging or full disk, or unread events.

use crate::tabs::Tabs as _;
use encoder_studio::app::{DeviceCommand, DeviceModel as _};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::connect::form::FormModel;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, ColorScheme, Severity};
use encoder_studio::devices::hiperface::procedures::find::FindOptions;
use encoder_studio::devices::hiperface::state::LinkForm;
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState};

use crate::support::{Desk, HANGING_LINK, PORT, SLOW, is_review};

/// Creates a named pipe with no reader or writer, so opening it waits forever.
fn pipe(path: &Path) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn hung_link_does_not_block() {
    let mut desk = Desk::fresh("");
    desk.open(HANGING_LINK);
    desk.settle();
    assert_eq!(*desk.phase(), Phase::Opening);
    let hanging = desk.encoder().session.id;
    let poll = DeviceCommand::Poll(Some(Duration::ZERO));
    for command in [DeviceCommand::Read, DeviceCommand::Review, poll, DeviceCommand::Reconnect] {
        desk.command(command);
    }
    desk.open(&format!("serial:{PORT}"));
    desk.until_read();
    assert_eq!(desk.studio.devices().len(), 2);
    desk.act(Action::CloseSession(hanging));
    assert!(desk.studio.question.is_none(), "nothing would be lost");
    assert_eq!(desk.studio.devices().len(), 1);
    assert_eq!(desk.studio.settings.links_of(crate::tabs::HIPERFACE), [format!("serial:{PORT}")]);
    desk.act(Action::Close);
    desk.until("it may close", |studio| studio.can_close());
}

#[test]
fn cancelled_opening_drops_late_result() {
    for stop in [|| Action::Stop, || Action::Escape] {
        let mut desk = Desk::fresh("");
        desk.open(SLOW);
        desk.settle();
        assert!(desk.studio.can_stop());
        desk.act(stop());
        assert!(matches!(desk.phase(), Phase::Lost(why) if why.id() == "session.open_cancelled"));
        assert!(!desk.studio.can_stop() && desk.notice_ids(Severity::Warning).is_empty(), "as the user wished");
        desk.outside.opens.store(true, std::sync::atomic::Ordering::SeqCst);
        desk.settle();
        assert!(matches!(desk.phase(), Phase::Lost(_)));
        assert_eq!(desk.wire().sent(), 0);
        desk.command(DeviceCommand::Reconnect);
        desk.until_read();
    }
}

#[test]
fn can_cancel_search_on_hung_link() {
    let mut desk = Desk::fresh("");
    let hanging = LinkForm::from_url(&HANGING_LINK.parse().unwrap());
    desk.connect(Connect::Open);
    desk.connect(Connect::edit_form(hanging));
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    desk.settle();
    assert!(desk.studio.can_stop());
    desk.act(Action::Escape);
    assert!(!desk.studio.can_stop());
    assert!(crate::tabs::search(desk.studio.connect.as_ref().unwrap()).unwrap().end.is_some());
    // The hanging search does not disturb the next one.
    desk.connect(Connect::Use(format!("serial:{PORT}")));
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    desk.until("it is found", |studio| {
        let search = studio.connect.as_ref().and_then(|dialog| crate::tabs::search(dialog));
        search.is_some_and(|search| !search.is_running() && search.found.len() == 1)
    });
    desk.act(Action::Escape);
    assert!(desk.studio.connect.is_none());
}

#[cfg(unix)]
#[test]
fn hung_disk_does_not_block() {
    let mut desk = Desk::new_form("");
    let (profile, types) = (desk.outside.path("pipe.ron"), desk.outside.store().device_file("hiperface"));
    pipe(&profile);
    pipe(&types);
    desk.act(Action::Open(profile.clone()));
    desk.command(DeviceCommand::Restore(profile));
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/hiperface/multiturn-skm36.ron");
    desk.act(Action::Open(shipped));
    desk.command(DeviceCommand::Read);
    desk.until_ready();
    desk.put(0, 0, b"X");
    desk.write();
    assert_eq!(desk.notice_ids(Severity::Warning), ["file.no_file", "file.no_file"], "a pipe is no profile");
}

/// The disk neither saves the settings nor reports an error. Closing waits only for a limited time.
#[cfg(unix)]
#[test]
fn hung_disk_does_not_delay_closing() {
    let mut desk = Desk::new_form("");
    let settings = desk.outside.store().settings_path();
    desk.until("the settings are kept", |_| settings.exists());
    desk.settle();
    fs::remove_file(&settings).unwrap();
    pipe(&settings);
    desk.act(Action::SetTheme(ColorScheme::Light));
    desk.act(Action::Close);
    assert!(!desk.studio.can_close());
    let before = desk.outside.wakes.load(std::sync::atomic::Ordering::SeqCst);
    desk.until("it may close", |studio| studio.can_close());
    assert!(desk.outside.wakes.load(std::sync::atomic::Ordering::SeqCst) > before, "the window is told to look");
}

/// The disk does not even respond to the search for a draft. Closing the window waits only for a limited time.
#[cfg(unix)]
#[test]
fn hung_draft_file_does_not_delay_closing() {
    let mut desk = Desk::fresh("");
    pipe(&desk.outside.path("data/drafts/hiperface-virtual/37-GB0450179.ron"));
    desk.studio.start_with(None, None);
    desk.until_read();
    desk.put(0, 0, b"X");
    desk.write();
    desk.act(Action::Close);
    assert!(desk.studio.question.is_none() && !desk.studio.can_close());
    desk.until("it may close", |studio| studio.can_close());
}

#[cfg(unix)]
#[test]
fn hung_settings_file_does_not_delay_start() {
    let desk = Desk::fresh("");
    pipe(&desk.outside.store().settings_path());
    let mut desk = desk.crash();
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.settings_slow"]);
    desk.studio.start_with(None, None);
    desk.until_read();
}

#[test]
fn reports_unwritable_folder() {
    let mut desk = Desk::new_form("");
    desk.ask(Hiperface::Save(desk.outside.path("no/such/folder/mine.ron")));
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.severity == Severity::Error));
    assert_eq!(desk.notice_ids(Severity::Error), ["file.no_folder", "session.not_saved"]);
    desk.until_ready();
}

/// Returns the text ID of the reason why an edit is not written.
fn refused(desk: &mut Desk) -> &'static str {
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.write_as_shown();
    desk.until("it is refused", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Failed { begun: false, .. }))
    });
    let ReviewState::Failed { texts, .. } = &desk.review().state else { panic!() };
    texts[0].id()
}

#[test]
fn writes_nothing_without_backup() {
    let mut desk = Desk::new_form("");
    fs::create_dir_all(desk.outside.path("data")).unwrap();
    fs::write(desk.outside.path("data/backups"), "a file in the way").unwrap();
    assert_eq!(refused(&mut desk), "write.not_kept");
    assert_eq!((desk.wire().wear(), desk.edits()), (0, vec![(0, 0, b'X')]));
}

/// Without the logbook, the number of write cycles is unknown. A write then requires a permission, which is available
/// only in the review (issue 22.4).
#[test]
fn write_without_logbook_needs_permission() {
    let mut desk = Desk::new_form("");
    let logbook = desk.outside.store().logbook_path();
    // The logbook exists because the connection is already recorded.
    fs::remove_file(&logbook).unwrap();
    fs::create_dir_all(logbook).unwrap();
    assert_eq!((refused(&mut desk), desk.wire().wear()), ("write.uncounted", 0));
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    let sheet = desk.review().to_sheet(0);
    assert_eq!((sheet.force_wear, sheet.is_uncounted), (Some(false), true));
    desk.ask(Hiperface::ForceWear(true));
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.wire().field(0)[0], b'X');
    assert!(desk.notice_ids(Severity::Warning).ends_with(&["session.written", "write.logbook"]));
    desk.until("the list says why", |studio| matches!(studio.hiperface().unwrap().session.writes, Some(Err(_))));
}

/// Waits for a condition without processing events, so they stay unread.
fn wait_without_polling(condition: impl Fn() -> bool) {
    let began = Instant::now();
    while !condition() {
        assert!(began.elapsed() < Duration::from_secs(20));
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn keeps_newest_unread_samples_and_frames() {
    let mut desk = Desk::new_form("rpm=60");
    let wire = desk.wire();
    desk.command(DeviceCommand::Poll(Some(Duration::ZERO)));
    wait_without_polling(|| wire.count(0x42) > 10_500);
    desk.studio.poll();
    let (dropped, positions) = (desk.encoder().recording().dropped_count(), desk.encoder().record.position_count());
    assert!(dropped > 0 && positions >= 4_096, "{dropped} {positions}");
    assert!(desk.encoder().session.trace.dropped_count() > 0);
    // During polling, a job is accepted immediately.
    desk.ask(Hiperface::ReadCounter);
    desk.until_ready();
    desk.act(Action::Stop);
    assert!(desk.notice_ids(Severity::Warning).is_empty());
}

/// At up to 2,000 frames per second, every frame is in the trace. A window takes new frames at least eight times per
/// second. This test is stricter: ten times, a full second of frames (1,000 readings of two frames each) has to wait
/// (issue 26).
#[test]
fn traces_2000_frames_per_second() {
    let mut desk = Desk::new_form("rpm=60");
    let wire = desk.wire();
    let (before, frames) = (wire.count(0x42), desk.encoder().session.trace.next_number());
    desk.command(DeviceCommand::Poll(Some(Duration::ZERO)));
    let mut longest = 0;
    for _ in 0..10 {
        let since = wire.count(0x42);
        wait_without_polling(|| wire.count(0x42) >= since + 1_000);
        desk.studio.poll();
        longest = longest.max(wire.count(0x42) - since);
    }
    desk.command(DeviceCommand::Poll(None));
    desk.until("the last reply has arrived", |studio| {
        studio.hiperface().is_some_and(|own| !own.session.is_polling() && own.session.is_ready())
    });
    desk.settle();
    let trace = &desk.encoder().session.trace;
    let readings = u64::try_from(wire.count(0x42) - before).unwrap();
    assert!(readings >= 10_000);
    assert_eq!(trace.next_number() - frames + trace.dropped_count(), 2 * readings, "a request and a reply each");
    // On a busy computer, more than ten seconds of frames may wait, and there is no room for so many.
    if longest < 9_000 {
        assert_eq!(trace.dropped_count(), 0);
    }
}

#[test]
fn background_search_reports_its_end() {
    let mut desk = Desk::fresh("encoders=8");
    let wire = desk.wire();
    desk.connect(Connect::Open);
    desk.connect(Connect::Use(format!("serial:{PORT}")));
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    desk.until("it has begun", |_| wire.sent() > 0);
    // The search reports the progress of hundreds of attempts, and the reports stay unread.
    wait_without_polling(|| {
        let sent = wire.sent();
        std::thread::sleep(Duration::from_millis(150));
        wire.sent() == sent
    });
    desk.until("the end is told", |studio| !studio.can_stop());
    let search = crate::tabs::search(desk.studio.connect.as_ref().unwrap()).unwrap();
    assert_eq!(search.found.iter().map(|found| found.address).collect::<Vec<_>>(), (0x40..0x48).collect::<Vec<u8>>());
    assert_eq!(search.end.as_ref().unwrap().id(), "find.done");
}
