//! Tests of the connection dialog: the form rejects invalid values, and the search finds an encoder with unknown
//! settings.

use encoder_studio::app::DeviceCommand;
use std::sync::Arc;
use std::time::Duration;

use encoder_studio::app::connect::form::FormModel;
use encoder_studio::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog, is_missing};
use encoder_studio::app::session::{Phase, Source};
use encoder_studio::app::{Action, FileQuestion, Language};
use encoder_studio::devices::biss::state::BissLinkKind;
use encoder_studio::devices::hiperface::procedures::find::FindOptions;
use encoder_studio::devices::hiperface::state::{LinkForm, LinkKind, Search};
use encoder_studio::units::{Baud, Parity};

use crate::support::{Desk, PORT, SERVERS, asks_for_drive};
use crate::texts;

fn dialog(desk: &Desk) -> &Dialog {
    desk.studio.connect.as_ref().expect("the dialog is open")
}

fn search(desk: &Desk) -> &Search {
    crate::tabs::search(dialog(desk)).as_ref().expect("there is a search")
}

fn edit(desk: &mut Desk, change: impl FnOnce(&mut LinkForm)) {
    let mut form = LinkForm::default();
    change(&mut form);
    desk.connect(Connect::edit_form(form));
}

/// Before the first byte on a serial line, the program asks whether a drive is on the line, because it could have been
/// silent since it read the encoder at power-up. After "yes" or "not sure", nothing is opened, searched or polled
/// (issue 22.30).
#[test]
fn asks_about_drive_before_first_byte() {
    let links = [format!("serial:{PORT}"), format!("tcp:{}", SERVERS[0].0)];
    for link in links {
        let mut desk = Desk::fresh("");
        desk.studio.start_with(Some(link.parse().unwrap()), None);
        assert!(asks_for_drive(&desk.studio), "{link}");
        texts::check_all(&desk.studio);
        desk.settle();
        assert_eq!(desk.wire().sent(), 0, "nothing is sent while it is asked");
        desk.studio.handle_action(Action::Escape);
        desk.settle();
        let Phase::Lost(why) = desk.phase() else { panic!("{:?}", desk.phase()) };
        assert_eq!(why.id(), "session.maybe_drive");
        desk.command(DeviceCommand::Poll(Some(Duration::ZERO)));
        desk.command(DeviceCommand::Read);
        desk.settle();
        assert_eq!(desk.wire().sent(), 0, "{link}");
        // Every new connection needs a new answer.
        let id = desk.encoder().session.id;
        desk.studio.handle_action(Action::Command(id, DeviceCommand::Reconnect));
        assert!(asks_for_drive(&desk.studio));
        desk.studio.handle_action(Action::Confirm);
        desk.until_read();
        assert!(desk.wire().sent() > 0 && desk.studio.question.is_none());
    }
    // A virtual encoder has no drive on its line.
    let mut desk = Desk::fresh("");
    desk.studio.start_with(None, None);
    assert!(desk.studio.question.is_none());
    desk.until_read();
}

/// A search also asks about a drive before its first byte. The encoder it finds is opened without asking again (issue
/// 22.30).
#[test]
fn search_asks_about_drive_before_first_byte() {
    let mut desk = Desk::fresh("");
    desk.connect(Connect::Open);
    edit(&mut desk, |form| (form.kind, form.port) = (LinkKind::Serial, PORT.to_owned()));
    desk.studio.handle_action(Action::Connect(crate::tabs::search_for(FindOptions::default())));
    assert!(asks_for_drive(&desk.studio) && crate::tabs::search(dialog(&desk)).is_none());
    desk.studio.handle_action(Action::Escape);
    desk.settle();
    assert_eq!(dialog(&desk).problem.as_ref().map(|text| text.id()), Some("session.maybe_drive"));
    assert_eq!((desk.wire().sent(), crate::tabs::search(dialog(&desk)).is_none()), (0, true));
    desk.studio.handle_action(Action::Connect(crate::tabs::search_for(FindOptions::default())));
    desk.studio.handle_action(Action::Confirm);
    desk.until("it has found one", |studio| {
        studio.connect.as_ref().and_then(|own| crate::tabs::search(own)).is_some_and(|own| !own.found.is_empty())
    });
    desk.studio.handle_action(Action::Connect(crate::tabs::choose(0)));
    assert!(desk.studio.question.is_none());
    desk.until_read();
}

/// Makes one entry of the form invalid.
type InvalidateEntry = fn(&mut LinkForm);

