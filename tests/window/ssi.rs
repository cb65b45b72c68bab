//! Tests of the SSI tab through actions: layout design, an encoder on the virtual adapter, layout search.

use crate::tabs::Tabs as _;
use std::time::Duration;

use encoder_studio::app::session::{Phase, Source};
use encoder_studio::app::{Action, DeviceCommand, FileQuestion, Language, Severity};
use encoder_studio::devices::ssi::procedures::check::Verdict;
use encoder_studio::devices::ssi::protocol::{Code, LayoutProposal, Location, Range, UncertaintyReason};
use encoder_studio::devices::ssi::state::strip::Handle;
use encoder_studio::devices::ssi::state::{
    Edit, Encoder, Entry, ExportFormat, Field, FieldInput, SearchState, SsiAction as Ssi, TrialInput,
};

use crate::support::Desk;

/// Starts the application and shows the SSI tab without a connection.
fn layout() -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::SSI));
    desk.settle();
    desk
}

fn connected(link: &str) -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::SSI));
    desk.open(link);
    desk.until("the adapter has told who it is", |studio| {
        studio.ssi().is_some_and(|own| own.identity.is_some() && own.session.is_ready() && own.last().is_some())
    });
    desk
}

fn encoder(desk: &Desk) -> &Encoder {
    desk.studio.ssi().unwrap()
}

fn command(desk: &mut Desk, command: DeviceCommand) {
    let id = encoder(desk).session.id;
    desk.act(Action::Command(id, command));
}

fn act(desk: &mut Desk, action: Ssi) {
    let id = encoder(desk).session.id;
    desk.act(Action::device(id, action));
}

fn edit(desk: &mut Desk, edit: Edit) {
    act(desk, Ssi::Edit(Box::new(edit)));
}

fn wish(desk: &mut Desk, wish: DeviceCommand) {
    let action = desk.studio.selected_device().unwrap().command(wish);
    desk.act(action);
}

fn field(desk: &Desk, wanted: Field) -> Option<Entry> {
    let form = encoder(desk).designer.form_groups();
    form.into_iter().flat_map(|group| group.rows).find(|row| row.field == wanted).map(|row| row.entry)
}

#[test]
fn layout_needs_no_device() {
    let mut desk = layout();
    let own = encoder(&desk);
    assert!(matches!(own.session.source, Source::New { .. }));
    assert_eq!((own.session.phase.clone(), own.is_dirty()), (Phase::Offline, false));
    assert_eq!(own.designer.family().unwrap().key, "ahm36");
    // An AHM36 with multiturn 123h and singleturn 2A5Bh, in binary and in Gray code (reference, section 8).
    act(&mut desk, Ssi::Try(TrialInput::Place(0x123, 0x2A5B)));
    assert_eq!(encoder(&desk).displayed_frame().frame, 0x091_D4B6);
    act(&mut desk, Ssi::Enter(Field::Code, FieldInput::Choice(1)));
    assert_eq!(encoder(&desk).design().profile.descriptor.code, Code::Gray);
    assert_eq!(encoder(&desk).displayed_frame().frame, 0x0D9_3EEC, "the position stays");
    act(&mut desk, Ssi::Try(TrialInput::Bits("000110110010011111011101100".to_owned())));
    assert_eq!(
        encoder(&desk).displayed_frame().place,
        Some((
            0x123 << 14 | 0x2A5B,
            Location::Shaft { turns: 0x123, steps: 0x2A5B, degrees: 10843.0 * 360.0 / 16384.0 }
        ))
    );
    // Every step can be undone.
    assert!(encoder(&desk).is_dirty());
    wish(&mut desk, DeviceCommand::Undo);
    assert!(!encoder(&desk).is_dirty());
    wish(&mut desk, DeviceCommand::Redo);
    assert_eq!(encoder(&desk).design().profile.descriptor.code, Code::Gray);
    wish(&mut desk, DeviceCommand::RevertAll);
    assert_eq!(encoder(&desk).design().profile.descriptor.code, Code::Binary);
    wish(&mut desk, DeviceCommand::Undo);
    assert_eq!(encoder(&desk).design().profile.descriptor.code, Code::Gray);
}

