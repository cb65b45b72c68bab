//! The behaviour common to every kind of device, with the same texts for all: edits are kept, writes end before
//! anything closes, and every link accepted by the connection dialog leads to its device.

use crate::tabs::Tabs as _;
use std::path::Path;

use crate::tabs::with_novo;
use encoder_studio::app::connect::form::FormModel;
use encoder_studio::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog};
use encoder_studio::app::review::{Permit, Stage};
use encoder_studio::app::session::{Phase, Source};
use encoder_studio::app::{Action, AnyDevice, DeviceCommand, JobState, Language, ReviewAction, Severity, Studio, Tab};
use encoder_studio::devices::biss::state::BissAction as Biss;
use encoder_studio::devices::hiperdrive::protocol::ParameterNumber;
use encoder_studio::devices::hiperdrive::state::{Edit as Set, HiperdriveAction as Hiperdrive};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::devices::interbus::protocol::ProgramNumber;
use encoder_studio::devices::interbus::state::{Edit, InterbusAction as Interbus};
use encoder_studio::devices::{biss, hiperdrive, hiperface, interbus, ssi};
use encoder_studio::profile::{Body, Comparison, PlanId, ProfileDocument};

use crate::novo::state::Action as Novo;
use crate::support::{ADAPTER, DRIVE, Desk, GATE, KIT, NOVO_PORT, PORT};
use crate::wire::Wire;

/// A kind of device connected by a cable.
pub(crate) struct Case {
    pub(crate) tab: Tab,
    scheme: &'static str,
    port: &'static str,
    /// The command byte that stores the edits.
    writes: u8,
    /// A command byte with which reading everything begins.
    reads: u8,
    /// Settings of another encoder, which has a different serial number.
    other: &'static str,
}

pub(crate) const CASES: [Case; 5] = [
    Case {
        tab: crate::tabs::HIPERFACE,
        scheme: "serial",
        port: PORT,
        writes: 0x4B,
        reads: 0x52,
        other: "serial=OTHER0001",
    },
    Case { tab: crate::tabs::BISS, scheme: "serial", port: KIT, writes: 0x02, reads: 0x01, other: "serial=42" },
    // The preset is a parameter of code 4, in bits 28 to 25 of its word; function 4 reads a word.
    Case { tab: crate::tabs::INTERBUS, scheme: "modbus", port: GATE, writes: 0x08, reads: 4, other: "serial=42" },
    NOVO,
    // Services that set and get an attribute.
    Case { tab: crate::tabs::HIPERDRIVE, scheme: "enip", port: DRIVE, writes: 0x10, reads: 0x0E, other: "serial=42" },
];

/// The test kind, which stands for all kinds if one is enough.
pub(crate) const NOVO: Case =
    Case { tab: crate::tabs::NOVEL, scheme: "serial", port: NOVO_PORT, writes: b'W', reads: b'R', other: "serial=42" };

impl Case {
    /// Returns a studio whose encoder is connected and has been read.
    pub(crate) fn desk(&self) -> Desk {
        let mut desk = Desk::with_novo();
        self.connect(&mut desk);
        desk
    }

    /// Drops the studio without closing it, and starts it again with the same encoder.
    fn crash(&self, desk: Desk) -> Desk {
        let mut desk = desk.crash();
        self.connect(&mut desk);
        desk
    }

    fn connect(&self, desk: &mut Desk) {
        desk.act(Action::ShowTab(self.tab));
        desk.open(&format!("{}:{}", self.scheme, self.port));
        until_ready(desk);
        self.confirm_standstill(desk);
        if self.tab == crate::tabs::INTERBUS {
            command(desk, DeviceCommand::Read);
            desk.until("it is read", |studio| studio.interbus().unwrap().survey.is_some());
            until_ready(desk);
        }
    }

    /// Reconnects, after which it is no longer known whether the machine is at standstill.
    fn reconnect(&self, desk: &mut Desk) {
        command(desk, DeviceCommand::Reconnect);
        until_ready(desk);
        self.confirm_standstill(desk);
    }

