//! Tests with handwritten Modbus/TCP frames.

use super::*;
use crate::sim::ByteDevice;

pub(super) struct Host {
    pub(super) gateway: Gateway,
    pub(super) now: Moment,
}

impl Host {
    pub(super) fn with(query: &str) -> Self {
        Host { gateway: Gateway::new(&config(&format!("stale=0&busy=0&{query}"))), now: Moment::START }
    }

    /// Connects another client to the same gateway.
    fn second_client(&self) -> Host {
        Host { gateway: self.gateway.new_connection(), now: self.now }
    }

    /// Sends a request and returns the bytes received within ten milliseconds.
    pub(super) fn ask(&mut self, request: &str) -> String {
        self.gateway.on_bytes(self.now, &bytes(request));
        self.now = self.now + Duration::from_millis(10);
        hex(&self.gateway.poll(self.now))
    }

    #[track_caller]
    fn exchange(&mut self, exchanges: &[(&str, &str)]) {
        for (request, reply) in exchanges {
            assert_eq!(self.ask(request), *reply, "{request}");
        }
    }
}

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(" ")
}

const READ: &str = "00 01 00 00 00 06 01 04 00 00 00 02";

#[test]
fn words_span_two_registers() {
    // 1193046 is 123456h. The gear drops one of 33554432 steps, so this is the position at disc position 123457h.
    let mut host = Host::with("position=1193047");
    host.exchange(&[
        (READ, "00 01 00 00 00 07 01 04 04 00 12 34 56"),
        ("AB CD 00 00 00 06 01 03 00 00 00 02", "AB CD 00 00 00 07 01 03 04 00 00 00 00"),
        ("00 02 00 00 00 0B 01 10 00 00 00 02 04 02 00 01 68", "00 02 00 00 00 06 01 10 00 00 00 02"),
        (READ, "00 01 00 00 00 07 01 04 04 C2 00 01 68"),
        ("00 03 00 00 00 06 01 03 00 00 00 02", "00 03 00 00 00 07 01 03 04 02 00 01 68"),
        ("00 04 00 00 00 06 01 04 00 01 00 01", "00 04 00 00 00 05 01 04 02 01 68"),
    ]);
}

#[test]
fn register_layout_is_configurable() {
    let mut host = Host::with("position=1193047&order=low-first&unit=17&input=100&output=0x200");
    host.exchange(&[
        ("00 01 00 00 00 06 11 04 00 64 00 02", "00 01 00 00 00 07 11 04 04 34 56 00 12"),
        ("00 02 00 00 00 0B 11 10 02 00 00 02 04 01 68 02 00", "00 02 00 00 00 06 11 10 02 00 00 02"),
        ("00 01 00 00 00 06 11 04 00 64 00 02", "00 01 00 00 00 07 11 04 04 01 68 C2 00"),
        ("00 01 00 00 00 06 11 04 00 63 00 02", "00 01 00 00 00 03 11 84 02"),
        ("00 01 00 00 00 06 01 04 00 64 00 02", "00 01 00 00 00 03 01 84 0B"),
        ("00 01 00 00 00 06 00 04 00 64 00 02", "00 01 00 00 00 03 00 84 0B"),
    ]);
}

/// The encoder processes half a word, written by function 6, before the other half is written.
#[test]
fn single_register_holds_half_word() {
    let mut host = Host::with("position=0");
    host.exchange(&[
        ("00 01 00 00 00 06 01 06 00 00 02 00", "00 01 00 00 00 06 01 06 00 00 02 00"),
        (READ, "00 01 00 00 00 07 01 04 04 82 00 00 00"),
        ("00 02 00 00 00 06 01 06 00 01 01 68", "00 02 00 00 00 06 01 06 00 01 01 68"),
        (READ, "00 01 00 00 00 07 01 04 04 C2 00 01 68"),
    ]);
}

