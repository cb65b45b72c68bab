//! Tests of the BiSS tab with the virtual kit encoder, connected through its configuration pin or through the virtual
//! adapter.

use crate::biss_support::command;
use crate::tabs::Tabs as _;
use egui_kittest::kittest::Queryable;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, Recording, Severity, Tab};
use encoder_studio::devices::biss::protocol::Role;
use encoder_studio::devices::biss::state::{BissAction as Biss, ValidityMark};
use encoder_studio::devices::biss::state::{BissForm, BissLinkKind};

use crate::biss_support::{ask, at, encoder, is_read, open};
use crate::screen::Screen;
use crate::support::{Desk, asks_for_drive};

#[test]
fn reads_virtual_encoder_over_both_interfaces() {
    for (link, has_bits) in [("sim:", false), ("sim:?bridge=on", true)] {
        let desk = open(link);
        let encoder = encoder(&desk);
        assert!(encoder.session.is_virtual(), "{link}");
        let identity = encoder.identity().unwrap();
        // The virtual encoder has the newest firmware of the manual's appendix. Its serial number 0012D687h is 1234567.
        assert_eq!((identity.serial_number.as_str(), identity.layout.bits()), ("1234567", 41), "{link}");
        assert_eq!(encoder.session.name(), "POSITAL IXARC kit encoder · 1234567");
        let reading = encoder.record.last().unwrap();
        assert_eq!((reading.turns, reading.steps, reading.error.is_some()), (0x1234, 0x18000, has_bits), "{link}");
        assert_eq!(encoder.status.as_ref().unwrap().celsius, Some(30.0));
        assert!(desk.notice_ids(Severity::Warning).is_empty(), "{link}");
        assert_eq!(desk.studio.settings.links_of(crate::tabs::BISS), [link]);
        assert!(desk.studio.settings.links_of(crate::tabs::HIPERFACE).is_empty());
    }
}

#[test]
fn unambiguous_link_opens_in_its_tab() {
    let cases = [
        (crate::tabs::HIPERFACE, "sim:?bridge=on", crate::tabs::BISS),
        (crate::tabs::HIPERFACE, "serial:/dev/nowhere?order=low-first", crate::tabs::BISS),
        (crate::tabs::BISS, "sim:?model=sel37", crate::tabs::HIPERFACE),
        (crate::tabs::HIPERFACE, "sim:", crate::tabs::HIPERFACE),
        (crate::tabs::BISS, "sim:", crate::tabs::BISS),
        (crate::tabs::BISS, "sim:?nobody=1", crate::tabs::BISS),
    ];
    for (shown, link, expected) in cases {
        let mut desk = Desk::fresh("");
        desk.act(Action::ShowTab(shown));
        desk.studio.start_with(Some(link.parse().unwrap()), None);
        assert_eq!(desk.studio.settings.tab, expected, "{link}");
    }
}

/// A link opens in the tab where it was last used, so a BiSS encoder is not opened as a HIPERFACE encoder.
#[test]
fn known_link_opens_in_previous_tab() {
    let (port, adapter) = ("serial:/dev/nowhere", "bridge:/dev/nowhere");
    let cases: [(Tab, &[Tab], &str, Tab); 9] = [
        (crate::tabs::HIPERFACE, &[], port, crate::tabs::HIPERFACE),
        (crate::tabs::HIPERFACE, &[crate::tabs::BISS], port, crate::tabs::BISS),
        (crate::tabs::SIGNALS, &[crate::tabs::BISS], port, crate::tabs::BISS),
        (crate::tabs::BISS, &[crate::tabs::HIPERFACE], port, crate::tabs::HIPERFACE),
        (crate::tabs::BISS, &[crate::tabs::HIPERFACE, crate::tabs::BISS], port, crate::tabs::BISS),
        (crate::tabs::INTERBUS, &[crate::tabs::BISS, crate::tabs::HIPERFACE], port, crate::tabs::HIPERFACE),
        (crate::tabs::HIPERFACE, &[crate::tabs::SSI], adapter, crate::tabs::SSI),
        (crate::tabs::HIPERFACE, &[], adapter, crate::tabs::BISS),
        (crate::tabs::BISS, &[crate::tabs::HIPERFACE], "sim:", crate::tabs::BISS),
    ];
    for (shown, used, link, expected) in cases {
        let mut desk = Desk::fresh("");
        desk.act(Action::ShowTab(shown));
        used.iter().for_each(|tab| desk.studio.settings.use_link(*tab, link));
        desk.studio.start_with(Some(link.parse().unwrap()), None);
        assert_eq!(desk.studio.settings.tab, expected, "{link} in {shown:?}, used in {used:?}");
        assert_eq!(
            asks_for_drive(&desk.studio),
            link == port && expected == crate::tabs::HIPERFACE,
            "{link} in {shown:?}"
        );
    }
}

/// The encoder's status bits mark a position as invalid. The configuration pin transmits no status bits with a
/// position, so they are read from the registers.
#[test]
fn marks_position_over_both_interfaces() {
    for link in ["sim:", "sim:?bridge=on"] {
        assert_eq!(encoder(&open(link)).position_mark(), None, "{link}");
    }
    for link in ["sim:?errors=0x12", "sim:?bridge=on&errors=0x12"] {
        assert_eq!(encoder(&open(link)).position_mark(), Some(ValidityMark::Invalid), "{link}");
    }
}

