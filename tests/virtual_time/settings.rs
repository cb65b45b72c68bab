//! Encoder restarts, temporary and permanent interface settings, and addresses.

use encoder_studio::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput};
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::protocol::{Command, DeviceAddress, LineSettings, StatusCode};
use encoder_studio::units::CharacterFormat;

use crate::support::{Desk, MARGIN};

fn reset(desk: &mut Desk) -> Vec<StatusCode> {
    match desk.run(HiperfaceJob::Reset).unwrap() {
        HiperfaceOutput::Reset(codes) => codes,
        other => panic!("{other:?}"),
    }
}

fn position(desk: &mut Desk) {
    desk.run(HiperfaceJob::Position(None)).unwrap();
}

fn station_for(settings: LineSettings) -> Station {
    let mut station = Station::new(MARGIN);
    station.format = settings.character_format().unwrap();
    station.long_timeout = settings.has_long_timeout();
    station
}

#[test]
fn follows_restart_with_any_stored_settings() {
    for byte in [0xE4, 0xE0, 0xE6, 0xC4, 0xF5, 0xA4, 0x85, 0x64] {
        let settings = LineSettings::from_byte(byte);
        let mut desk = Desk::with_station(&format!("settings={byte}"), station_for(settings));
        assert_eq!(reset(&mut desk), []);
        assert_eq!(desk.session.station().format, settings.character_format().unwrap(), "{settings}");
        position(&mut desk);
        // No request has kept the encoder at factory settings.
        let now = encoder_studio::link::Clock::now(&*desk.clock);
        let in_force = desk.bus().encoders()[0].active_settings_at(now).unwrap();
        assert_eq!(in_force.character_format(), settings.character_format(), "{settings}");
        assert_eq!(in_force.has_long_timeout(), settings.has_long_timeout(), "{settings}");
        assert_eq!(desk.tap().count(Command::Reset), 1);
    }
}

#[test]
fn stored_settings_apply_after_restart() {
    for byte in [0xE5, 0xC6, 0xB2] {
        let settings = LineSettings::from_byte(byte);
        let mut desk = Desk::new("");
        desk.change(Change::Configure(settings)).unwrap();
        position(&mut desk);
        assert_eq!(desk.session.station().format, CharacterFormat::FACTORY);
        reset(&mut desk);
        assert_eq!(desk.session.station().format, settings.character_format().unwrap());
        position(&mut desk);
        assert_eq!(desk.wear(), 1);
    }
}

#[test]
fn temporary_settings_apply_until_restart() {
    for byte in [0xE6, 0xC0, 0xF5, 0xA6] {
        let settings = LineSettings::from_byte(byte);
        let mut desk = Desk::new("");
        desk.run(HiperfaceJob::ConfigureForNow(settings)).unwrap();
        assert_eq!(desk.session.station().format, settings.character_format().unwrap());
        position(&mut desk);
        reset(&mut desk);
        assert_eq!(desk.session.station().format, CharacterFormat::FACTORY);
        position(&mut desk);
        assert_eq!(desk.wear(), 0, "nothing was stored");
    }
}

/// The replies to 55h and 67h announce a waiting status code. The encoder has accepted the new settings nevertheless.
#[test]
fn follows_encoder_warning_during_change() {
    let warn = |desk: &mut Desk| desk.bus().encoder_mut(0).unwrap().queue_code(StatusCode::TEMPERATURE);
    for at in 0..12 {
        let mut desk = Desk::new("");
        let prepared = desk.prepare(Change::SetAddress(DeviceAddress::new(0x45).unwrap())).unwrap();
        queue_warning_at_frame(&mut desk, at);
        desk.commit(&prepared).unwrap();
        assert_eq!(desk.session.station().address, 0x45, "warning at frame {at}");
        position(&mut desk);

        let mut desk = Desk::new("");
        queue_warning_at_frame(&mut desk, at);
        desk.run(HiperfaceJob::ConfigureForNow(LineSettings::from_byte(0xE6))).unwrap();
        position(&mut desk);
        assert_eq!(desk.session.station().format.baud.bits_per_second(), 38_400, "warning at frame {at}");
    }
    let mut desk = Desk::new("");
    warn(&mut desk);
    desk.change(Change::SetAddress(DeviceAddress::new(0x45).unwrap())).unwrap();
    assert_eq!(desk.session.station().codes_to_display, [StatusCode::TEMPERATURE], "and the code is kept");
}

fn queue_warning_at_frame(desk: &mut Desk, frame: usize) {
    let (bus, mut frames) = (desk.bus.clone(), 0);
    desk.session.add_watcher(move |entry| {
        if entry.direction == encoder_studio::link::Direction::Sent {
            if frames == frame {
                bus.lock().unwrap().encoder_mut(0).unwrap().queue_code(StatusCode::TEMPERATURE);
            }
            frames += 1;
        }
    });
}

#[test]
fn reads_all_startup_codes() {
    let mut desk = Desk::new("temperature=130");
    // One from before the restart and one from the restart itself. Neither is lost.
    assert_eq!(reset(&mut desk), [StatusCode::TEMPERATURE; 2]);
    for code in [0x01, 0x1C, 0x1D, 0x20] {
        desk.bus().encoder_mut(0).unwrap().queue_code(StatusCode::new(code));
    }
    let HiperfaceOutput::Status(codes) = desk.run(HiperfaceJob::Status).unwrap() else { panic!() };
    assert_eq!(codes, [0x01, 0x1C, 0x1D, 0x20].map(StatusCode::new));
    let HiperfaceOutput::Status(codes) = desk.run(HiperfaceJob::Status).unwrap() else { panic!() };
    assert_eq!(codes, []);
}

/// Two encoders with the same address could no longer be addressed separately.
#[test]
fn rejects_address_in_use() {
    let mut desk = Desk::new("encoders=3");
    let refused = desk.prepare(Change::SetAddress(DeviceAddress::new(0x42).unwrap()));
    assert!(refused.is_err(), "{refused:?}");
    assert_eq!(desk.session.station().address, 0x40);
    desk.change(Change::SetAddress(DeviceAddress::new(0x43).unwrap())).unwrap();
    let addresses: Vec<u8> = desk.bus().encoders().iter().map(|encoder| encoder.address().byte()).collect();
    assert_eq!(addresses, [0x43, 0x41, 0x42]);
}