    /// Confirms the standstill, if the program asks.
    fn confirm_standstill(&self, desk: &mut Desk) {
        if self.tab == crate::tabs::INTERBUS {
            let id = shown(&desk.studio).unwrap().id();
            desk.act(Action::device(id, Interbus::ConfirmStandstill(true)));
        }
    }

    /// Holds the line at the store command and starts the reviewed write.
    fn write_until_held(&self, desk: &mut Desk) {
        let plan = planned(desk);
        let wire = self.wire(desk);
        wire.hold_at(self.writes, 1);
        review(desk, ReviewAction::Write(plan));
        wire.wait_until_held();
    }

    fn wire(&self, desk: &Desk) -> std::sync::Arc<Wire> {
        desk.outside.wire(self.port).clone()
    }

    /// Edits the first bytes that can be edited.
    pub(crate) fn edit(&self, desk: &mut Desk, bytes: &[u8]) {
        let id = shown(&desk.studio).unwrap().id();
        match self.tab {
            crate::tabs::BISS => {
                let start = "0x24:0x00".parse().unwrap();
                if desk.studio.biss().unwrap().memory.read(start).is_none() {
                    desk.act(Action::device(id, Biss::ReadBank(Some(0x24))));
                    until_ready(desk);
                }
                desk.act(Action::device(id, Biss::Put { start, bytes: bytes.to_vec() }));
            }
            crate::tabs::INTERBUS => {
                let edits = [Edit::Preset, Edit::ZeroShift].into_iter().zip(bytes);
                for (edit, byte) in edits {
                    desk.act(Action::device(id, Interbus::Edit(Box::new(edit(u32::from(*byte))))));
                }
            }
            crate::tabs::HIPERDRIVE => {
                // Free registers.
                let edits = [24, 26].into_iter().filter_map(ParameterNumber::new).zip(bytes);
                for (number, byte) in edits {
                    let edit = Box::new(Set::Set(number, i64::from(*byte)));
                    desk.act(Action::device(id, Hiperdrive::Edit(edit)));
                }
            }
            crate::tabs::NOVEL => {
                for (item, byte) in (1..).zip(bytes) {
                    desk.act(Action::device(id, Novo::Set(item, u16::from(*byte))));
                }
            }
            _ => desk.act(Action::device(id, Hiperface::Put { field: 0, address: 0, bytes: bytes.to_vec() })),
        }
        assert_eq!(shown(&desk.studio).unwrap().edit_count(), bytes.len());
    }
}

impl Case {
    /// Saves the content of the device as a profile.
    pub(crate) fn save(&self, desk: &mut Desk, path: &Path) {
        self.save_via_question(desk, path);
        desk.until("it is saved", |_| path.exists());
    }

    /// Reads the data that are not read when connecting.
    pub(crate) fn read_all(&self, desk: &mut Desk) {
        let id = shown(&desk.studio).unwrap().id();
        match self.tab {
            crate::tabs::BISS => {
                let description = desk.studio.biss().unwrap().description.clone().unwrap();
                for area in description.areas() {
                    desk.act(Action::device(id, Biss::ReadArea(area.first)));
                    until_ready(desk);
                }
            }
            crate::tabs::INTERBUS => {
                desk.act(Action::device(id, Interbus::ReadPrograms(ProgramNumber::all().collect())));
                until_ready(desk);
            }
            _ => {}
        }
    }

    fn save_via_question(&self, desk: &mut Desk, path: &Path) {
        command(desk, DeviceCommand::AskSave);
        let question = desk.studio.take_file_question().unwrap();
        desk.act(Action::Chosen(question, path.to_path_buf()));
    }

    /// Returns a profile entry that specifies another type of device, or `None` if there is only one type.
    fn other_type(&self) -> Option<(&'static str, &'static str)> {
        Some(match self.tab {
            // There is one type of it.
            crate::tabs::NOVEL => return None,
            crate::tabs::BISS => ("device_id", "\"09 09 09 09 09 09\""),
            crate::tabs::INTERBUS => ("flags", "0"),
            crate::tabs::HIPERDRIVE => ("category", "\"HIPERDRIVE HUB-4\""),
            _ => ("encoder_type", "0x32"),
        })
    }
}

