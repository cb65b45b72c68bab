//! A target with scripted replies: published bytes of the reference (section 9), and every possible error in a reply.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::buses::ethernet_ip::protocol::{EncapsulationStatus, GeneralStatus};
use encoder_studio::devices::hiperdrive::procedures::{Error, Master, RequestedItem, Station, read_rules};
use encoder_studio::devices::hiperdrive::protocol::{Topology, Value};
use encoder_studio::link::{ByteLink, CancelToken, Clock, Ctx, LinkError, Trace, VirtualClock};
use encoder_studio::units::{CharacterFormat, Moment};

use super::support::{drive, number};

/// How the target reacts to a request.
enum Act {
    /// A CIP reply in a frame with the context of the request.
    Reply(&'static str),
    /// An empty frame with this status.
    Status(u32),
    /// A reply with the wrong request number, like a reply to an earlier request.
    Stale(&'static str),
    /// No reply is sent.
    Silence,
    /// These bytes are sent unchanged.
    Bytes(&'static str),
}

/// A target that reacts according to a list.
#[derive(Default)]
struct Script {
    acts: VecDeque<Act>,
    sent: Vec<Vec<u8>>,
    answers: Vec<u8>,
    registered: u32,
}

struct Wire {
    script: Arc<Mutex<Script>>,
    clock: Arc<VirtualClock>,
}

fn bytes(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

/// The reply to RegisterSession from the reference, with session 12345678.
const REGISTER_SESSION_REPLY: &str =
    "65 00 04 00 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 01 00 00 00";

fn frame(context: &[u8], status: u32, cip: &[u8]) -> Vec<u8> {
    let length = cip.len() as u16;
    let mut data = if cip.is_empty() { Vec::new() } else { bytes("00 00 00 00 00 00 02 00 00 00 00 00 B2 00") };
    if !cip.is_empty() {
        data.extend(length.to_le_bytes());
        data.extend(cip);
    }
    let mut frame = bytes("6F 00");
    frame.extend((data.len() as u16).to_le_bytes());
    frame.extend(bytes("78 56 34 12"));
    frame.extend(status.to_le_bytes());
    frame.extend(context);
    frame.extend([0; 4]);
    frame.extend(data);
    frame
}

impl ByteLink for Wire {
    fn send(&mut self, sent: &[u8]) -> Result<(), LinkError> {
        let mut script = self.script.lock().unwrap();
        script.sent.push(sent.to_vec());
        let context = &sent[12..20];
        if sent[0] == 0x65 {
            script.registered += 1;
            let mut reply = bytes(REGISTER_SESSION_REPLY);
            reply.splice(12..20, context.iter().copied());
            script.answers.extend(reply);
            return Ok(());
        }
        let answer = match script.acts.pop_front() {
            Some(Act::Reply(cip)) => frame(context, 0, &bytes(cip)),
            Some(Act::Status(status)) => frame(context, status, &[]),
            Some(Act::Stale(cip)) => frame(&[0xEE; 8], 0, &bytes(cip)),
            Some(Act::Bytes(text)) => bytes(text),
            Some(Act::Silence) | None => Vec::new(),
        };
        script.answers.extend(answer);
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let mut script = self.script.lock().unwrap();
        if script.answers.is_empty() {
            self.clock.sleep_until(until);
        }
        // The bytes arrive in small portions.
        let count = script.answers.len().min(7);
        into.extend(script.answers.drain(..count));
        Ok(())
    }

    fn set_format(&mut self, _format: CharacterFormat) -> Result<(), LinkError> {
        Ok(())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

/// A session with a scripted target.
struct Desk {
    script: Arc<Mutex<Script>>,
    wire: Box<dyn ByteLink>,
    clock: Arc<VirtualClock>,
    station: Station,
}

impl Desk {
    fn with(acts: impl IntoIterator<Item = Act>) -> Self {
        let script = Script { acts: acts.into_iter().collect(), ..Script::default() };
        let (script, clock) = (Arc::new(Mutex::new(script)), Arc::new(VirtualClock::default()));
        let wire = Box::new(Wire { script: script.clone(), clock: clock.clone() });
        Desk { script, wire, clock, station: Station::new(Duration::from_millis(20)) }
    }

    fn ask<T>(&mut self, work: impl FnOnce(&mut Master<'_>) -> T) -> T {
        self.ask_with_cancel(CancelToken::default(), work)
    }

    fn ask_with_cancel<T>(&mut self, cancel: CancelToken, work: impl FnOnce(&mut Master<'_>) -> T) -> T {
        let mut trace = Trace::default();
        let ctx = Ctx { wire: &mut *self.wire, clock: &*self.clock, cancel: &cancel, trace: &mut trace };
        work(&mut Master::new(ctx, &mut self.station))
    }

    fn read(&mut self, own: u16) -> Result<Value, Error> {
        self.ask(|master| master.read(number(own)))
    }

    fn sent(&self) -> Vec<Vec<u8>> {
        self.script.lock().unwrap().sent.clone()
    }

    fn registered(&self) -> u32 {
        self.script.lock().unwrap().registered
    }
}

/// Returns a frame with its context set to 0.
fn without_context(frame: &[u8]) -> Vec<u8> {
    let mut frame = frame.to_vec();
    frame[12..20].fill(0);
    frame
}

const POSITION_163840_REPLY: &str = "8E 00 00 00 00 80 02 00";

#[test]
fn requests_match_reference() {
    let mut desk = Desk::with([Act::Reply(POSITION_163840_REPLY), Act::Reply("8E 00 00 00 01 00")]);
    assert_eq!(desk.read(107).unwrap(), Value::Number(163_840));
    assert_eq!(desk.read(47).unwrap(), Value::Number(1));
    let register = "65 00 04 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 01 00 00 00";
    let get_107 = "6F 00 18 00 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 \
        00 00 02 00 00 00 00 00 B2 00 08 00 0E 03 20 65 24 01 30 6B";
    let get_47 = "6F 00 18 00 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 \
        00 00 02 00 00 00 00 00 B2 00 08 00 0E 03 20 64 24 01 30 2F";
    let sent = desk.sent();
    let shown: Vec<_> = sent.iter().map(|frame| without_context(frame)).collect();
    assert_eq!(shown, [bytes(register), bytes(get_107), bytes(get_47)]);
    let contexts: Vec<&[u8]> = sent.iter().map(|frame| &frame[12..20]).collect();
    assert!(contexts[0] != contexts[1] && contexts[1] != contexts[2], "each request has its own number");
}

#[test]
fn skips_and_counts_unrelated_replies() {
    let mut desk = Desk::with([Act::Stale("8E 00 00 00 FF FF FF FF"), Act::Silence, Act::Reply(POSITION_163840_REPLY)]);
    assert_eq!(desk.read(107).unwrap(), Value::Number(163_840));
    assert_eq!(
        (desk.station.late_reply_count(), desk.sent().len()),
        (1, 4),
        "it was asked three times, in one session"
    );
}

#[test]
fn reopens_forgotten_session() {
    let mut desk = Desk::with([Act::Reply(POSITION_163840_REPLY), Act::Status(0x64), Act::Reply("8E 00 00 00 05 00")]);
    desk.read(107).unwrap();
    assert_eq!(desk.read(105).unwrap(), Value::Number(5));
    assert_eq!(desk.registered(), 2);
}

#[test]
fn reports_other_frame_errors() {
    let mut desk = Desk::with([Act::Status(0x02)]);
    let refused =
        Error::Encapsulation { requested: RequestedItem::Parameter(number(107)), status: EncapsulationStatus::new(2) };
    assert_eq!(desk.read(107), Err(refused));
}

#[test]
fn values_have_type_and_sign() {
    for (own, cip, value) in [
        (119, "8E 00 00 00 1F", Value::Number(31)),
        (119, "8E 00 00 00 F6", Value::Number(-10)),
        (11, "8E 00 00 00 1F 00", Value::Number(31)),
        (11, "8E 00 00 00 F6 FF", Value::Number(-10)),
        // Parameter 186 has 16 bits (manual 6.2, issue 21.9).
        (186, "8E 00 00 00 FF 00", Value::Number(255)),
        (188, "8E 00 00 00 FD", Value::Number(253)),
        (24, "8E 00 00 00 FF FF FF FF", Value::Number(4_294_967_295)),
        (106, "8E 00 00 00 FF FF", Value::Number(-1)),
        (107, "8E 00 00 00 FF FF FF FF", Value::Number(-1)),
        (13, "8E 00 00 00 48 49 50 45", Value::Text("HIPE".to_owned())),
        (13, "8E 00 00 00 04 48 49 50 45", Value::Text("HIPE".to_owned())),
    ] {
        assert_eq!(Desk::with([Act::Reply(cip)]).read(own).unwrap(), value, "{own}: {cip}");
    }
}

/// The value is rejected in every reply, and the message states both lengths (issue 21.9).
#[test]
fn wrong_length_error_names_both_lengths() {
    const REPLIES: [&str; 5] =
        ["8E 00 00 00", "8E 00 00 00 01", "8E 00 00 00 01 00", "8E 00 00 00 01 00 00", "8E 00 00 00 01 00 00 00"];
    // The numbers of bits are those of the manual's table (6.2).
    for (own, length) in
        [(11, 2), (47, 2), (107, 4), (108, 2), (119, 1), (152, 1), (158, 4), (182, 2), (186, 2), (188, 1), (190, 4)]
    {
        for (got, reply) in REPLIES.into_iter().enumerate() {
            let mut desk = Desk::with([Act::Reply(reply)]);
            match desk.read(own) {
                Ok(value) => assert_eq!((got, value), (length, Value::Number(1)), "{own}"),
                Err(Error::Length(error)) => {
                    assert_eq!((error.number, error.expected, error.got), (number(own), length, got), "{own}");
                    assert!(got != length);
                }
                Err(error) => panic!("{own}: {error}"),
            }
            assert_eq!(desk.sent().len(), 2, "it is no damage of the way, and not asked again");
        }
    }
    let error = Desk::with([Act::Reply("8E 00 00 00 02 00")]).read(107).unwrap_err();
    assert_eq!(
        error.to_string(),
        "parameter 107 (actual position) has the wrong length (bytes received: 2, expected: 4)"
    );
    // The rules of a drive must not be read from a truncated number.
    let replies = ["8E 00 00 00 01", "8E 00 00 00 00 01", "8E 00 00 00 01 00", "8E 00 00 00 00 FF"].map(Act::Reply);
    let error = Desk::with(replies).ask(|master| read_rules(master, drive(1))).unwrap_err();
    assert_eq!(error.to_string(), "parameter 158 (lower limit) has the wrong length (bytes received: 2, expected: 4)");
    // Nor is it the reason of a rejection: parameter 120 with one byte does not prove that a slot is empty.
    let refused =
        Desk::with(["8E 00 0C 00", "8E 00 00 00 00", "8E 00 00 00 01"].map(Act::Reply)).read(258).unwrap_err();
    assert!(matches!(refused, Error::Refused { .. }), "{refused}");
}

#[test]
fn refusal_names_parameter() {
    let mut desk = Desk::with([Act::Reply("8E 00 05 00")]);
    let error = desk.read(13).unwrap_err();
    let refusal = error.as_refusal().unwrap();
    assert_eq!(refusal.status, GeneralStatus::new(5));
    assert_eq!(error.to_string(), "reading parameter 13 (category): 0x05 path unknown");
    // For a drive, the program also reads whether it exists: parameter 120 is 0 if it does not.
    let mut desk = Desk::with([Act::Reply("8E 00 0C 00"), Act::Reply("8E 00 00 00 00 00")]);
    assert_eq!(desk.read(258), Err(Error::NoDrive { drive: drive(2) }));
    // Parameter 152 states whether the drive is requested.
    for (requested, is_refused) in [("8E 00 00 00 00", false), ("8E 00 00 00 01", true)] {
        let replies = ["8E 00 0C 00", "8E 00 00 00 07 00", requested];
        let error = Desk::with(replies.map(Act::Reply)).read(258).unwrap_err();
        assert_eq!(matches!(error, Error::Refused { .. }), is_refused, "{error}");
        assert_eq!(error == Error::NotRequested { drive: drive(2) }, !is_refused, "{error}");
    }
}

#[test]
fn skips_unknown_and_write_only_parameters() {
    let mut desk = Desk::with([]);
    assert_eq!(desk.read(155), Err(Error::Unknown(number(155))));
    assert_eq!(desk.read(199), Err(Error::WriteOnly { number: number(199), name: "reset drive" }));
    assert!(desk.sent().is_empty());
}

#[test]
fn retries_corrupt_frames() {
    for broken in [
        // A length that no frame can have, a truncated frame, and an invalid message.
        "6F 00 FF FF 78 56 34 12 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00",
        "6F 00 18 00 78 56",
        "55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA 55 AA",
    ] {
        let mut desk = Desk::with([Act::Bytes(broken), Act::Reply(POSITION_163840_REPLY)]);
        assert_eq!(desk.read(107).unwrap(), Value::Number(163_840), "{broken}");
    }
    let mut desk = Desk::with([Act::Reply("90 00 00 00"), Act::Reply(POSITION_163840_REPLY)]);
    assert_eq!(desk.read(107).unwrap(), Value::Number(163_840), "a reply to another service");
    let mut desk = Desk::with([]);
    let error = desk.read(107).unwrap_err();
    assert_eq!(error, Error::NoReply { requested: RequestedItem::Parameter(number(107)), tries: 5, late: None });
    assert!(error.is_lost() && desk.clock.now() < Moment::from_elapsed(Duration::from_secs(10)));
}

/// Repeated requests to a device that does not answer must not delay other work.
#[test]
fn can_cancel_reading_limits() {
    let mut desk = Desk::with([]);
    let cancel = CancelToken::default();
    cancel.request();
    assert_eq!(desk.ask_with_cancel(cancel.clone(), |master| read_rules(master, drive(1))), Err(Error::Cancelled));
    assert_eq!(desk.clock.now(), Moment::START, "nothing was waited for");
    // After a write, the state must become known, so this reading ignores the cancellation.
    let ended = desk.ask_with_cancel(cancel, |master| master.run_uncancellable(|master| read_rules(master, drive(1))));
    assert!(matches!(ended, Err(Error::NoReply { .. })), "{ended:?}");
}

/// The ForwardOpen request from the reference, except for the numbers that differ between connections.
const OPEN: &str = "54 02 20 06 24 01 03 FA 00 00 00 00 .. .. .. .. .. .. 34 12 .. .. .. .. 01 00 00 00 \
    10 27 00 00 16 48 10 27 00 00 12 48 01 04 20 04 24 68 2C 64 2C 65";
const OPENED: &str = "D4 00 00 00 01 00 02 00 01 00 01 00 01 00 34 12 CD AB 00 00 10 27 00 00 10 27 00 00 00 00";

/// Returns the CIP part of a frame and the part after it. Two dots in `pattern` stand for a byte to ignore.
fn cip(frame: &[u8], pattern: &str) -> (String, Vec<u8>) {
    let pattern: Vec<&str> = pattern.split_whitespace().collect();
    let (own, beside) = frame[40..].split_at(pattern.len());
    let shown = own.iter().zip(&pattern).map(|(byte, wanted)| match *wanted {
        ".." => "..".to_owned(),
        _ => format!("{byte:02X}"),
    });
    (shown.collect::<Vec<_>>().join(" "), beside.to_vec())
}

fn flat(pattern: &str) -> String {
    pattern.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn opens_cyclic_connection_as_in_reference() {
    let mut desk = Desk::with([Act::Reply(OPENED), Act::Reply("CE 00 00 00 01 00 34 12 CD AB 00 00 00 00")]);
    let opened = desk.ask(|master| master.forward_open(Topology::Adapter, 0x1234)).unwrap();
    let (own, beside) = cip(&desk.sent()[1], OPEN);
    assert_eq!(own, flat(OPEN));
    // Item 8001 gives the target address of packets to the host, with the port in network byte order.
    assert_eq!(beside, bytes("01 80 10 00 00 02 12 34 00 00 00 00 00 00 00 00 00 00 00 00"));
    assert_eq!((opened.to_target_id, opened.to_originator_id), (0x0002_0001, 0x0001_0001));
    assert_eq!((opened.to_target_interval, opened.timeout), (Duration::from_millis(10), Duration::from_millis(80)));
    assert_eq!((opened.port, opened.group, opened.layout.byte_length()), (2222, None, 16));
    desk.ask(|master| master.forward_close(&opened.close)).unwrap();
    let close = "4E 02 20 06 24 01 03 FA .. .. 34 12 .. .. .. .. 04 00 20 04 24 68 2C 64 2C 65";
    assert_eq!(cip(&desk.sent()[2], close).0, flat(close));
}

#[test]
fn rejected_connection_tries_other_parameters() {
    let words = |desk: &Desk| {
        let word = |frame: &Vec<u8>, at: usize| u16::from_le_bytes([frame[40 + at], frame[41 + at]]);
        let sent = desk.sent();
        let opens = sent.iter().skip(1);
        opens.map(|frame| (word(frame, 32), word(frame, 38))).collect::<Vec<_>>()
    };
    let kind = || Act::Reply("D4 00 01 01 08 01");
    let size = || Act::Reply("D4 00 01 01 27 01");
    type Case = (&'static str, Vec<Act>, Vec<(u16, u16)>);
    let cases: [Case; 3] = [
        ("to all who listen", vec![kind(), Act::Reply(OPENED)], vec![(0x4816, 0x4812), (0x4816, 0x2812)]),
        ("without parameter words", vec![size(), Act::Reply(OPENED)], vec![(0x4816, 0x4812), (0x480E, 0x480A)]),
        (
            "both",
            vec![kind(), size(), kind(), Act::Reply(OPENED)],
            vec![(0x4816, 0x4812), (0x4816, 0x2812), (0x480E, 0x480A), (0x480E, 0x280A)],
        ),
    ];
    for (label, acts, asked) in cases {
        let mut desk = Desk::with(acts);
        let opened = desk.ask(|master| master.forward_open(Topology::Adapter, 1)).unwrap();
        assert_eq!(words(&desk), asked, "{label}");
        assert_eq!(opened.layout.pkw, asked.last().unwrap().0 == 0x4816, "{label}");
    }
    // A hub for four drives with parameter words has five times eight bytes of data: 40 bytes.
    let mut desk = Desk::with([Act::Reply(OPENED)]);
    desk.ask(|master| master.forward_open(Topology::Hub4, 1)).unwrap();
    assert_eq!(words(&desk), [(0x482E, 0x482A)]);
}

#[test]
fn other_master_stops_retries() {
    for (extended, reply) in
        [(0x0106, "D4 00 01 01 06 01"), (0x0100, "D4 00 01 01 00 01 01 00 34 12 CD AB 00 00 00 00")]
    {
        let mut desk = Desk::with([Act::Reply(reply)]);
        let error = desk.ask(|master| master.forward_open(Topology::Adapter, 1)).unwrap_err();
        assert_eq!(error, Error::OtherMaster { extended });
        assert_eq!(desk.sent().len(), 2);
    }
    let mut desk = Desk::with([Act::Reply("D4 00 01 01 11 01")]);
    let error = desk.ask(|master| master.forward_open(Topology::Adapter, 1)).unwrap_err();
    let remedy = error.as_refusal().unwrap().remedy();
    assert_eq!(remedy, Some("request a longer interval"));
    // If a reply is lost, its connection may be open, so it is not opened again.
    let mut desk = Desk::with([]);
    let error = desk.ask(|master| master.forward_open(Topology::Adapter, 1)).unwrap_err();
    assert_eq!(error, Error::NoReply { requested: RequestedItem::Open, tries: 1, late: None });
    let services: Vec<u8> = desk.sent().iter().skip(1).map(|frame| frame[40]).collect();
    assert!(services.len() >= 2 && services[0] == 0x54 && services[1..].iter().all(|service| *service == 0x4E));
}

#[test]
fn closes_connection_with_slow_interval() {
    // The device uses 50 ms (C350h) in each direction although 10 ms were requested.
    let slow = "D4 00 00 00 01 00 02 00 01 00 01 00 01 00 34 12 CD AB 00 00 50 C3 00 00 10 27 00 00 00 00";
    let mut desk = Desk::with([Act::Reply(slow), Act::Reply("CE 00 00 00 01 00 34 12 CD AB 00 00 00 00")]);
    let error = desk.ask(|master| master.forward_open(Topology::Adapter, 1)).unwrap_err();
    assert_eq!(error, Error::TooSlow { asked_ms: 10, got_ms: 50 });
    assert_eq!(desk.sent()[2][40], 0x4E);
    // From 35 ms on, a target gives up after four intervals, and below that after eight.
    for (ms, multiplier) in [(34, 1), (35, 0)] {
        let mut desk = Desk::with([]);
        desk.station.link.interval = Duration::from_millis(ms);
        desk.ask(|master| master.forward_open(Topology::Adapter, 1)).unwrap_err();
        assert_eq!(desk.sent()[1][40 + 24], multiplier, "{ms} ms");
    }
}