#[test]
fn impossible_layouts_change_nothing() {
    let mut desk = layout();
    let before = encoder(&desk).design().clone();
    let refused = |desk: &mut Desk, field, input, id: &str| {
        act(desk, Ssi::Enter(field, input));
        assert_eq!(encoder(desk).designer.problem().unwrap().id(), id);
    };
    refused(&mut desk, Field::Singleturn, FieldInput::Number(15), "ssi.refused");
    refused(&mut desk, Field::Singleturn, FieldInput::Number(300), "ssi_form.wrong");
    refused(&mut desk, Field::Preset, FieldInput::Number(1 << 26), "ssi.preset_range");
    edit(&mut desk, Edit::Family("atm61".to_owned()));
    assert_eq!(encoder(&desk).designer.problem().unwrap().id(), "ssi.no_family");
    edit(&mut desk, Edit::LinuxCnc("pos%24q".to_owned()));
    assert_eq!(encoder(&desk).designer.problem().unwrap().id(), "ssi.refused");
    act(&mut desk, Ssi::Try(TrialInput::Position(1 << 26)));
    assert_eq!(encoder(&desk).trial.problem().unwrap().id(), "ssi_trial.range");
    act(&mut desk, Ssi::Try(TrialInput::Bits("10102".to_owned())));
    assert_eq!(encoder(&desk).trial.problem().unwrap().id(), "ssi_trial.form");
    assert_eq!(*encoder(&desk).design(), before);
    // The message names both settings that exclude each other.
    edit(&mut desk, Edit::Family("ahs36".to_owned()));
    act(&mut desk, Ssi::Enter(Field::Clocks, FieldInput::Number(14)));
    let words = encoder(&desk).designer.problem().unwrap().terminal_text();
    assert!(words.contains("ERROR is on clock 15") && words.contains("14 clocks"), "{words}");
}

#[test]
fn custom_frame_can_return_to_family() {
    let mut desk = layout();
    edit(&mut desk, Edit::Family("atm60".to_owned()));
    assert!(encoder(&desk).design().settings.is_some());
    // The ATM60 has no frame with a bit before the position.
    let mut frame = encoder(&desk).design().profile.descriptor.clone();
    (frame.clocks, frame.area, frame.lead) = (26, 26, 1);
    edit(&mut desk, Edit::Frame(Box::new(frame)));
    assert!(encoder(&desk).design().settings.is_none());
    assert!(field(&desk, Field::Lead).is_some(), "everything can be set");
    act(&mut desk, Ssi::Enter(Field::Lead, FieldInput::Number(0)));
    let own = encoder(&desk).design();
    assert_eq!((own.profile.descriptor.clocks, own.settings.is_some()), (25, true));
    assert!(field(&desk, Field::Align).is_some() && field(&desk, Field::Lead).is_none());
    // Without a family, every part of the frame can be set.
    edit(&mut desk, Edit::Free);
    act(&mut desk, Ssi::AddErrorBit);
    act(&mut desk, Ssi::Enter(Field::Parity, FieldInput::Choice(1)));
    let own = &encoder(&desk).design().profile.descriptor;
    assert_eq!((own.clocks, own.errors[0].clock, own.parity.unwrap().clock), (27, 26, 27));
    act(&mut desk, Ssi::RemoveErrorBit(0));
    act(&mut desk, Ssi::Enter(Field::Repeat, FieldInput::Switch(true)));
    assert_eq!(encoder(&desk).design().profile.descriptor.clocks, 55, "27, a zero, and 27 once more");
    edit(&mut desk, Edit::LinuxCnc("err%1bpos%24ge".to_owned()));
    let own = &encoder(&desk).design().profile.descriptor;
    assert_eq!((own.code, own.range.bits(), own.errors.len()), (Code::Gray, Ok(24), 1));
}