#[test]
fn rejects_invalid_entries() {
    let mut desk = Desk::fresh("");
    desk.connect(Connect::Open);
    let cases: [(InvalidateEntry, &str); 9] = [
        (|form| form.kind = LinkKind::Serial, "form.port_missing"),
        (|form| form.kind = LinkKind::Tcp, "form.host_missing"),
        (|form| (form.kind, form.host) = (LinkKind::Tcp, "moxa".to_owned()), "form.tcp_port_missing"),
        (|form| form.kind = LinkKind::Replay, "form.file_missing"),
        (|form| form.address = "60".to_owned(), "form.address"),
        (|form| form.typed.set("margin", "soon"), "form.margin"),
        (|form| form.typed.set("turns", "4096"), "form.turns_alone"),
        (|form| form.typed.set("rpm", "fast"), "form.rpm"),
        (|form| form.typed.set("fault", "drop:2"), "form.fault"),
    ];
    for (slip, id) in cases {
        edit(&mut desk, slip);
        assert_eq!(dialog(&desk).url().unwrap_err().id(), id);
        for action in [Connect::Connect, crate::tabs::search_for(FindOptions::default())] {
            desk.connect(action);
            assert_eq!(dialog(&desk).problem.as_ref().map(|text| text.id()), Some(id));
            desk.settle();
        }
        assert!(crate::tabs::search(dialog(&desk)).is_none() && desk.studio.devices().is_empty());
    }
    edit(&mut desk, |_| {});
    assert!(dialog(&desk).problem.is_none(), "with the entry goes the sentence");
    desk.connect(Connect::Connect);
    desk.until_read();
    assert!(desk.studio.connect.is_none());
}

#[test]
fn example_links_are_valid() {
    let mut desk = Desk::fresh("");
    desk.connect(Connect::Open);
    for (device, scheme) in [
        (crate::tabs::HIPERFACE, "serial:"),
        (crate::tabs::BISS, "bridge:"),
        (crate::tabs::SSI, "bridge:"),
        (crate::tabs::INTERBUS, "modbus:"),
        (crate::tabs::HIPERDRIVE, "enip:"),
    ] {
        desk.connect(Connect::Device(device));
        let example = dialog(&desk).example_link();
        assert!(example.starts_with(scheme), "{device:?}: {example}");
        desk.connect(Connect::Use(example.to_owned()));
        assert!(dialog(&desk).url().is_ok(), "{example}");
    }
    desk.connect(Connect::Device(crate::tabs::BISS));
    desk.connect(Connect::Use("serial:COM3".to_owned()));
    assert!(dialog(&desk).example_link().starts_with("serial:"), "a pin is reached otherwise than a bus");
}

/// A typed link updates the form, and the form updates the link. A link that is invalid for this device is reported.
#[test]
fn accepts_typed_and_pasted_links() {
    let mut desk = Desk::fresh("");
    desk.connect(Connect::Open);
    let wrong = [
        (crate::tabs::HIPERFACE, "", "form.other", "is not a link"),
        (crate::tabs::HIPERFACE, "/dev/ttyUSB0", "form.other", "a link begins with sim:, serial:"),
        (crate::tabs::HIPERFACE, "serial:", "form.other", "serial:/dev/ttyUSB0"),
        (crate::tabs::HIPERFACE, "tcp:moxa", "form.other", "tcp:192.168.0.7:4001"),
        (crate::tabs::HIPERFACE, "enip:192.168.1.7", "form.other", "cannot be used for this device"),
        (crate::tabs::HIPERFACE, "bridge:/dev/ttyACM0?clock=1000000", "form.other", "clock is not a parameter"),
        (crate::tabs::HIPERFACE, "serial:x?clock=1", "form.other", "clock is not a parameter"),
        (crate::tabs::HIPERFACE, "serial:x?baud=fast", "form.parameter", "baud=fast"),
        (crate::tabs::BISS, "serial:x?address=0x40", "form.other", "address is not a parameter"),
        (crate::tabs::BISS, "bridge:x?clock=9", "form.clock", "9 is not valid"),
        (crate::tabs::BISS, "sim:?motor=none", "form.parameter", "motor=none"),
        (crate::tabs::BISS, "sim:?noise=0.1", "form.other", "noise"),
    ];
    for (device, link, id, words) in wrong {
        desk.connect(Connect::Device(device));
        let before = dialog(&desk).typed_link();
        desk.connect(Connect::Use(link.to_owned()));
        assert_eq!(dialog(&desk).typed_link(), link, "what is typed stays as it is typed");
        let why = dialog(&desk).url().unwrap_err();
        assert_eq!(why.id(), id, "{link}");
        assert!(why.to_string_in(Language::English).contains(words), "{link}: {}", why.to_string_in(Language::English));
        desk.connect(Connect::Connect);
        assert!(desk.studio.devices().is_empty());
        desk.connect(Connect::Device(device));
        assert_eq!(dialog(&desk).typed_link(), before, "the form is as it was");
    }
    desk.connect(Connect::Device(crate::tabs::BISS));
    desk.connect(Connect::Use("bridge:tcp:adapter:5000?clock=2000000".to_owned()));
    let mut form = dialog(&desk).form_as::<encoder_studio::devices::biss::state::BissForm>().unwrap().clone();
    assert_eq!((form.kind, form.host.as_str(), form.typed.get("clock")), (BissLinkKind::Bus, "adapter", "2000000"));
    form.typed.set("clock", "");
    desk.connect(Connect::edit_form(form));
    assert_eq!(dialog(&desk).typed_link(), "bridge:tcp:adapter:5000");

    desk.connect(Connect::Device(crate::tabs::HIPERFACE));
    desk.connect(Connect::Use(format!(" serial:{PORT}?baud=9600 ")));
    assert_eq!(dialog(&desk).form_as::<encoder_studio::devices::hiperface::state::LinkForm>().unwrap().port, PORT);
    desk.connect(Connect::Connect);
    desk.until_read();
    assert_eq!(desk.encoder().session.source, Source::Link(format!("serial:{PORT}?baud=9600").parse().unwrap()));
}