#[test]
fn invalid_requests_get_matching_exception() {
    let mut host = Host::with("");
    let cases = [
        ("a function of coils", "00 01 00 00 00 06 01 01 00 00 00 02", "81 01"),
        ("a function with no data", "00 01 00 00 00 02 01 07", "87 01"),
        ("writing coils", "00 01 00 00 00 08 01 0F 00 00 00 01 01 01", "8F 01"),
        ("no registers", "00 01 00 00 00 06 01 04 00 00 00 00", "84 03"),
        ("too many for a frame", "00 01 00 00 00 06 01 04 00 00 00 7E", "84 03"),
        ("too short", "00 01 00 00 00 05 01 04 00 00 00", "84 03"),
        ("too long", "00 01 00 00 00 07 01 04 00 00 00 02 00", "84 03"),
        ("more than there are", "00 01 00 00 00 06 01 04 00 00 00 03", "84 02"),
        ("behind the last", "00 01 00 00 00 06 01 03 00 02 00 01", "83 02"),
        ("at the end of all", "00 01 00 00 00 06 01 04 FF FF 00 7D", "84 02"),
        ("writing behind the last", "00 01 00 00 00 06 01 06 00 02 00 00", "86 02"),
        ("a count that does not fit", "00 01 00 00 00 0B 01 10 00 00 00 01 04 02 00 01 68", "90 03"),
        ("bytes that are not there", "00 01 00 00 00 09 01 10 00 00 00 02 04 02 00", "90 03"),
        ("an odd number of bytes", "00 01 00 00 00 0A 01 10 00 00 00 02 03 02 00 01", "90 03"),
        ("three registers", "00 01 00 00 00 0D 01 10 00 00 00 03 06 02 00 01 68 00 00", "90 02"),
    ];
    for (what, request, exception) in cases {
        assert_eq!(host.ask(request), format!("00 01 00 00 00 03 01 {exception}"), "{what}");
    }
    assert_eq!(host.gateway.with_encoder(|encoder| (encoder.out_word(), encoder.store_count())), (0, 3));
}

#[test]
fn accepts_split_and_joined_frames() {
    let mut host = Host::with("position=1193047");
    let reply = "00 01 00 00 00 07 01 04 04 00 12 34 56";
    let all = bytes(READ);
    for cut in 0..all.len() {
        assert_eq!(host.ask(&hex(&all[..cut])), "", "{cut}");
        assert_eq!(host.ask(&hex(&all[cut..])), reply, "{cut}");
    }
    assert_eq!(host.ask(&format!("{READ} {READ}")), format!("{reply} {reply}"));
    // Bytes that are not Modbus are discarded, together with all bytes received at the same time.
    for nonsense in ["00 01 00 01 00 06 01 04 00 00 00 02", "00 01 00 00 00 00 01", "00 01 00 00 00 FF 01 04"] {
        assert_eq!(host.ask(nonsense), "", "{nonsense}");
        assert_eq!(host.ask(READ), reply, "{nonsense}");
    }
}

#[test]
fn encoders_have_consecutive_registers() {
    let mut host = Host::with("encoders=2&serial=4000&position=0&steps=360&revolutions=1");
    host.exchange(&[
        ("00 01 00 00 00 0B 01 10 00 02 00 02 04 20 21 00 00", "00 01 00 00 00 06 01 10 00 02 00 02"),
        ("00 02 00 00 00 06 01 04 00 00 00 04", "00 02 00 00 00 0B 01 04 08 00 00 00 00 A0 00 0F A1"),
        ("00 02 00 00 00 06 01 04 00 01 00 02", "00 02 00 00 00 07 01 04 04 00 00 A0 00"),
        // One request writes to both encoders, beginning with the lower half of the first one's word.
        ("00 03 00 00 00 0D 01 10 00 01 00 03 06 00 00 00 00 00 00", "00 03 00 00 00 06 01 10 00 01 00 03"),
        ("00 02 00 00 00 06 01 04 00 02 00 02", "00 02 00 00 00 07 01 04 04 00 00 00 00"),
        ("00 02 00 00 00 06 01 04 00 03 00 02", "00 02 00 00 00 03 01 84 02"),
    ]);
}

#[test]
fn clients_share_encoder() {
    let mut host = Host::with("position=0");
    let mut other = host.second_client();
    host.exchange(&[("00 01 00 00 00 0B 01 10 00 00 00 02 04 02 00 01 68", "00 01 00 00 00 06 01 10 00 00 00 02")]);
    // The length in the header is checked. The example printed in the manual (reference 5) is rejected, because it is
    // one byte too short.
    assert_eq!(host.ask("00 05 00 00 00 06"), "");
    other.exchange(&[
        (READ, "00 01 00 00 00 07 01 04 04 C2 00 01 68"),
        ("00 02 00 00 00 0B 01 10 00 00 00 02 04 04 00 00 01", "00 02 00 00 00 06 01 10 00 00 00 02"),
    ]);
    assert_eq!(host.ask("01 04 00 00 00 02"), "00 05 00 00 00 07 01 04 04 C4 00 00 01");
    // A client that disconnects and reconnects finds the encoder unchanged.
    other.gateway.connect(other.now);
    assert_eq!(other.ask(READ), "00 01 00 00 00 07 01 04 04 C4 00 00 01");
}