#[test]
fn shows_meaning_of_every_frame() {
    for link in ["sim:", "sim:?bridge=on"] {
        let desk = open(link);
        let lines = encoder(&desk).session.trace.lines();
        let bare: Vec<_> = lines.iter().filter(|line| line.meaning.is_empty() && line.bytes.trim() != "00").collect();
        assert!(lines.len() > 20 && bare.is_empty(), "{link}: {bare:?}");
    }
}

#[test]
fn reads_visible_bank_once() {
    let mut desk = open("sim:?bridge=on");
    let bank = encoder(&desk).table.position(Some(0x24)).unwrap();
    assert!(encoder(&desk).should_read_bank(&encoder(&desk).table.groups()[bank]));
    ask(&mut desk, Biss::ReadVisibleBank(Some(0x24)));
    desk.until("the bank is read", |studio| {
        studio.biss().is_some_and(|own| own.session.is_ready() && own.memory.read(at("0x24:0x3F")).is_some())
    });
    let jobs = desk.studio.services.jobs().len();
    assert!(!encoder(&desk).should_read_bank(&encoder(&desk).table.groups()[bank]));
    ask(&mut desk, Biss::ReadVisibleBank(Some(0x24)));
    assert_eq!(desk.studio.services.jobs().len(), jobs);
}

#[test]
fn does_not_read_data_while_turning() {
    let mut desk = open("sim:?bridge=on&rpm=300");
    ask(&mut desk, Biss::ReadArea(0x24));
    desk.until("it is refused", |studio| studio.services.log.notices().any(|own| own.severity == Severity::Error));
    assert_eq!(encoder(&desk).memory.read(at("0x24:0x00")), None);
    desk.until("it is ready", is_read);
    ask(&mut desk, Biss::Turn(0.0));
    assert_eq!(encoder(&desk).motor.as_ref().unwrap().rpm(), 0.0);
    ask(&mut desk, Biss::ReadArea(0x24));
    desk.until("it is read", |studio| {
        studio.biss().is_some_and(|own| own.session.is_ready() && own.memory.read(at("0x43:0x3F")).is_some())
    });
}

#[test]
fn watches_register_with_position() {
    let mut desk = open("sim:?bridge=on&rpm=60");
    let description = encoder(&desk).description.clone().unwrap();
    let temperature = description.register_with_role(Role::Temperature).unwrap().clone();
    ask(&mut desk, Biss::Watch(Box::new(temperature), true));
    command(&mut desk, DeviceCommand::Poll(Some(std::time::Duration::from_millis(5))));
    desk.until("samples come", |studio| {
        let record = &studio.biss().unwrap().record;
        let watched = record.recorder().series().iter().find(|line| line.heading.contains("temperature"));
        let history = watched.and_then(|line| record.recorder().history(line));
        record.position_count() > 50 && history.is_some_and(|history| !history.indices().is_empty())
    });
    let recorder = encoder(&desk).record.recorder();
    let line = recorder.series().iter().find(|line| line.heading.contains("temperature")).unwrap();
    let history = recorder.history(line).unwrap();
    assert_eq!(history.sample(line.column(), history.indices().start).unwrap().value.to_f64(), 30.0);
    command(&mut desk, DeviceCommand::Poll(None));
}

#[test]
fn link_opens_in_requesting_tab() {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::BISS));
    desk.connect(Connect::Open);
    assert_eq!(desk.studio.connect.as_ref().unwrap().device, crate::tabs::BISS);
    let form = BissForm { kind: BissLinkKind::Pin, port: "/dev/nowhere".to_owned(), ..BissForm::default() };
    desk.connect(Connect::edit_form(form));
    desk.connect(Connect::Connect);
    desk.until("it cannot be opened", |studio| {
        studio.biss().is_some_and(|own| matches!(own.session.phase, Phase::Lost(_)))
    });
    assert!(desk.studio.hiperface().is_none());
    desk.act(Action::OpenVirtual);
    desk.until("the virtual one is read", is_read);
    assert_eq!(desk.studio.devices().len(), 2);
}

#[test]
fn click_shows_and_reads_bank() {
    let mut screen = Screen::open_in_tab(crate::tabs::BISS, "sim:?bridge=on", [1440.0, 900.0]);
    screen.until("it is read", is_read);
    screen.click("page.registers");
    assert_eq!(screen.studio().biss().unwrap().memory.read(at("0x04:0x3F")), None);
    // The list comes before the table, whose heading contains the same text.
    let bank = screen.harness.query_all_by_label_contains("0x04").next().expect("bank 0x04 is listed");
    assert!(bank.rect().right() < 350.0, "{:?}", bank.rect());
    bank.click();
    screen.steps();
    screen.until("it is read by itself", |studio| {
        studio.biss().is_some_and(|own| own.memory.read(at("0x04:0x3F")).is_some())
    });
}