fn compared(one: &Body, other: &Body) -> Comparison {
    one.compare(other).unwrap()
}

pub(crate) fn shown(studio: &Studio) -> Option<&AnyDevice> {
    studio.selected_device()
}

pub(crate) fn command(desk: &mut Desk, command: DeviceCommand) {
    let action = shown(&desk.studio).unwrap().command(command);
    desk.act(action);
}

pub(crate) fn review(desk: &mut Desk, action: ReviewAction) {
    let id = shown(&desk.studio).unwrap().id();
    desk.act(Action::Review(id, action));
}

#[track_caller]
pub(crate) fn until_ready(desk: &mut Desk) {
    desk.until("it is read", |studio| {
        // There are no backups of values that are never written, nor of those that must not be disturbed yet.
        let has_word = |own: &AnyDevice| {
            let ssi = own.get::<encoder_studio::devices::ssi::state::Encoder>().is_some_and(|own| own.last().is_some());
            ssi || own
                .get::<encoder_studio::devices::interbus::state::Encoder>()
                .is_some_and(|own| own.record.last().is_some())
        };
        let is_read = |own: &AnyDevice| own.backups().is_some() || has_word(own);
        let is_ready = |own: &AnyDevice| own.is_ready() && *own.phase() == Phase::Connected && is_read(own);
        shown(studio).is_some_and(is_ready)
    });
    desk.settle();
}

#[track_caller]
fn wait_for_connection_loss(desk: &mut Desk) {
    desk.until("it is lost", |studio| matches!(shown(studio).unwrap().phase(), Phase::Lost(_)));
}

#[track_caller]
pub(crate) fn until_stage(desk: &mut Desk, wanted: impl Fn(&Stage) -> bool) {
    desk.until("the review is there", |studio| {
        let device = shown(studio).unwrap();
        device.review_sheet().is_some_and(|sheet| wanted(&sheet.stage)) && !device.is_writing()
    });
}

/// Reviews the edits and returns the plan.
#[track_caller]
fn planned(desk: &mut Desk) -> PlanId {
    command(desk, DeviceCommand::Review);
    until_stage(desk, |stage| matches!(stage, Stage::Ready(_)));
    until_ready(desk);
    let Stage::Ready(plan) = shown(&desk.studio).unwrap().review_sheet().unwrap().stage else { panic!("no plan") };
    plan
}

#[track_caller]
pub(crate) fn write(desk: &mut Desk) {
    let plan = planned(desk);
    review(desk, ReviewAction::Write(plan));
    until_stage(desk, |stage| matches!(stage, Stage::Done { .. }));
    until_ready(desk);
    assert!(!shown(&desk.studio).unwrap().is_dirty());
}

/// Returns the number of drafts on disk.
fn drafts(desk: &Desk) -> usize {
    let kinds = std::fs::read_dir(desk.outside.path("data/drafts")).into_iter().flatten();
    let files = kinds.flat_map(|kind| std::fs::read_dir(kind.unwrap().path()).unwrap());
    files.filter(|file| file.as_ref().unwrap().path().extension().is_some_and(|own| own == "ron")).count()
}

#[track_caller]
fn until_kept(desk: &mut Desk) {
    let folder = desk.outside.path("data/drafts");
    desk.until("the edits are kept", |studio| folder.exists() && shown(studio).unwrap().is_draft_kept());
    assert_eq!(drafts(desk), 1);
}

#[test]
fn edits_survive_crash() {
    for case in CASES {
        let mut desk = case.desk();
        case.edit(&mut desk, &[0x5A, 0x5B]);
        until_kept(&mut desk);
        let mut desk = case.crash(desk);
        desk.until("the edits are back", |studio| shown(studio).unwrap().edit_count() == 2);
        assert_eq!(desk.notice_ids(Severity::Warning), ["session.draft_back"]);
        write(&mut desk);
        desk.settle();
        assert_eq!(drafts(&desk), 0);
        let desk = case.crash(desk);
        assert!(!shown(&desk.studio).unwrap().is_dirty() && desk.notice_ids(Severity::Warning).is_empty());
    }
}

