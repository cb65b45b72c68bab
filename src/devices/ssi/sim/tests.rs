//! Tests of the virtual SSI encoder and its settings, as seen by a host.

use std::time::Duration;

use proptest::prelude::*;

use super::AttachableEncoder;
use crate::buses::bridge::protocol::*;
use crate::buses::bridge::sim::AttachableKind;
use crate::buses::bridge::sim::tests::{Host, SSI, TestBissDevice};
use crate::sim::ConfigError;
use crate::sim::setting::query_pairs;

/// Creates a host with the encoder on a test shaft.
fn host_with_test_device(query: &str) -> Host {
    Host::to(query, &[&AttachableEncoder::DEFAULT_ADAPTER, &TestBissDevice::SETTINGS])
}

fn read(query: &str) -> Result<(), ConfigError> {
    AttachableEncoder::DEFAULT_ADAPTER.attach_device(&query_pairs(query)).map(|_| ())
}

/// The shaft is at 270.0° of turn 1234h. The SSI position contains the lowest 12 bits of the turns and the highest 13
/// bits of the steps.
#[test]
fn words_follow_code_preset_and_direction() {
    let natural = 0x234 << 13 | 0x1800;
    for (query, word) in [
        ("ssi=atm60", natural),
        ("ssi=atm60,code=gray", natural ^ natural >> 1),
        ("ssi=atm60,preset=8192", 0x235 << 13 | 0x1800),
        ("ssi=atm60,direction=ccw", (1 << 25) - natural),
        ("ssi=atm60,direction=ccw,preset=1", (1 << 25) - natural + 1),
    ] {
        let mut host = host_with_test_device(query);
        host.refuses(Request::SsiRead, ErrorCode::BAD_ARGUMENT);
        host.expect(SSI, Reply::SsiConfig { clock_hz: 500_000 });
        let Some(Message::Reply(Reply::SsiRead { raw, .. })) = host.ask(Request::SsiRead) else { panic!() };
        assert_eq!(raw, word, "{query}");
        host.ask(Request::SsiConfig { clocks: 26, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE });
        host.ask(Request::SsiStream { period_us: 100 });
        let packets = host.stream(100);
        let mut words = packets.iter().flat_map(|data| match data {
            StreamData::Ssi(data) => data.values.clone(),
            other => panic!("{other:?}"),
        });
        assert!(words.clone().count() > 900 && words.all(|raw| raw == word << 1), "{query}");
    }
    let mut host = host_with_test_device("");
    for clocks in [0, 65] {
        let wrong = Request::SsiConfig { clocks, clock_hz: 500_000, pause_us: 30, flags: SsiFlags::FALLING_EDGE };
        host.refuses(wrong, ErrorCode::BAD_ARGUMENT);
    }
}

#[test]
fn reports_invalid_values() {
    let sentence = "`ssi-error=ERRDIG` is not valid (allowed: ERROR, separated by commas; append :SECONDS to make an \
                    error recur)";
    assert_eq!(read("ssi=ahm36&ssi-error=ERRDIG").unwrap_err().to_string(), sentence);
    // The order of the two settings does not matter.
    assert_eq!(read("ssi-error=ERRDIG&ssi=ahm36").unwrap_err().to_string(), sentence);
    assert_eq!(read("ssi-error=error:2&ssi=ahm36,st=12"), Ok(()));
    let none = read("ssi-error=ERROR").unwrap_err().to_string();
    assert!(none.contains("no value, because the frame of this encoder has no error bits"), "{none}");
    assert!(matches!(read("ssi=x"), Err(ConfigError::Value { .. })));
}

proptest! {
    #[test]
    fn arbitrary_values_do_not_panic(key in 0..2_usize, value in ".*") {
        let _ = AttachableEncoder::DEFAULT_ADAPTER.attach_device(&[(AttachableEncoder::DEFAULT_ADAPTER.setting_names()[key].to_owned(), value)]);
    }
}

/// The shaft turns even if no other device is attached. At 60 rpm, a revolution of 2^13 steps takes a second.
#[test]
fn encoder_turns_without_other_devices() {
    let mut host = Host::to("ssi=atm60,code=binary&rpm=60", &[&AttachableEncoder::DEFAULT_ADAPTER]);
    host.expect(SSI, Reply::SsiConfig { clock_hz: 500_000 });
    let mut words = (0..3).map(|_| {
        host.receive(host.now + Duration::from_millis(200));
        let Some(Message::Reply(Reply::SsiRead { t_us, raw })) = host.ask(Request::SsiRead) else { panic!() };
        assert_eq!(raw, t_us * 8192 / 1_000_000, "at {t_us} µs");
        raw
    });
    let (first, last) = (words.next().unwrap(), words.last().unwrap());
    assert!(last - first > 3000, "{first} to {last}");
}