#[test]
fn layout_survives_crash() {
    let mut desk = layout();
    act(&mut desk, Ssi::Enter(Field::Singleturn, FieldInput::Number(12)));
    wish(&mut desk, DeviceCommand::AskSave);
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question.suggested_path().unwrap().to_str(), Some("ahm36_st_12.ron"));
    let path = desk.outside.path("layout.ron");
    desk.act(Action::Chosen(question, path.clone()));
    desk.until("it is saved", |studio| studio.ssi().is_some_and(|own| !own.is_dirty()));
    assert!(!encoder(&desk).is_dirty() && matches!(encoder(&desk).session.source, Source::File { .. }));
    act(&mut desk, Ssi::Enter(Field::Code, FieldInput::Choice(1)));
    let drafts = desk.outside.path("data/drafts/ssi-files");
    desk.until("the draft is kept", |_| {
        std::fs::read_dir(&drafts).is_ok_and(|mut files| {
            files.any(|file| file.is_ok_and(|file| file.path().extension().is_some_and(|own| own == "ron")))
        })
    });
    desk.settle();
    let mut desk = desk.crash();
    desk.act(Action::Open(path));
    desk.until("the profile is open", |studio| studio.ssi().is_some_and(|own| own.is_dirty()));
    let own = &encoder(&desk).design().profile.descriptor;
    assert_eq!((own.range, own.code), (Range::Bits { multiturn: 12, singleturn: 12 }, Code::Gray));
}

/// The data sheet and the table are in the language of the window. C and structured text are programs, so they are not
/// translated. The terms for TM PosInput are those of its German manual.
#[test]
fn exports_use_window_language() {
    let mut desk = layout();
    act(&mut desk, Ssi::Enter(Field::Code, FieldInput::Choice(1)));
    let german = |format| encoder(&desk).designer.export(format, Language::German).unwrap();
    let sheet = german(ExportFormat::Sheet);
    for line in [
        "SSI-Einstellungen: ahm36,code=gray",
        "Telegrammlänge                  27 Bit",
        "Monoflopzeit (tm)               15 bis 25 µs (die Pause muss länger sein)",
        "  Codeart                         Gray",
        "  Bitnummer LSB der Position      1",
        "  :06 SSI coding                  1 (Gray)",
    ] {
        assert!(sheet.lines().any(|own| own == line), "{line}\n{sheet}");
    }
    for english in ["length:", "Frame", "the ", "lowest"] {
        assert!(!sheet.contains(english), "{english}\n{sheet}");
    }
    assert!(german(ExportFormat::Table).starts_with("Takt,Telegrammbit,Bedeutung\n1,26,MT11\n"));
    assert!(
        german(ExportFormat::Timing).contains("27 Takte, 67,50 µs") && german(ExportFormat::Timing).contains(">Daten<")
    );
    assert_eq!(german(ExportFormat::C), encoder(&desk).designer.export(ExportFormat::C, Language::English).unwrap());
}

#[test]
fn writes_every_export() {
    let mut desk = layout();
    for format in ExportFormat::ALL {
        act(&mut desk, Ssi::AskExport(format, Language::German));
        let question = desk.studio.take_file_question().unwrap();
        assert!(matches!(question, FileQuestion::OfDevice(_)));
        let path = desk.outside.path(&format!("export.{}", question.file_extensions()[0]));
        let _ = std::fs::remove_file(&path);
        desk.act(Action::Chosen(question, path.clone()));
        desk.until("it is written", |_| path.exists());
        assert_eq!(
            std::fs::read_to_string(path).unwrap(),
            encoder(&desk).designer.export(format, Language::German).unwrap()
        );
    }
    // The timing of a frame does not depend on a family: 27 clocks at 400 kHz take 67.5 µs.
    edit(&mut desk, Edit::Free);
    let picture = encoder(&desk).designer.export(ExportFormat::Timing, Language::English).unwrap();
    assert!(picture.contains("67.50 µs"), "{picture}");
    // Parts that a format cannot represent are reported.
    act(&mut desk, Ssi::Enter(Field::Code, FieldInput::Choice(2)));
    assert_eq!(
        encoder(&desk).designer.export(ExportFormat::LinuxCnc, Language::English).unwrap_err().id(),
        "ssi.lc_cannot"
    );
}

