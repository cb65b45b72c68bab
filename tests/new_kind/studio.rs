//! Tests of the test kind in the application and the window.

use eframe::{App, Frame};
use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use encoder_studio::analysis::history::Value;
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::review::Stage;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{
    Action as StudioAction, DeviceCommand, DeviceModel, Language, ReviewAction, Severity, Text, ThemeData,
};
use encoder_studio::devices::interbus::state::InterbusAction as Interbus;
use encoder_studio::profile::{Body, ProfileDocument};
use encoder_studio::store::Store;
use encoder_studio::ui::{Window, install_fonts};
use std::io::ErrorKind;
use std::time::Duration;

use super::desk::{Desk, program};
use super::novo::profile::NovoProfile;
use super::novo::protocol::Values;
use super::novo::state::Encoder;

/// Factory values of the virtual encoder.
const FACTORY_VALUES: Values = [0, 3, 0, 65535];

#[test]
fn dialog_connects_new_kind() {
    assert_eq!(program().tabs.page_text_ids(Encoder::TAB), ["page.values", "page.backups"]);
    let mut desk = Desk::new();
    let actions = [
        Connect::Open,
        Connect::Device(Encoder::TAB),
        Connect::Use("sim:?serial=77&rpm=fast".to_owned()),
        Connect::Connect,
    ];
    actions.into_iter().for_each(|action| desk.studio.handle_action(StudioAction::Connect(action)));
    assert!(desk.studio.devices().is_empty(), "that is no speed");
    for action in [Connect::Use("sim:?serial=77".to_owned()), Connect::Connect] {
        desk.studio.handle_action(StudioAction::Connect(action));
    }
    desk.until_ready();
    let read = desk.encoder().read().cloned();
    assert_eq!(read, Some(NovoProfile { serial: 77, values: FACTORY_VALUES }));
    assert_eq!((desk.shown().tab(), desk.shown().name().as_str()), (Encoder::TAB, "Novo · 77"));
}

/// A secret link parameter appears in no message, name, setting or other file.
#[test]
fn hides_secret_parameter() {
    let mut desk = Desk::connected("?serial=77&pin=4711");
    assert_eq!(desk.shown().data_source(), "sim:?serial=77");
    assert_eq!(desk.studio.settings.links_of(Encoder::TAB), ["sim:?serial=77"]);
    desk.set(1, 9);
    desk.command(DeviceCommand::Review);
    let Stage::Ready(plan) = desk.until_stage(|stage| matches!(stage, Stage::Ready(_))) else { panic!("no plan") };
    desk.review(ReviewAction::Write(plan));
    desk.until_stage(|stage| matches!(stage, Stage::Failed { .. }));
    // The value is rejected in the dialog, and in a link that no kind accepts.
    for action in [Connect::Open, Connect::Device(Encoder::TAB), Connect::Use("sim:?pin=47110".to_owned())] {
        desk.studio.handle_action(StudioAction::Connect(action));
    }
    let refused = desk.studio.connect.as_ref().unwrap().url().unwrap_err();
    assert!(
        refused.terminal_text().contains("**") && !refused.terminal_text().contains("4711"),
        "{}",
        refused.terminal_text()
    );
    desk.studio.start_with(Some("sim:?pin=4711&colour=green".parse().unwrap()), None);
    desk.until("it is refused", |desk| matches!(desk.shown().phase(), Phase::Lost(_)));
    assert_eq!(desk.shown().data_source(), "sim:?colour=green");
    let names: Vec<String> = desk.studio.devices().iter().map(|device| device.name()).collect();
    let told = |text: &Text| text.terminal_text();
    let log: Vec<String> = (desk.studio.services.log.notices())
        .map(|own| format!("{:?} {}", own.about, own.texts.iter().map(told).collect::<String>()))
        .collect();
    assert!(!format!("{names:?} {log:?}").contains("4711"), "{names:?} {log:?}");
    desk.until("the link is kept", |desk| {
        let settings = std::fs::read_to_string(Store::at_root(desk.folder.path()).settings_path());
        settings.is_ok_and(|text| text.contains("sim:?serial=77"))
    });
    let mut folders = vec![desk.folder.path().to_owned()];
    let mut files = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            match entry.is_dir() {
                true => folders.push(entry),
                false => {
                    let content = match std::fs::read(&entry) {
                        // A temporary file that was renamed meanwhile, because it is complete.
                        Err(error) if error.kind() == ErrorKind::NotFound => continue,
                        content => content.unwrap(),
                    };
                    files += 1;
                    let text = String::from_utf8_lossy(&content);
                    assert!(!text.contains("4711"), "{}", entry.display());
                }
            }
        }
    }
    assert!(files > 2, "settings, a backup, the logbook");
}