#[test]
fn edits_survive_pulled_cable() {
    for case in CASES {
        let mut desk = case.desk();
        let wire = case.wire(&desk);
        case.edit(&mut desk, &[0x5A]);
        until_kept(&mut desk);
        wire.unplug();
        wait_for_connection_loss(&mut desk);
        assert_eq!(desk.notice_ids(Severity::Error), ["link.lost"], "once");
        case.edit(&mut desk, &[0x5A, 0x5B]);
        command(&mut desk, DeviceCommand::Review);
        assert_eq!(desk.notice_count("session.not_connected"), 1);
        command(&mut desk, DeviceCommand::Reconnect);
        wait_for_connection_loss(&mut desk);
        wire.plug();
        case.reconnect(&mut desk);
        assert_eq!(shown(&desk.studio).unwrap().edit_count(), 2);
        // Another device is now on the same adapter, without any notice to the program.
        wire.exchange(case.other);
        command(&mut desk, DeviceCommand::Review);
        desk.until("it is noticed", |studio| !shown(studio).unwrap().is_dirty());
        until_ready(&mut desk);
        assert_eq!(desk.notice_count("session.other_encoder"), 1);
        assert!(!shown(&desk.studio).unwrap().is_reviewing());
        wire.exchange("");
        command(&mut desk, DeviceCommand::Read);
        desk.until("the edits are back", |studio| shown(studio).unwrap().edit_count() == 2);
        until_ready(&mut desk);
        write(&mut desk);
    }
}

#[test]
fn cable_pulled_during_write_keeps_edits() {
    for case in CASES {
        let mut desk = case.desk();
        let wire = case.wire(&desk);
        case.edit(&mut desk, &[0x5A]);
        case.write_until_held(&mut desk);
        wire.unplug();
        wire.release();
        until_stage(&mut desk, |stage| matches!(stage, Stage::Failed { begun: true, .. }));
        wait_for_connection_loss(&mut desk);
        assert_eq!(shown(&desk.studio).unwrap().edit_count(), 1);
        review(&mut desk, ReviewAction::Close);
        wire.plug();
        case.reconnect(&mut desk);
        assert_eq!(shown(&desk.studio).unwrap().edit_count(), 1);
        write(&mut desk);
    }
}

#[test]
fn closing_with_edits_asks_first() {
    for case in CASES {
        let mut desk = case.desk();
        case.edit(&mut desk, &[0x5A]);
        desk.settle();
        let asked = |desk: &Desk| desk.studio.question.as_ref().unwrap().text.id();
        desk.act(Action::Close);
        assert_eq!(asked(&desk), "question.edits");
        desk.act(Action::Escape);
        assert!(desk.studio.question.is_none() && !desk.studio.can_close());
        let id = shown(&desk.studio).unwrap().id();
        desk.act(Action::CloseSession(id));
        assert_eq!(asked(&desk), "question.session_edits");
        desk.act(Action::Confirm);
        assert!(desk.studio.devices().is_empty());
        case.connect(&mut desk);
        desk.until("the edits are back", |studio| shown(studio).unwrap().edit_count() == 1);
        desk.act(Action::Close);
        desk.act(Action::Confirm);
        desk.until("it may close", |studio| studio.can_close());
    }
}

#[test]
fn write_ends_safely_before_closing() {
    for case in CASES {
        let mut desk = case.desk();
        let wire = case.wire(&desk);
        case.edit(&mut desk, &[0x5A]);
        case.write_until_held(&mut desk);
        desk.act(Action::Close);
        assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.busy");
        desk.act(Action::Confirm);
        desk.settle();
        assert!(!desk.studio.can_close(), "it still writes");
        wire.release();
        desk.until("it may close", |studio| studio.can_close());
        let ends: Vec<&JobState> = desk.studio.services.jobs().map(|job| &job.end).collect();
        assert!(matches!(ends.last().unwrap(), JobState::Cancelled | JobState::Done), "{ends:?}");
    }
}