#[test]
fn plots_adapter_words_live() {
    let mut desk = connected("sim:?ssi=ahm36,code=gray&rpm=60");
    let own = encoder(&desk);
    assert_eq!(own.designer.family().unwrap().key, "ahm36", "what the virtual encoder sends");
    assert_eq!(own.identity.as_ref().unwrap().clock_settings.clocks, 27);
    command(&mut desk, DeviceCommand::Poll(Some(Duration::from_millis(1))));
    desk.until("words stream", |studio| studio.ssi().unwrap().record.position_count() > 500);
    let own = encoder(&desk);
    assert!(own.current_stream().is_some() && own.is_showing_live_frame());
    let decoded = own.last().unwrap().decoded.as_ref().unwrap();
    assert!(decoded.is_valid && decoded.findings.is_empty());
    // Another layout decodes the same words again.
    let before = own.record.position_count();
    act(&mut desk, Ssi::Enter(Field::Singleturn, FieldInput::Number(12)));
    assert!(encoder(&desk).record.position_count() >= before);
    desk.until("the layout does not fit", |studio| {
        studio.ssi().unwrap().record.finding_counts().finding_counts().iter().any(|noted| noted.is_active)
    });
    command(&mut desk, DeviceCommand::Poll(None));
}

#[test]
fn sends_changed_clock_count_to_adapter() {
    let mut desk = connected("sim:?ssi=atm60,code=gray&rpm=6");
    edit(&mut desk, Edit::Family("ahm36".to_owned()));
    desk.until("the adapter is told", |studio| {
        studio.ssi().unwrap().identity.as_ref().is_some_and(|own| own.clock_settings.clocks == 27)
    });
    act(&mut desk, Ssi::SetClocks(Some(30)));
    desk.until("the adapter is told", |studio| {
        studio.ssi().unwrap().identity.as_ref().is_some_and(|own| own.clock_settings.clocks == 30)
    });
    command(&mut desk, DeviceCommand::ReadPosition);
    desk.until("a word is read", |studio| studio.ssi().unwrap().last().is_some_and(|seen| seen.clocks == 30));
    assert!(encoder(&desk).last().unwrap().decoded.is_none(), "the layout has 27 clocks");
}

#[test]
fn adopts_layout_detected_live() {
    let mut desk = connected("sim:?ssi=afm60,code=gray&rpm=60");
    edit(&mut desk, Edit::Free);
    let clocks = encoder(&desk).clock_count();
    assert_eq!(clocks, 33);
    command(&mut desk, DeviceCommand::Poll(Some(Duration::from_millis(1))));
    desk.until("enough is read", |studio| studio.ssi().unwrap().record.count(33) >= 700);
    command(&mut desk, DeviceCommand::Poll(None));
    act(&mut desk, Ssi::Find);
    desk.until("it is found", |studio| matches!(studio.ssi().unwrap().search, SearchState::Found { .. }));
    let SearchState::Found { search, .. } = &encoder(&desk).search else { panic!() };
    // The shaft did not pass the end of the 4096 turns, so the result is uncertain. The number of remaining classes
    // depends on the angle by which the shaft has turned in the meantime.
    assert!(
        matches!(search.uncertainty, Some(UncertaintyReason::Open | UncertaintyReason::Close)),
        "{:?}",
        search.uncertainty
    );
    let is_afm60 = |member: &LayoutProposal| member.family.as_ref().is_some_and(|(key, _)| key == "afm60");
    let (class, member) = search
        .classes
        .iter()
        .enumerate()
        .find_map(|(class, own)| Some((class, own.members.iter().position(is_afm60)?)))
        .expect("the layout that the encoder has is among the classes");
    act(&mut desk, Ssi::Take(class, member));
    let own = encoder(&desk);
    assert_eq!(own.designer.family().unwrap().key, "afm60");
    assert_eq!(own.design().profile.descriptor.code, Code::Gray);
    // The frames can be saved and analysed again.
    let path = desk.outside.path("frames.txt");
    act(&mut desk, Ssi::SaveFrames(path.clone()));
    desk.until("they are written", |_| path.exists());
    act(&mut desk, Ssi::ForgetSearch);
    act(&mut desk, Ssi::FindIn(path));
    desk.until("it is found", |studio| matches!(studio.ssi().unwrap().search, SearchState::Found { .. }));
    let nowhere = desk.outside.path("nowhere.txt");
    act(&mut desk, Ssi::FindIn(nowhere));
    desk.until("it is told", |studio| matches!(studio.ssi().unwrap().search, SearchState::Failed(_)));
}