#[test]
fn offers_recordings_as_file_list() {
    let mut desk = Desk::fresh("");
    desk.connect(Connect::Open);
    edit(&mut desk, |form| form.kind = LinkKind::Replay);
    assert!(is_missing(&dialog(&desk).url().unwrap_err()));
    desk.connect(Connect::AskRecording);
    assert!(matches!(desk.studio.take_file_question(), Some(FileQuestion::Recording)));
    desk.act(Action::Chosen(FileQuestion::Recording, "monday.trace".into()));
    // The link has the full path, so that it works from any folder in which the program is started next time
    // (issue 22.24).
    let path = desk.outside.path("work/monday.trace");
    assert_eq!(dialog(&desk).typed_link(), format!("replay:{}", path.display()));
}

#[test]
fn dialog_starts_with_last_used_link() {
    let mut desk = Desk::fresh("address=0x43");
    let link = format!("serial:{PORT}?address=0x43");
    desk.open(&link);
    desk.until_read();
    desk.connect(Connect::Open);
    assert_eq!(
        dialog(&desk)
            .form_as::<encoder_studio::devices::hiperface::state::LinkForm>()
            .unwrap()
            .url()
            .unwrap()
            .to_string(),
        link
    );
    desk.until("the ports are listed", |studio| matches!(studio.connect.as_ref().unwrap().ports, Some(Ok(_))));
    let offers = dialog(&desk).ports.clone().unwrap().unwrap();
    assert!(offers[0].path == PORT && offers[0].used, "{offers:?}");
    desk.connect(Connect::ListPorts);
    assert!(dialog(&desk).ports.is_none());
    desk.connect(Connect::Close);
    desk.settle();
    assert!(desk.studio.connect.is_none());
}

/// Starts a search for two encoders whose settings differ from the form's initial values: 19200 baud, odd parity,
/// addresses 43h and 44h. If `hold` is given, the cable is held before the request with that number.
fn searching(hold: Option<usize>) -> Desk {
    let mut desk = Desk::fresh("encoders=2&address=0x43&settings=0xF5");
    desk.connect(Connect::Open);
    edit(&mut desk, |form| (form.kind, form.port) = (LinkKind::Serial, PORT.to_owned()));
    if let Some(number) = hold {
        desk.wire().hold_at(0x52, number);
    }
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    desk
}

#[test]
fn finds_all_encoders_and_chooses_one() {
    let mut desk = searching(None);
    assert!(search(&desk).is_running() && desk.studio.can_stop());
    desk.until("the search is over", |studio| !studio.can_stop());
    let found: Vec<u8> = search(&desk).found.iter().map(|found| found.address).collect();
    assert_eq!(found, [0x43, 0x44]);
    let format = search(&desk).found[1].format;
    desk.connect(crate::tabs::choose(1));
    assert!(desk.studio.connect.is_none());
    desk.until_read();
    assert_eq!(*desk.phase(), Phase::Connected);
    assert_eq!(desk.encoder().identity.as_ref().unwrap().address, 0x44);
    assert_ne!((format.baud, format.parity), (Baud::new(9600).unwrap(), Parity::Even));
    let link = format!("serial:{PORT}?baud={}&parity={}&address=0x44", format.baud, format.parity.keyword());
    assert_eq!(desk.encoder().session.source, Source::Link(link.parse().unwrap()));
    assert_eq!(desk.studio.settings.links_of(crate::tabs::HIPERFACE), [link]);
}