#[test]
fn escape_stops_job_before_closing() {
    for case in CASES {
        let mut desk = case.desk();
        let wire = case.wire(&desk);
        wire.hold_at(case.reads, 1);
        command(&mut desk, DeviceCommand::Read);
        desk.connect(Connect::Open);
        wire.wait_until_held();
        desk.act(Action::Escape);
        assert!(desk.studio.connect.is_some());
        wire.release();
        desk.until("it has stopped", |studio| shown(studio).unwrap().is_ready());
        assert_eq!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Cancelled);
        desk.act(Action::Escape);
        assert!(desk.studio.connect.is_none());
    }
}

/// Returns the action that accepts the form without changes.
fn edited<F: FormModel>(dialog: &Dialog) -> Connect {
    Connect::edit_form(dialog.form_as::<F>().unwrap().clone())
}

#[test]
fn typed_and_form_links_open_device() {
    let links = [
        (crate::tabs::HIPERFACE, "sim:".to_owned()),
        (crate::tabs::HIPERFACE, format!("serial:{PORT}")),
        (crate::tabs::HIPERFACE, "tcp:moxa:4001".to_owned()),
        (crate::tabs::BISS, "sim:".to_owned()),
        (crate::tabs::BISS, "sim:?bridge=on".to_owned()),
        (crate::tabs::BISS, format!("serial:{KIT}?order=low-first")),
        (crate::tabs::BISS, "tcp:moxa:4002".to_owned()),
        (crate::tabs::BISS, format!("bridge:{ADAPTER}?clock=2000000")),
        (crate::tabs::BISS, "bridge:tcp:adapter:5000".to_owned()),
        (crate::tabs::SSI, "sim:".to_owned()),
        (crate::tabs::SSI, "sim:?ssi=ahm36,code=gray&rpm=6".to_owned()),
        (crate::tabs::INTERBUS, "sim:?rpm=6&cams=demo".to_owned()),
        (crate::tabs::INTERBUS, format!("modbus:{GATE}")),
        (crate::tabs::INTERBUS, format!("modbus:{GATE}?unit=1&handshake=500")),
        (crate::tabs::HIPERDRIVE, "sim:".to_owned()),
        (crate::tabs::HIPERDRIVE, "sim:?hub=4&drives=1,0,1".to_owned()),
        (crate::tabs::HIPERDRIVE, format!("enip:{DRIVE}")),
        (crate::tabs::HIPERDRIVE, format!("enip:{DRIVE}?rpi=20&order=big")),
    ];
    let mut desk = Desk::fresh("");
    for (tab, link) in links {
        for typed in [true, false] {
            desk.act(Action::ShowTab(tab));
            desk.connect(Connect::Open);
            desk.connect(Connect::Use(link.clone()));
            let dialog = desk.studio.connect.as_ref().unwrap();
            if !typed {
                let form = match tab {
                    crate::tabs::BISS => edited::<biss::state::BissForm>(dialog),
                    crate::tabs::SSI => edited::<ssi::state::SsiForm>(dialog),
                    crate::tabs::INTERBUS => edited::<interbus::state::InterbusForm>(dialog),
                    crate::tabs::HIPERDRIVE => edited::<hiperdrive::state::HiperdriveForm>(dialog),
                    _ => edited::<hiperface::state::LinkForm>(dialog),
                };
                desk.connect(form);
                assert_eq!(desk.studio.connect.as_ref().unwrap().typed_link(), link);
            }
            desk.connect(Connect::Connect);
            assert!(desk.studio.connect.is_none(), "{link}");
            until_ready(&mut desk);
            let device = shown(&desk.studio).unwrap();
            assert_eq!((device.tab(), device.source()), (tab, &Source::Link(link.parse().unwrap())));
            let id = device.id();
            desk.act(Action::CloseSession(id));
        }
        assert!(desk.notice_ids(Severity::Warning).is_empty(), "{link}");
    }
}

