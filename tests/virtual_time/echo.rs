//! Converters that echo the bytes sent by the host. An echo is detected where possible and never mistaken for a value.

use encoder_studio::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput, Value};
use encoder_studio::devices::hiperface::procedures::{Echo, Station};
use encoder_studio::devices::hiperface::profile::{FieldRange, Item};
use encoder_studio::devices::hiperface::protocol::{Command, LineSettings};

use crate::support::{Desk, MARGIN};

fn desk(echoes: bool, setting: Echo, more: &str) -> Desk {
    let mut station = Station::new(MARGIN);
    station.line.echo = setting;
    Desk::with_station(&format!("echo={}{more}", if echoes { "on" } else { "off" }), station)
}

#[test]
fn detects_and_strips_echo() {
    for echoes in [true, false] {
        let told = if echoes { Echo::On } else { Echo::Off };
        for setting in [Echo::Unknown, told] {
            let mut desk = desk(echoes, setting, "");
            let truth = desk.memory();
            let profile = desk.save().unwrap();
            assert_eq!(profile.fields[0].bytes.as_ref(), Some(&truth[0].1));
            assert_eq!(profile.recorded.position, Some(0x000E_0531));
            assert_eq!(desk.session.station().line.echo, told);
            desk.change(Change::IncrementCounter).unwrap();
            assert_eq!(desk.bus().encoders()[0].counter(), 1);
            assert_eq!(desk.session.station().line.damaged, 0);
        }
    }
}

/// With the wrong echo setting, every reply is rejected, and none of its bytes is shown as a value.
#[test]
fn wrong_echo_setting_yields_errors() {
    for (echoes, setting) in [(true, Echo::Off), (false, Echo::On)] {
        let mut desk = desk(echoes, setting, "");
        let (memory, worn) = (desk.memory(), desk.wear());
        let range = FieldRange::new(0, 0, 4);
        for job in [
            HiperfaceJob::Identify,
            HiperfaceJob::Position(None),
            HiperfaceJob::Status,
            HiperfaceJob::Read(Item::Counter),
            HiperfaceJob::Read(Item::Field(range)),
            HiperfaceJob::Save(Default::default()),
            HiperfaceJob::Prepare(Change::IncrementCounter),
            HiperfaceJob::ConfigureForNow(LineSettings::FACTORY),
        ] {
            let words = format!("echoes: {echoes}, {setting:?}: {job:?}");
            assert!(desk.run(job).is_err(), "{words}");
        }
        assert_eq!((desk.memory(), desk.wear()), (memory, worn));
    }
}

/// The replies to 47h and 67h equal their requests, so they do not prove that there is an echo.
#[test]
fn reply_equal_to_request_is_not_echo() {
    for echoes in [true, false] {
        let mut desk = desk(echoes, Echo::Unknown, "");
        desk.run(HiperfaceJob::ConfigureForNow(LineSettings::FACTORY)).unwrap();
        assert_eq!(desk.tap().sent[0][1], Command::ReadTypeLabel.byte(), "learned with a reading command first");
        assert_eq!(desk.session.station().line.echo, if echoes { Echo::On } else { Echo::Off });
    }
    // Without an encoder, an echo alone is not a reply to either request.
    let mut desk = desk(true, Echo::Unknown, "&fault=silent-after:0");
    desk.run(HiperfaceJob::ConfigureForNow(LineSettings::FACTORY)).unwrap_err();
    assert_eq!(desk.session.station().line.echo, Echo::Unknown);
    assert_eq!(desk.tap().count(Command::ConfigureLineTemporarily), 0);
}

/// The reply to a read request equals the request if the byte has the value of the access code.
#[test]
fn reads_byte_equal_to_access_code() {
    for echoes in [true, false] {
        let mut desk = desk(echoes, Echo::Unknown, "");
        desk.change(Change::Store(vec![(FieldRange::new(0, 7, 1), vec![0x55])])).unwrap();
        let item = Item::Field(FieldRange::new(0, 7, 1));
        let HiperfaceOutput::Value(value) = desk.run(HiperfaceJob::Read(item)).unwrap() else { panic!() };
        assert_eq!(value, Value::Bytes(vec![0x55]));
    }
}
