//! Identifying the adapter, setting it up for reading words, and reading a single word.

use encoder_studio::buses::bridge::procedures::AdapterError;
use encoder_studio::buses::bridge::protocol::{Capabilities, Operation};
use encoder_studio::devices::ssi::jobs::{SsiJob, SsiOutput};
use encoder_studio::devices::ssi::procedures::{ClockSettings, Error, Identity, Supply};

use super::support::{QUICK, Stand};

fn hello(stand: &mut Stand) -> Identity {
    match stand.session.run_inline(SsiJob::Hello).unwrap() {
        SsiOutput::Hello(identity) => *identity,
        other => panic!("{other:?}"),
    }
}

fn set(stand: &mut Stand, clock_settings: ClockSettings) -> Result<Identity, Error> {
    stand.session.run_inline(SsiJob::Set(clock_settings)).map(|output| match output {
        SsiOutput::Set(identity) => *identity,
        other => panic!("{other:?}"),
    })
}

#[test]
fn hello_reports_adapter_and_word_settings() {
    let mut stand = Stand::new("voltage=24&clock=700000", "supply=switched");
    let error = stand.session.run_inline(SsiJob::Hello).unwrap_err();
    assert!(matches!(error, Error::Adapter(AdapterError::Refused { operation: Operation::Supply, .. })), "{error}");
    let mut stand = Stand::new("voltage=12&clock=700000", "supply=switched");
    let identity = hello(&mut stand);
    assert_eq!((identity.hello.name.as_str(), identity.hello.firmware.as_str()), ("virtual adapter", "1.0"));
    assert!(identity.hello.capabilities.contains(Capabilities::SSI));
    assert_eq!(identity.clock_settings, ClockSettings { clocks: 25, clock_hz: 700_000, pause_us: 200 });
    // The nearest clock below is 60 MHz divided by 86.
    assert_eq!(identity.clock_hz, 697_674);
    // The encoder takes 300 mW at 12 V.
    assert_eq!(identity.supply, Some(Supply { millivolt: 12_000, measured: Some((12_000, 25)) }));
    // Known data are not requested again.
    assert_eq!(hello(&mut stand), identity);
    let counts = [Operation::Hello, Operation::Supply, Operation::SsiConfig].map(|own| stand.count(own));
    assert_eq!(counts, [1, 1, 1]);
    // A supply that the session has switched on is switched off at its end (issue 22.16).
    stand.session.restore_state();
    assert_eq!(stand.count(Operation::Supply), 2);
}

#[test]
fn supply_stays_off_unless_requested() {
    let mut stand = Stand::new("", "supply=switched");
    assert_eq!((hello(&mut stand).supply, stand.count(Operation::Supply)), (None, 0));
}

/// An ATM60 with factory settings has 12 bits of turns and 13 bits of steps in Gray code. The shaft is at turn 1234h
/// and 270°, which is turn 234h of 4096 and step 1800h of 8192. The Gray code of this word is 0x469800 ^ 0x234C00.
#[test]
fn reads_word_with_requested_clocks() {
    let mut stand = Stand::new("", "ssi=atm60,code=gray&position=0x24698000");
    let words = stand.read();
    assert_eq!((words.words.as_slice(), words.clocks, words.first, words.lost), (&[0x65_D400][..], 25, 0, 0));
    assert!(words.is_stream_start() && !words.is_streamed() && !words.is_limited && words.period_ns == 0);
    // With more clocks than bits, zeros follow the frame. With fewer, only its first bits are read.
    assert_eq!(set(&mut stand, ClockSettings { clocks: 27, ..QUICK }).unwrap().clock_hz, 1_500_000);
    let longer = stand.read();
    assert_eq!((longer.words.as_slice(), longer.clocks, longer.first), (&[0x65_D400 << 2][..], 27, 0));
    set(&mut stand, ClockSettings { clocks: 13, ..QUICK }).unwrap();
    assert_eq!(stand.read().words, [0x65_D400 >> 12]);
    let configured: Vec<u8> = stand.requests(Operation::SsiConfig).iter().map(|packet| packet.body[0]).collect();
    assert_eq!(configured, [25, 27, 13]);
}

/// The adapter rejects a setting.
#[test]
fn rejected_setting_keeps_previous_one() {
    let mut stand = Stand::quick("rpm=60");
    assert_eq!(stand.read().clocks, 25);
    for clock_settings in [
        ClockSettings { clocks: 0, ..QUICK },
        ClockSettings { clocks: 65, ..QUICK },
        ClockSettings { clock_hz: 1000, ..QUICK },
    ] {
        let error = set(&mut stand, clock_settings).unwrap_err();
        assert!(
            matches!(error, Error::Adapter(AdapterError::Refused { operation: Operation::SsiConfig, .. })),
            "{error}"
        );
        let words = stand.read();
        assert_eq!((words.clocks, words.clock_hz), (25, 1_500_000), "{clock_settings:?}");
    }
}

#[test]
fn version_error_names_both_versions() {
    let mut stand = Stand::new("", "version=2");
    let error = stand.session.run_inline(SsiJob::Hello).unwrap_err();
    assert_eq!(error, Error::Adapter(AdapterError::Version { expected: 1, got: 2 }));
}

/// The request is repeated once, as in the reference.
#[test]
fn reports_silent_adapter_after_two_tries() {
    let mut stand = Stand::new("", "fault=silent-after:0");
    let error = stand.session.run_inline(SsiJob::Hello).unwrap_err();
    assert_eq!((error, stand.count(Operation::Hello)), (Error::Adapter(AdapterError::Silent), 2));
}

/// One byte in a hundred is lost, so a quarter of all exchanges fail. The values read are still correct.
#[test]
fn rerequests_words_on_lossy_line() {
    for seed in 0..20 {
        let mut stand = Stand::new("", &format!("position=0x24698000&seed={seed}&fault=drop:0.01"));
        for _ in 0..50 {
            assert_eq!(stand.read().words, [0x65_D400], "{seed}");
        }
    }
}