#[test]
fn uses_profile_layout_for_encoder() {
    let mut desk = connected("sim:?ssi=ahm36&rpm=6");
    let live = encoder(&desk).session.id;
    desk.act(Action::New(crate::tabs::SSI));
    edit(&mut desk, Edit::Family("ttk70".to_owned()));
    command(&mut desk, DeviceCommand::WriteInto(live));
    assert_eq!(encoder(&desk).session.id, live);
    assert_eq!(encoder(&desk).designer.family().unwrap().key, "ttk70");
    wish(&mut desk, DeviceCommand::Undo);
    assert_eq!(encoder(&desk).designer.family().unwrap().key, "ahm36");
    // Nothing is written to an SSI encoder, and a message says so.
    wish(&mut desk, DeviceCommand::Review);
    assert!(!desk.studio.selected_device().unwrap().is_reviewing());
}

#[test]
fn new_layouts_have_separate_names_and_drafts() {
    let mut desk = layout();
    edit(&mut desk, Edit::Family("ttk70".to_owned()));
    desk.act(Action::New(crate::tabs::SSI));
    edit(&mut desk, Edit::Family("kh53".to_owned()));
    desk.settle();
    assert_eq!(desk.studio.devices().iter().map(|own| own.name()).collect::<Vec<_>>(), ["layout.ron", "layout-2.ron"]);
    // After closing, the first name is free again, and the edits under that name return with it.
    for id in desk.studio.devices().iter().map(|own| own.id()).collect::<Vec<_>>() {
        desk.act(Action::CloseSession(id));
        desk.act(Action::Confirm);
    }
    for family in ["ttk70", "kh53"] {
        desk.act(Action::New(crate::tabs::SSI));
        desk.until("what was begun is back", |studio| {
            studio.ssi().unwrap().designer.family().is_some_and(|own| own.key == family)
        });
    }
}

#[test]
fn second_link_changes_reading_settings() {
    let mut desk = layout();
    let reading = |desk: &Desk| {
        let reading = &encoder(desk).design().profile.reading;
        (reading.clock_hz, reading.pause_us)
    };
    desk.open("bridge:/nowhere/tty?clock=500000");
    desk.settle();
    act(&mut desk, Ssi::Enter(Field::Pause, FieldInput::Number(90)));
    let id = encoder(&desk).session.id;
    assert_eq!(reading(&desk), (500_000, 90));
    desk.open("bridge:/nowhere/tty?clock=750000");
    desk.settle();
    assert_eq!((encoder(&desk).session.id, reading(&desk)), (id, (750_000, 90)), "what was set here stays");
}

#[test]
fn encoder_is_named_after_family() {
    let mut desk = connected("sim:?ssi=ahm36");
    let before = encoder(&desk).session.name();
    edit(&mut desk, Edit::Family("ttk70".to_owned()));
    let own = encoder(&desk);
    assert_eq!(own.session.name(), own.designer.family().unwrap().name);
    assert_ne!(own.session.name(), before);
}

#[test]
fn reports_adapter_without_ssi() {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::SSI));
    desk.open("sim:?version=2");
    desk.until("it is told", |studio| {
        studio.selected_device().is_some_and(|own| matches!(own.phase(), Phase::Silent(_) | Phase::Lost(_)))
    });
    let Phase::Silent(why) = desk.studio.selected_device().unwrap().phase() else { panic!() };
    assert_eq!(why.id(), "adapter.version");
}