#[test]
fn polls_and_records_positions() {
    // The shaft turns one turn, or 4096 steps, per second.
    let mut desk = Desk::connected("?rpm=60");
    desk.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    let positions = |desk: &Desk| {
        let recorder = desk.shown().recorder();
        let history = recorder.history(&recorder.series()[0]).unwrap();
        let samples = history.indices().filter_map(|index| history.sample(0, index));
        samples.map(|sample| (sample.time.as_nanoseconds(), sample.value)).collect::<Vec<_>>()
    };
    desk.until("it has been recorded", |desk| positions(desk).len() > 30);
    desk.command(DeviceCommand::Poll(None));
    let whole = |value| if let Value::Whole(steps) = value { steps } else { panic!("{value:?}") };
    let positions: Vec<(i64, i64)> = positions(&desk).into_iter().map(|(time, value)| (time, whole(value))).collect();
    // The position was sampled before it was received.
    assert!(positions.iter().all(|(time, steps)| *steps as f64 <= *time as f64 * 1e-9 * 4096.0 + 1.0));
    assert!(positions.is_sorted() && positions.first().unwrap().1 < positions.last().unwrap().1, "{positions:?}");
}

#[test]
fn edit_write_and_restore() {
    let mut desk = Desk::connected("");
    desk.set(0, 100);
    desk.set(2, 9);
    assert_eq!((desk.encoder().wanted(), desk.shown().edit_count()), (Some([100, 3, 9, 65535]), 2));
    desk.command(DeviceCommand::Undo);
    assert_eq!((desk.encoder().wanted(), desk.shown().edit_count()), (Some([100, 3, 0, 65535]), 1));
    desk.command(DeviceCommand::Redo);
    desk.set(2, 0);
    assert_eq!(desk.shown().edit_count(), 1, "what is wanted as it is, is no edit");
    desk.command(DeviceCommand::Review);
    desk.until_stage(|stage| matches!(stage, Stage::Ready(_)));
    let lines = desk.shown().review_sheet().unwrap().lines;
    let words: Vec<String> = lines.iter().flat_map(|line| line.texts().map(|text| text.terminal_text())).collect();
    assert_eq!(words, ["zero", "0", "100"]);

    let Stage::Done { backup: Some(backup), .. } = desk.write() else { panic!("no backup") };
    desk.until_ready();
    let text = std::fs::read_to_string(&backup).unwrap();
    let before = ProfileDocument::parse(&text, program().studio.formats).unwrap().body;
    assert_eq!(before, Body::new(NovoProfile { serial: 1001, values: FACTORY_VALUES }));
    assert_eq!(desk.encoder().read().unwrap().values, [100, 3, 0, 65535], "read back");
    assert!(!desk.shown().is_dirty() && !desk.shown().can_undo());
    // The shaft is at 0, which is now reported as 100 steps below 65536.
    desk.command(DeviceCommand::ReadPosition);
    desk.until("the position from the new zero", |desk| desk.encoder().last.is_some_and(|own| own.1 == 65436));

    desk.review(ReviewAction::Close);
    desk.until("the backup is listed", |desk| matches!(desk.shown().backups(), Some(Ok(all)) if all.len() == 1));
    desk.command(DeviceCommand::Restore(backup));
    desk.write();
    desk.until_ready();
    assert_eq!(desk.encoder().read().unwrap().values, FACTORY_VALUES);
    assert_eq!(desk.notice_ids(Severity::Error), [""; 0]);
}