#[test]
fn search_lists_results_while_running() {
    for stop in [|| Action::Connect(Connect::StopSearch), || Action::Stop, || Action::Escape] {
        let mut desk = searching(None);
        let wire = desk.wire();
        wire.hold_at(0x52, 600);
        desk.until("the line is held", |_| wire.is_held());
        desk.until("something is listed", |studio| {
            let search = studio.connect.as_ref().and_then(|dialog| crate::tabs::search(dialog)).unwrap();
            !search.found.is_empty() && search.progress().is_some_and(|progress| progress.done > 0)
        });
        assert!(search(&desk).is_running());
        desk.act(stop());
        desk.wire().release();
        desk.until("the search is over", |studio| !studio.can_stop());
        assert_eq!(search(&desk).end.as_ref().unwrap().id(), "find.cut_short");
        assert!(!search(&desk).found.is_empty(), "what answered stays");
    }
}

#[test]
fn empty_search_names_possible_causes() {
    let mut desk = Desk::fresh("fault=silent-after:0");
    desk.connect(Connect::Open);
    edit(&mut desk, |form| (form.kind, form.port) = (LinkKind::Serial, PORT.to_owned()));
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    desk.until("it is over", |studio| !studio.can_stop());
    assert_eq!(search(&desk).end.as_ref().unwrap().id(), "find.nothing");
    desk.wire().unplug();
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    desk.until("it is over", |studio| !studio.can_stop());
    assert_eq!(search(&desk).end.as_ref().unwrap().id(), "link.not_found");
    desk.connect(crate::tabs::choose(0));
    assert!(desk.studio.connect.is_some() && desk.studio.devices().is_empty());
}

#[test]
fn closing_dialog_ends_search() {
    let mut desk = searching(Some(5));
    let wire = desk.wire();
    desk.until("the line is held", |_| wire.is_held());
    desk.connect(Connect::Close);
    assert!(!desk.studio.can_stop());
    let holders = Arc::strong_count(&wire);
    wire.release();
    desk.until("the wire is free", |_| Arc::strong_count(&wire) < holders);
}

#[test]
fn search_closes_open_wire_first() {
    let mut desk = Desk::connected_at_port("");
    let link = format!("serial:{PORT}");
    desk.command(DeviceCommand::Poll(Some(std::time::Duration::from_millis(2))));
    desk.connect(Connect::Open);
    desk.connect(Connect::Use(link.clone()));
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    assert!(matches!(desk.phase(), Phase::Lost(why) if why.id() == "session.let_go_for_search"));
    assert!(desk.encoder().session.live_session().is_none());
    assert_eq!(desk.notice_count("session.let_go_for_search"), 1);
    desk.until("the search is over", |studio| !studio.can_stop());
    assert_eq!(search(&desk).found.len(), 1);
    desk.connect(Connect::Connect);
    desk.until_read();
    assert_eq!(desk.studio.devices().len(), 1);

    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x4B, 1);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.connect(Connect::Open);
    desk.connect(Connect::Use(link));
    desk.connect(crate::tabs::search_for(FindOptions::default()));
    assert_eq!(dialog(&desk).problem.as_ref().map(|text| text.id()), Some("session.writes_there"));
    assert!(crate::tabs::search(dialog(&desk)).is_none() && desk.encoder().session.is_writing());
    desk.wire().release();
    desk.until_written();
}

/// A link with an invalid or missing parameter opens the tab of a device kind that uses its scheme.
#[test]
fn link_error_comes_from_scheme_owner() {
    for (link, tab) in [
        ("bridge:/dev/nothing?clok=1", crate::tabs::BISS),
        ("bridge:/dev/nothing?mt=12", crate::tabs::BISS),
        ("bridge:/dev/nothing?pause=30", crate::tabs::SSI),
        ("modbus:nowhere.invalid?colour=red", crate::tabs::INTERBUS),
    ] {
        let mut desk = Desk::fresh("");
        desk.act(Action::ShowTab(crate::tabs::HIPERFACE));
        desk.studio.start_with(Some(link.parse().unwrap()), None);
        assert_eq!(desk.studio.settings.tab, tab, "{link}");
    }
}

/// A late answer applies only to the search that asked, and not to a dialog opened later.
#[test]
fn late_answer_starts_no_search() {
    let mut desk = Desk::fresh("");
    desk.connect(Connect::Open);
    desk.connect(Connect::Use("serial:/dev/nothing".to_owned()));
    desk.studio.handle_action(Action::Connect(crate::tabs::search_for(FindOptions::default())));
    assert!(asks_for_drive(&desk.studio));
    desk.studio.handle_action(Action::Connect(Connect::Close));
    desk.studio.handle_action(Action::Connect(Connect::Open));
    desk.studio.handle_action(Action::Confirm);
    assert!(crate::tabs::search(dialog(&desk)).is_none());
}
