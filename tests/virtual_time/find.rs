//! The search for encoders with unknown settings: all are found, only 52h is sent, and never on a busy line.

use std::time::Duration;

use encoder_studio::devices::hiperface::jobs::{DeviceMessage, HiperfaceJob, HiperfaceOutput};
use encoder_studio::devices::hiperface::procedures::find::{EncoderSearchResult, FindOptions, FoundEncoder};
use encoder_studio::devices::hiperface::protocol::LineSettings;
use encoder_studio::link::{CancelToken, Clock};
use encoder_studio::units::CharacterFormat;
use encoder_studio::worker::{Event, JobId};

use crate::support::Desk;

fn find(desk: &mut Desk, options: FindOptions) -> EncoderSearchResult {
    let findings = match desk.run(HiperfaceJob::Find(options)).unwrap() {
        HiperfaceOutput::Found(findings) => findings,
        other => panic!("{other:?}"),
    };
    assert!(desk.tap().sent.iter().all(|frame| frame[1] == 0x52), "nothing but 52h");
    findings
}

fn searched(desk: &mut Desk, options: FindOptions) -> Vec<FoundEncoder> {
    match find(desk, options) {
        EncoderSearchResult::Searched { found, complete: true } => found,
        other => panic!("{other:?}"),
    }
}

#[test]
fn finds_encoder_with_unusual_settings() {
    // 600 to 38400 baud, each parity, both time-outs, the standard address and a bus address.
    for (byte, address) in
        [(0xE0, 0x5F), (0xC1, 0x41), (0xF2, 0x50), (0x63, 0x40), (0x84, 0x4A), (0xB5, 0x5E), (0xA6, 0x40)]
    {
        let settings = LineSettings::from_byte(byte);
        let mut desk = Desk::new(&format!("settings={byte}&address={address}"));
        let found = searched(&mut desk, FindOptions::default());
        assert_eq!(found.len(), 1, "{settings}");
        assert_eq!((found[0].address, Some(found[0].format)), (address, settings.character_format()));
        assert_eq!(found[0].label.settings, settings);
        assert!(desk.tap().sent.iter().all(|frame| frame[0] != 0xFF), "no broadcast without consent");
        assert_eq!(desk.session.station().address, 0x40, "our side is as before");
    }
}

#[test]
fn finds_eight_encoders_on_bus() {
    for settings in [0x64, 0x65] {
        let mut desk = Desk::new(&format!("encoders=8&address=0x52&settings={settings}"));
        let found = searched(&mut desk, FindOptions::default());
        let addresses: Vec<u8> = found.iter().map(|found| found.address).collect();
        assert_eq!(addresses, (0x52..0x5A).collect::<Vec<u8>>());
    }
}

#[test]
fn sends_nothing_on_busy_line() {
    for traffic in [vec![0x40], vec![0x40, 0x42, 0x02, 0x00, 0xFF]] {
        let mut desk = Desk::new("");
        desk.tap().foreign = traffic.clone().into();
        let options = FindOptions { one_encoder: true, power_cycle: Some(Duration::from_secs(3)) };
        let EncoderSearchResult::ForeignTraffic { bytes } = find(&mut desk, options) else { panic!() };
        assert_eq!(bytes, traffic.len());
        assert_eq!(desk.tap().sent.len(), 0);
    }
}

#[test]
fn broadcast_comes_last_and_needs_consent() {
    let mut desk = Desk::new("address=0x47");
    let found = searched(&mut desk, FindOptions { one_encoder: true, power_cycle: None });
    assert_eq!(found.iter().map(|found| found.address).collect::<Vec<_>>(), [0x47]);
    let first_broadcast = desk.tap().sent.iter().position(|frame| frame[0] == 0xFF).unwrap();
    assert!(first_broadcast > 32, "the formats at which nobody answered, after all their addresses");
}