#[test]
fn rejected_value_stays_edited() {
    // The second of the two values to write, at 10h and 12h, cannot be changed.
    let mut desk = Desk::connected("?stuck=0x12");
    desk.set(0, 100);
    desk.set(2, 9);
    desk.command(DeviceCommand::Review);
    let Stage::Ready(plan) = desk.until_stage(|stage| matches!(stage, Stage::Ready(_))) else { panic!("no plan") };
    desk.review(ReviewAction::Write(plan));
    desk.until_stage(|stage| matches!(stage, Stage::Failed { begun: true, done: 1, .. }));
    desk.until("it is read again", |desk| desk.shown().is_ready() && desk.shown().edit_count() == 1);
    assert_eq!(desk.encoder().read().unwrap().values, [100, 3, 0, 65535]);
    desk.until("it is listed", |desk| matches!(desk.shown().logged_writes(), Some(Ok(all)) if all.len() == 1));
    let writes = desk.shown().logged_writes().unwrap().as_ref().unwrap();
    let spent = writes.iter().map(|write| write.conclusion.as_ref().unwrap().cycles_spent);
    assert_eq!(spent.collect::<Vec<_>>(), [2]);
}

#[test]
fn restores_other_encoder_only_on_request() {
    let mut desk = Desk::connected("");
    let (id, path) = (desk.shown().id(), desk.path("novo.ron"));
    desk.command(DeviceCommand::AskSave);
    let question = desk.studio.take_file_question().unwrap();
    desk.studio.handle_action(StudioAction::Chosen(question, path.clone()));
    desk.until("it is saved", |_| path.exists());
    desk.studio.handle_action(StudioAction::Open(path.clone()));
    desk.until("it is open", |desk| desk.studio.devices().len() == 2);
    let profile = desk.shown().id();
    desk.set(1, 7);
    desk.studio.handle_action(StudioAction::Save(profile));
    desk.until("it is saved again", |_| std::fs::read_to_string(&path).unwrap().contains("filter: 7"));
    // The profile is written into the encoder from which it was read, so there is one difference.
    desk.studio.handle_action(StudioAction::Command(profile, DeviceCommand::WriteInto(id)));
    desk.until("the device is shown", |desk| desk.shown().id() == id);
    desk.write();
    assert_eq!(desk.encoder().read().unwrap().serial, 1001);
    desk.until("it is read back", |desk| desk.encoder().read().unwrap().values == [0, 7, 0, 65535]);
    desk.until_ready();
    desk.review(ReviewAction::Close);
    // Another encoder requires a permission.
    desk.studio.handle_action(StudioAction::CloseSession(id));
    desk.open("?serial=5");
    let other = desk.shown().id();
    desk.studio.handle_action(StudioAction::Command(profile, DeviceCommand::WriteInto(other)));
    desk.until_stage(|stage| matches!(stage, Stage::Failed { begun: false, .. }));
    assert_eq!(desk.shown().review_sheet().unwrap().toggles.len(), 1);
}

#[test]
fn rejects_payload_of_another_kind() {
    let mut desk = Desk::connected("");
    let id = desk.shown().id();
    desk.studio.handle_action(StudioAction::device(id, Interbus::Check));
    assert_eq!(desk.notice_ids(Severity::Error), ["session.wrong_kind"]);
    desk.studio.handle_action(StudioAction::OpenVirtual);
    desk.until_ready();
    desk.set(0, 1);
    assert_eq!(desk.shown().edit_count(), 1);
}

/// The window of the program under test.
struct Shown(Window);

impl App for Shown {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut Frame) {
        self.0.draw(ui);
    }
}

#[test]
fn window_shows_tab_and_values() {
    let mut desk = Desk::connected("?rpm=60");
    desk.set(0, 4321);
    desk.command(DeviceCommand::Poll(Some(Duration::ZERO)));
    desk.until("something is recorded", |desk| desk.shown().recorder().recorded_span().is_some());
    desk.command(DeviceCommand::Poll(None));
    let Desk { studio, folder: _folder } = desk;
    let mut harness = Harness::builder().with_size([1200.0, 800.0]).build_eframe(|cc| {
        install_fonts(&cc.egui_ctx);
        Shown(Window::new(studio, ThemeData::built_in().unwrap(), program().tabs))
    });
    (0..4).for_each(|_| harness.step());
    assert!(harness.query_all_by_label("NOVO").next().is_some(), "the navigation has its tab");
    let chart = Text::new("recorder.chart").to_string_in(Language::English);
    assert!(harness.query_by_role_and_label(Role::Image, &chart).is_some(), "the plot has its positions");
    let position = harness.state().0.studio().selected_model::<Encoder>().unwrap().last.unwrap().1.to_string();
    assert!(harness.query_all_by_label(&position).next().is_some(), "the newest stands large");
    assert!(harness.query_all_by(|node| node.value().as_deref() == Some("4321")).next().is_some());
}