#[test]
fn device_check_reports_faults() {
    let verdicts = |link: &str| {
        let mut desk = connected(link);
        act(&mut desk, Ssi::Check);
        desk.until("it is checked", |studio| studio.ssi().unwrap().check.is_some());
        encoder(&desk).check.as_ref().unwrap().iter().map(|line| line.verdict).collect::<Vec<_>>()
    };
    assert_eq!(verdicts("sim:?ssi=afs60"), [Verdict::Good; 6]);
    let high = verdicts("sim:?ssi=afs60&line=high");
    assert_eq!((high[0], high[2]), (Verdict::Good, Verdict::Bad));
}

#[test]
fn virtual_encoder_sends_edited_layout() {
    let mut desk = connected("sim:?ssi=afs60&rpm=6");
    assert_eq!(encoder(&desk).link_for_layout(), None);
    edit(&mut desk, Edit::Family("ahm36".to_owned()));
    let link = encoder(&desk).link_for_layout().unwrap().to_string();
    assert_eq!(link, "sim:?ssi=ahm36&rpm=6");
    act(&mut desk, Ssi::SendLayout);
    desk.until("it is connected again", |studio| {
        let own = studio.ssi().unwrap();
        own.session.is_ready() && own.link_for_layout().is_none() && own.identity.is_some()
    });
    command(&mut desk, DeviceCommand::ReadPosition);
    desk.until("a word fits", |studio| {
        let own = studio.ssi().unwrap();
        own.last()
            .is_some_and(|seen| seen.clocks == 27 && seen.decoded.as_ref().is_some_and(|own| own.findings.is_empty()))
    });
    assert_eq!(encoder(&desk).designer.family().unwrap().key, "ahm36", "the layout stays");
}

/// The error bit of a 12-bit AHS36 is on clock 15, or follows the position on clock 13 (reference, section 8).
#[test]
fn dragged_boundary_changes_family_settings() {
    let mut desk = layout();
    edit(&mut desk, Edit::Family("ahs36".to_owned()));
    act(&mut desk, Ssi::Move(Handle::StepsEnd, 12));
    let own = encoder(&desk).design();
    assert_eq!((own.profile.descriptor.errors[0].clock, own.profile.descriptor.clocks), (15, 15));
    assert_eq!(own.settings.as_ref().unwrap().emit("ahs36"), "ahs36,st=12");
    wish(&mut desk, DeviceCommand::Undo);
    act(&mut desk, Ssi::Enter(Field::Errors, FieldInput::Choice(1)));
    act(&mut desk, Ssi::Move(Handle::StepsEnd, 12));
    let own = encoder(&desk).design();
    assert_eq!(own.profile.descriptor.errors[0].clock, 13);
    assert_eq!(own.settings.as_ref().unwrap().emit("ahs36"), "ahs36,st=12,err=following");
}

#[test]
fn loads_user_families_and_reports_broken_ones() {
    let mut desk = Desk::fresh("");
    let folder = desk.outside.store().device_folder("ssi");
    std::fs::create_dir_all(&folder).unwrap();
    let source = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/devices/ssi/ahm36.ron");
    let text = std::fs::read_to_string(source).unwrap();
    std::fs::write(folder.join("mine.ron"), text.replace("key: \"ahm36\"", "key: \"mine\"")).unwrap();
    std::fs::write(folder.join("broken.ron"), "(key: ").unwrap();
    desk.act(Action::ShowTab(crate::tabs::SSI));
    desk.until("it is known", |studio| studio.ssi().unwrap().designer.families().find_by_key("mine").is_some());
    edit(&mut desk, Edit::Family("mine".to_owned()));
    assert_eq!(encoder(&desk).designer.family().unwrap().key, "mine");
    assert_eq!(desk.notice_ids(Severity::Warning), ["store.ssi_family"]);
}