#[test]
fn finds_nothing_on_empty_line() {
    let mut desk = Desk::new("fault=silent-after:0");
    assert_eq!(searched(&mut desk, FindOptions::default()), []);
    assert_eq!(desk.tap().sent.len(), 7 * 3 * 32);
}

/// The encoder is switched on during the search and found while it still uses its factory settings.
#[test]
fn power_cycle_opens_factory_settings_window() {
    for (settings, one_encoder) in [(0xB5, true), (0x80, true), (0xE6, false)] {
        let mut desk = Desk::new(&format!("settings={settings}&fault=silent-after:0"));
        let bus = desk.bus.clone();
        let clock = desk.clock.clone();
        let mut questions = 0;
        desk.session.add_watcher(move |_| {
            questions += 1;
            if questions == 20 {
                let mut bus = bus.lock().unwrap();
                bus.set_faults(&Default::default());
                bus.power_cycle(clock.now());
            }
        });
        let options = FindOptions { one_encoder, power_cycle: Some(Duration::from_secs(30)) };
        let found = searched(&mut desk, options);
        assert_eq!(found[0].address, 0x40);
        assert_eq!(found[0].format, CharacterFormat::FACTORY);
        assert_eq!(found[0].label.settings.byte(), settings, "what it has stored is told");
    }
}

/// The program cannot change the fixed speed of a device server. Trying other speeds would find the same encoder 21
/// times.
#[test]
fn finds_each_encoder_once_through_server() {
    let mut desk = Desk::new("address=0x43&encoders=2");
    desk.tap().formatless = true;
    let found = searched(&mut desk, FindOptions::default());
    assert_eq!(found.iter().map(|found| found.address).collect::<Vec<_>>(), [0x43, 0x44]);
    assert_eq!(desk.tap().sent.len(), 32, "each address once");
}

/// A cancelled search returns the encoders found so far and restores the serial settings of the port.
#[test]
fn interrupted_search_reports_findings() {
    // The search begins at the encoders' own settings, where address 40h is requested first.
    let mut desk = Desk::new("encoders=2&address=0x4A");
    for (questions, expected) in [(0, vec![]), (10, vec![]), (11, vec![0x4A]), (12, vec![0x4A, 0x4B])] {
        desk.tap().sent.clear();
        desk.session.set_cancel(CancelToken::after_transactions(questions));
        let EncoderSearchResult::Searched { found, complete } = find(&mut desk, FindOptions::default()) else {
            panic!()
        };
        assert!(!complete);
        assert_eq!(found.iter().map(|found| found.address).collect::<Vec<_>>(), expected, "{questions}");
        assert_eq!(desk.tap().sent.len() as u64, questions);
        let station = desk.session.station();
        assert_eq!((station.address, station.format), (0x40, CharacterFormat::FACTORY));
    }
}

/// Each encoder is reported as soon as it answers, before the search ends.
#[test]
fn reports_encoders_as_they_answer() {
    let mut desk = Desk::new("encoders=3&address=0x52");
    let mut told = Vec::new();
    let mut progress = 0;
    let end =
        desk.session.run(JobId::default(), HiperfaceJob::Find(FindOptions::default()), &mut |event| match event {
            Event::DeviceMessage(DeviceMessage::Found(found)) => told.push((found, progress)),
            Event::Progress(_, step) => progress = step.done,
            _ => {}
        });
    let Event::Finished(_, output) = end else { panic!("{end:?}") };
    let HiperfaceOutput::Found(EncoderSearchResult::Searched { found, complete: true }) = *output else {
        panic!("{output:?}")
    };
    assert_eq!(told.iter().map(|(found, _)| found.clone()).collect::<Vec<_>>(), found);
    assert_eq!(told.iter().map(|(found, _)| found.address).collect::<Vec<_>>(), [0x52, 0x53, 0x54]);
    assert!(told.iter().all(|(_, at)| *at <= 32), "while the others are still to be asked");
}