#[test]
fn delayed_replies_stay_in_order() {
    let mut host = Host::with("position=0&fault=delay:100");
    host.gateway.on_bytes(host.now, &bytes(READ));
    let due = Moment::START + Duration::from_millis(102);
    assert_eq!((host.gateway.poll_at(), host.gateway.poll(due - Duration::from_nanos(1))), (Some(due), Vec::new()));
    assert_eq!((host.gateway.poll(due).len(), host.gateway.poll_at()), (13, None));
}

#[test]
fn injects_configured_faults() {
    let good = "00 01 00 00 00 07 01 04 04 00 00 00 00";
    let mut silent = Host::with("position=0&fault=silent-after:2");
    silent.exchange(&[(READ, good), (READ, good), (READ, ""), (READ, "")]);
    Host::with("fault=drop:1").exchange(&[(READ, "")]);
    Host::with("exception=1").exchange(&[(READ, "00 01 00 00 00 03 01 84 0B")]);
    let mut flipped = Host::with("position=0&fault=flip:1");
    let (mine, theirs) = (bytes(good), bytes(&flipped.ask(READ)));
    assert_eq!(mine.iter().zip(&theirs).map(|(one, other)| (one ^ other).count_ones()).sum::<u32>(), 1);
    let mut noisy = Host::with("position=0&fault=garbage:1");
    let garbage = bytes(&noisy.ask(READ));
    assert_eq!(garbage.len(), mine.len());
    assert_ne!(garbage, mine);
    // The same seed causes the same faults.
    let some =
        |seed| (0..50).map(|_| 0).scan(Host::with(seed), |host, _| Some(host.ask(READ).len())).collect::<Vec<_>>();
    let lossy = "position=0&fault=drop:0.5&seed=7";
    assert_eq!(some(lossy), some(lossy));
    assert_ne!(some(lossy), some("position=0&fault=drop:0.5&seed=8"));
}

/// A request that the gateway rejects has no effect on the encoder. A request whose reply is lost does.
#[test]
fn gateway_exception_blocks_write() {
    let mut host = Host::with("exception=1");
    let write = "00 01 00 00 00 0B 01 10 00 00 00 02 04 02 00 01 68";
    host.exchange(&[(write, "00 01 00 00 00 03 01 90 0B")]);
    assert_eq!(host.gateway.with_encoder(|encoder| encoder.out_word()), 0);
    let mut lost = Host::with("fault=drop:1");
    lost.exchange(&[(write, "")]);
    assert_eq!(lost.gateway.with_encoder(|encoder| encoder.out_word()), 0x0200_0168);
    lost.gateway.set_faults(&crate::sim::SimulatedFaults::default());
    lost.exchange(&[(write, "00 01 00 00 00 06 01 10 00 00 00 02")]);
}

#[test]
fn unpowered_encoder_needs_new_connection() {
    let mut host = Host::with("position=0&fault=die-in-store:1");
    host.exchange(&[
        ("00 01 00 00 00 0B 01 10 00 00 00 02 04 06 00 00 03", "00 01 00 00 00 06 01 10 00 00 00 02"),
        ("00 01 00 00 00 0B 01 10 00 00 00 02 04 80 00 00 00", "00 01 00 00 00 06 01 10 00 00 00 02"),
        (READ, "00 01 00 00 00 03 01 84 0B"),
        ("00 01 00 00 00 0B 01 10 00 00 00 02 04 00 00 00 00", "00 01 00 00 00 03 01 90 0B"),
    ]);
    let mut other = host.second_client();
    other.gateway.connect(host.now);
    host.exchange(&[(READ, "00 01 00 00 00 07 01 04 04 86 00 00 00")]);
}

#[test]
fn motor_handle_turns_shaft() {
    let mut host = Host::with("position=0&steps=8192&revolutions=1");
    let motor = host.gateway.shaft_motor();
    assert_eq!(host.ask(READ), "00 01 00 00 00 07 01 04 04 00 00 00 00");
    motor.set_rpm(60.0);
    host.ask(READ);
    host.now = host.now + Duration::from_millis(490);
    // The shaft has made half a turn since the previous request, 500 ms earlier.
    assert_eq!(host.ask(READ), "00 01 00 00 00 07 01 04 04 00 00 10 00");
}