/// A profile of another type with the same serial number is rejected unless the user permits it explicitly. The review
/// then shows both types (issue 22.9).
#[test]
fn other_type_needs_permission() {
    for case in CASES {
        let Some((entry, value)) = case.other_type() else { continue };
        let mut desk = case.desk();
        let path = desk.outside.path("own.ron");
        case.save(&mut desk, &path);
        until_ready(&mut desk);
        let text = std::fs::read_to_string(&path).unwrap();
        let old = text.lines().find(|line| line.trim().starts_with(&format!("{entry}: "))).unwrap();
        std::fs::write(&path, text.replacen(old, &format!("        {entry}: {value},"), 1)).unwrap();
        command(&mut desk, DeviceCommand::Restore(path));
        until_stage(&mut desk, |stage| matches!(stage, Stage::Failed { .. }));
        until_ready(&mut desk);
        let sheet = shown(&desk.studio).unwrap().review_sheet().unwrap();
        let Stage::Failed { texts, .. } = &sheet.stage else { panic!() };
        assert!(texts[0].to_string_in(Language::English).contains("another type of device"), "{texts:?}");
        assert!(sheet.toggles.iter().any(|own| own.permit == Permit::TypeMismatch && !own.is_on));
        review(&mut desk, ReviewAction::Toggle(Permit::TypeMismatch));
        until_stage(&mut desk, |stage| matches!(stage, Stage::Ready(_) | Stage::Nothing));
        let warnings = shown(&desk.studio).unwrap().review_sheet().unwrap().warnings;
        let named = ["review.other_type", "biss_review.other_kind", "ib_review.other_type", "hd_review.other_kind"];
        let text = warnings.iter().find(|own| named.contains(&own.id())).unwrap();
        crate::texts::check(text);
    }
}

/// Data that were read can still be saved after the connection is lost. A profile needs all data: if some are missing,
/// they are named and nothing is saved (issue 22.14).
#[test]
fn saves_values_after_line_loss() {
    for case in CASES {
        let mut desk = case.desk();
        // Data that are not read on connection.
        let missing = match case.tab {
            crate::tabs::BISS => Some("OEM"),
            crate::tabs::INTERBUS => Some("cam program 8"),
            _ => None,
        };
        let whole = desk.outside.path("whole.ron");
        for all in [false, true] {
            if all {
                case.read_all(&mut desk);
                case.save(&mut desk, &whole);
                until_ready(&mut desk);
            }
            case.edit(&mut desk, &[0x5A]);
            case.wire(&desk).unplug();
            wait_for_connection_loss(&mut desk);
            assert!(shown(&desk.studio).unwrap().is_savable());
            let path = desk.outside.path(&format!("lost-{all}.ron"));
            // The loss of the connection may be reported again meanwhile.
            let told = |studio: &Studio, id: &str| {
                let mut notices = studio.services.log.notices();
                let own = notices.rfind(|notice| notice.texts.iter().any(|text| text.id() == id));
                own.map(|notice| notice.texts.clone())
            };
            case.save_via_question(&mut desk, &path);
            match missing.filter(|_| !all) {
                Some(missing) => {
                    desk.until("it is refused", |studio| told(studio, "session.not_all_read").is_some());
                    let texts = told(&desk.studio, "session.not_all_read").unwrap();
                    assert!(texts[0].to_string_in(Language::English).contains(missing), "{texts:?}");
                    crate::texts::check(&texts[0]);
                    desk.settle();
                    assert!(!path.exists());
                }
                None => {
                    let is_saved = |studio: &Studio| path.exists() && told(studio, "session.saved_as_read").is_some();
                    desk.until("it is saved", is_saved);
                    let texts = told(&desk.studio, "session.saved_as_read").unwrap();
                    assert!(texts.iter().any(|text| text.id() == "session.saved_without"), "{texts:?}");
                    let read = |path: &Path| {
                        ProfileDocument::parse(&std::fs::read_to_string(path).unwrap(), with_novo().studio.formats)
                            .unwrap()
                    };
                    let lost = read(&path);
                    assert!(lost.note.is_some_and(|note| note.contains("did not answer")));
                    if all {
                        let comparison = compared(&read(&whole).body, &lost.body);
                        assert!(comparison.compared > 0 && comparison.differences().is_empty(), "{:?}", case.tab);
                        assert!(comparison.one_sided_items().is_empty(), "{:?}", comparison.one_sided_items());
                    }
                }
            }
            command(&mut desk, DeviceCommand::RevertAll);
            case.wire(&desk).plug();
            case.reconnect(&mut desk);
            desk.settle();
        }
    }
}
