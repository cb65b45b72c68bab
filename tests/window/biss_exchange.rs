//! Tests of replacing a BiSS encoder with another one, and of two sessions that request the same connection.

use crate::biss_support::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::Severity;
use encoder_studio::app::session::Phase;
use encoder_studio::devices::biss::jobs::Change;
use encoder_studio::devices::biss::protocol::PositionFilter;
use encoder_studio::devices::biss::state::BissAction as Biss;
use encoder_studio::signals::state::{SignalsAction as Signals, SourceAction};

use crate::biss_support::{ask, connect, encoder, is_read};
use crate::served::ServedDevice;
use crate::support::Desk;

fn edit(desk: &mut Desk) {
    let place = "0x24:0x10".parse().unwrap();
    ask(desk, Biss::ReadBank(Some(0x24)));
    desk.until("the bank is read", |studio| is_read(studio) && studio.biss().unwrap().memory.read(place).is_some());
    ask(desk, Biss::Put { start: place, bytes: vec![0x22] });
    assert!(encoder(desk).is_dirty());
}

#[test]
fn edits_stay_with_their_encoder() {
    let served = ServedDevice::new("serial=1");
    let mut desk = Desk::fresh("");
    connect(&mut desk, &served.link());
    edit(&mut desk);
    served.exchange("serial=2");
    command(&mut desk, DeviceCommand::Review);
    desk.until("the other one is read", |studio| {
        is_read(studio) && studio.biss().unwrap().serial_number() == Some("2")
    });
    assert!(encoder(&desk).session.review.is_none(), "no plan is left for a consent");
    assert!(!encoder(&desk).is_dirty());
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.other_encoder"]);
    // The edits still belong to the first encoder.
    served.exchange("serial=1");
    command(&mut desk, DeviceCommand::Read);
    desk.until("the first one is back", |studio| {
        is_read(studio) && studio.biss().unwrap().serial_number() == Some("1") && studio.biss().unwrap().is_dirty()
    });
}

/// Without edits, the notice reports only that the plan was discarded.
#[test]
fn exchanged_encoder_discards_plan() {
    let served = ServedDevice::new("serial=1");
    let mut desk = Desk::fresh("");
    connect(&mut desk, &served.link());
    served.exchange("serial=2");
    ask(&mut desk, Biss::Plan(Box::new(Change::SelectFilter(PositionFilter::Dynamic))));
    desk.until("the other one is read", |studio| {
        is_read(studio) && studio.biss().unwrap().serial_number() == Some("2")
    });
    assert!(encoder(&desk).session.review.is_none());
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.plan_of_another"]);
}

#[test]
fn encoder_and_scope_share_no_wire() {
    let served = ServedDevice::new("rpm=6");
    let mut desk = Desk::fresh("");
    connect(&mut desk, &served.link());
    desk.signals(Signals::Source(SourceAction::SetLink(served.link())));
    desk.signals(Signals::Source(SourceAction::StartAdapter));
    let why = |phase: &Phase| matches!(phase, Phase::Lost(why) if why.id() == "session.let_go_for_signals");
    assert!(why(&encoder(&desk).session.phase));
    desk.until("it samples", |studio| studio.signals().source().streaming_adapter().is_some());
    assert!(desk.studio.signals().source().adapter_problem().is_none());
    command(&mut desk, DeviceCommand::Reconnect);
    let source = desk.studio.signals().source();
    assert!(!source.is_running());
    assert_eq!(source.adapter_problem().map(|text| text.id()), Some("adapter.let_go"));
    desk.until("the encoder is read again", is_read);
}

#[test]
fn adapter_does_not_interrupt_write() {
    let served = ServedDevice::new("rpm=0");
    let mut desk = Desk::fresh("");
    connect(&mut desk, &served.link());
    ask(&mut desk, Biss::ReturnToOperation);
    assert!(encoder(&desk).session.is_writing());
    desk.signals(Signals::Source(SourceAction::SetLink(served.link())));
    desk.signals(Signals::Source(SourceAction::StartAdapter));
    let source = desk.studio.signals().source();
    assert_eq!(source.adapter_problem().map(|text| text.id()), Some("session.writes_there"));
    assert!(!source.is_running());
    desk.until("the write ends", is_read);
}
