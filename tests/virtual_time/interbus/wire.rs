//! The bytes exchanged with a gateway, written by hand from the Modbus application protocol: the requests, and how each
//! possible reply is handled.

use std::sync::Arc;
use std::time::Duration;

use encoder_studio::devices::interbus::procedures::{
    Error, Exception, FrameWord, Master, ReplyDamage, RequestedItem, Station, WordReading, identify, word_in_frame,
};
use encoder_studio::devices::interbus::protocol::WordOrder;
use encoder_studio::link::{ByteLink, CancelToken, Clock, Ctx, LinkError, Trace, VirtualClock};
use encoder_studio::units::{CharacterFormat, Moment};

use super::support::station;

/// The bytes sent after a request, in groups with a delay in milliseconds.
type Answer = Vec<(u64, Vec<u8>)>;

/// A gateway whose replies come from a function of the test. It receives each request and its number, starting at 0.
struct Gateway<F> {
    clock: Arc<VirtualClock>,
    answer: F,
    requests: Vec<Vec<u8>>,
    coming: Vec<(Moment, Vec<u8>)>,
}

impl<F: FnMut(usize, &[u8]) -> Answer> Gateway<F> {
    fn new(clock: Arc<VirtualClock>, answer: F) -> Self {
        Gateway { clock, answer, requests: Vec::new(), coming: Vec::new() }
    }
}

impl<F: FnMut(usize, &[u8]) -> Answer + Send> ByteLink for Gateway<F> {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let (now, number) = (self.clock.now(), self.requests.len());
        self.requests.push(bytes.to_vec());
        let coming = (self.answer)(number, bytes).into_iter();
        self.coming.extend(coming.map(|(after, bytes)| (now + Duration::from_millis(after), bytes)));
        self.coming.sort_by_key(|(at, _)| *at);
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let next = self.coming.first().map(|(at, _)| *at).filter(|at| *at <= until.max(self.clock.now()));
        match next {
            Some(at) => {
                self.clock.sleep_until(at);
                into.extend(self.coming.remove(0).1);
            }
            None => self.clock.sleep_until(until),
        }
        Ok(())
    }

    fn set_format(&mut self, _format: CharacterFormat) -> Result<(), LinkError> {
        Ok(())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

/// Returns a reply with the transaction number of the request.
fn reply(request: &[u8], body: &[u8]) -> Vec<u8> {
    let length = u16::try_from(body.len()).unwrap().to_be_bytes();
    [&request[..2], &[0, 0], &length, body].concat()
}

/// Returns the reply to a request that reads two registers.
fn registers(request: &[u8], word: u32) -> Vec<u8> {
    reply(request, &[&[request[6], request[7], 4][..], &word.to_be_bytes()].concat())
}

/// The result of a call, the requests sent, and the time taken.
type ObservedCall<T> = (Result<T, Error>, Vec<Vec<u8>>, Duration);

fn with<T>(
    station: &mut Station,
    answer: impl FnMut(usize, &[u8]) -> Answer + Send + 'static,
    work: impl FnOnce(&mut Master<'_>) -> Result<T, Error>,
) -> ObservedCall<T> {
    let (clock, cancel, mut trace) = (Arc::new(VirtualClock::default()), CancelToken::default(), Trace::default());
    let mut wire = Gateway::new(clock.clone(), answer);
    let ended = {
        let ctx = Ctx { wire: &mut wire as &mut dyn ByteLink, clock: &*clock, cancel: &cancel, trace: &mut trace };
        work(&mut Master::new(ctx, station))
    };
    (ended, wire.requests, clock.now().since_start())
}

fn read(query: &str, answer: impl FnMut(usize, &[u8]) -> Answer + Send + 'static) -> ObservedCall<WordReading> {
    with(&mut station(query), answer, |master| master.read_in_word())
}

#[test]
fn in_word_is_two_input_registers() {
    let cases = [
        ("", vec![0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 2], 0x0012_3456),
        ("order=low-first", vec![0, 1, 0, 0, 0, 6, 1, 4, 0, 0, 0, 2], 0x3456_0012),
        ("unit=17&input=0x1234", vec![0, 1, 0, 0, 0, 6, 17, 4, 0x12, 0x34, 0, 2], 0x0012_3456),
    ];
    for (query, request, word) in cases {
        let (read, requests, _) = read(query, |_, request| vec![(3, registers(request, 0x0012_3456))]);
        assert_eq!(read.unwrap().word, word, "{query}");
        assert_eq!(requests, [request], "{query}");
    }
}

#[test]
fn out_word_is_one_register_pair_write() {
    let answer = |_: usize, request: &[u8]| match request[7] {
        3 => vec![(1, registers(request, 0x2021_0009))],
        4 => vec![(1, registers(request, 0))],
        _ => vec![(1, reply(request, &[1, 16, 0, 8, 0, 2]))],
    };
    let (ended, requests, _) = with(&mut station("output=8&handshake=50"), answer, identify);
    assert!(matches!(ended, Err(Error::TimeOut { .. })), "{ended:?}");
    let writes: Vec<&Vec<u8>> = requests.iter().filter(|request| request[7] == 16).collect();
    assert_eq!(writes[0][4..], [0, 11, 1, 16, 0, 8, 0, 2, 4, 0x20, 0x21, 0, 9]);
    assert_eq!(writes[1][4..], [0, 11, 1, 16, 0, 8, 0, 2, 4, 0, 0, 0, 0], "and normal running at the end");
    assert_eq!(writes.len(), 2, "a word that stands is not written again");
    assert_eq!(word_in_frame(true, writes[0], WordOrder::HighFirst), Some(FrameWord::Out(0x2021_0009)));
    assert_eq!(word_in_frame(true, writes[0], WordOrder::LowFirst), Some(FrameWord::Out(0x0009_2021)));
    let input = registers(&requests[0], 0xC200_00FF);
    assert_eq!(word_in_frame(false, &input, WordOrder::HighFirst), Some(FrameWord::In(0xC200_00FF)));
    assert_eq!(word_in_frame(true, &requests[0], WordOrder::HighFirst), None);
}

/// A reply to an earlier request is ignored, even if it is the only reply.
#[test]
fn late_reply_is_not_next_reply() {
    let answer = |number: usize, request: &[u8]| match number {
        0 => vec![(1025, registers(request, 1))],
        _ => vec![(10, registers(request, 2))],
    };
    let (ended, requests, _) = read("", answer);
    assert_eq!((ended.unwrap().word, requests.len()), (2, 2));
    assert_ne!(requests[0][..2], requests[1][..2]);
    // The late reply arrives together with the right one.
    let answer = |number: usize, request: &[u8]| match number {
        0 => vec![],
        _ => {
            let mut earlier = request.to_vec();
            earlier[1] -= 1;
            vec![(10, [registers(&earlier, 1), registers(request, 2)].concat())]
        }
    };
    assert_eq!(read("", answer).0.unwrap().word, 2);
}

#[test]
fn accepts_reply_byte_by_byte() {
    let answer = |_: usize, request: &[u8]| {
        let whole = registers(request, 0x0102_0304);
        whole.iter().zip(1..).map(|(byte, at)| (at * 20, vec![*byte])).collect()
    };
    assert_eq!(read("", answer).0.unwrap().word, 0x0102_0304);
}

#[test]
fn refusal_names_cause() {
    let cases = [
        (1, 1, "illegal function", "holding registers"),
        (2, 1, "illegal data address", "input= and output="),
        (3, 1, "illegal data value", "two registers"),
        (4, 5, "server device failure", "INTERBUS runs"),
        (6, 5, "server device busy", "busy"),
        (0xA, 5, "gateway path unavailable", "unit="),
        (0xB, 5, "gateway target device failed to respond", "LEDs and cable"),
        (0x63, 5, "unknown exception", "manual"),
    ];
    for (code, tries, name, cause) in cases {
        let (ended, requests, took) = read("input=7", move |_, request| vec![(2, reply(request, &[1, 0x84, code]))]);
        let error = ended.unwrap_err();
        let asked = RequestedItem::Input { register: 7 };
        assert_eq!(error, Error::Exception { requested: asked, exception: Exception::new(code) });
        let text = error.to_string();
        assert!(text.contains(name) && text.contains(cause), "{text}");
        assert_eq!(requests.len(), tries, "{text}");
        assert!(took < Duration::from_secs(12));
    }
    // A gateway that was busy once answers the next request.
    let (ended, requests, _) = read("", |number, request| match number {
        0 | 1 => vec![(2, reply(request, &[1, 0x84, 6]))],
        _ => vec![(2, registers(request, 5))],
    });
    assert_eq!((ended.unwrap().word, requests.len()), (5, 3));
}

#[test]
fn retries_invalid_replies() {
    let wrong: [(&str, Vec<u8>, ReplyDamage); 6] = [
        ("text", b"HTTP/1.1 400 Bad Request\r\n\r\n".to_vec(), ReplyDamage::NoFrame { bytes: 28 }),
        ("another unit", vec![2, 4, 4, 0, 0, 0, 1], ReplyDamage::Unit { requested: 1, got: 2 }),
        ("another function", vec![1, 3, 4, 0, 0, 0, 1], ReplyDamage::Function { requested: 4, got: 3 }),
        ("one register", vec![1, 4, 2, 0, 1], ReplyDamage::Registers),
        ("three registers", vec![1, 4, 6, 0, 1, 0, 2, 0, 3], ReplyDamage::Registers),
        ("a wrong count", vec![1, 4, 6, 0, 1, 0, 2], ReplyDamage::Registers),
    ];
    for (label, bytes, damage) in wrong {
        let is_frame = label != "text";
        let says = move |request: &[u8]| if is_frame { reply(request, &bytes) } else { bytes.clone() };
        let once = says.clone();
        let (ended, requests, _) = read("", move |number, request| match number {
            0 => vec![(2, once(request))],
            _ => vec![(2, registers(request, 9))],
        });
        assert_eq!((ended.unwrap().word, requests.len()), (9, 2), "{label}");
        let (ended, requests, took) = read("", move |_, request| vec![(2, says(request))]);
        let expected = Error::Damaged { requested: RequestedItem::Input { register: 0 }, tries: 5, cause: damage };
        assert_eq!((ended.unwrap_err(), requests.len()), (expected, 5), "{label}");
        assert!(took < Duration::from_secs(12), "{label}");
    }
}

#[test]
fn silent_or_endless_gateway_times_out() {
    let (ended, requests, took) = read("", |_, _| vec![]);
    assert_eq!(ended.unwrap_err(), Error::NoReply { requested: RequestedItem::Input { register: 0 }, tries: 3 });
    assert_eq!(requests.len(), 3);
    assert!(took < Duration::from_secs(12), "{took:?}");
    // The gateway hangs after a while. Returning to the mode then also ends soon.
    for answered in 0..40 {
        let answer = move |number: usize, request: &[u8]| match (number < answered, request[7]) {
            (false, _) => vec![],
            (true, 4) if number % 6 < 4 => vec![(2, registers(request, 0xA000_0001))],
            (true, 4) => vec![(2, registers(request, 77))],
            (true, _) => vec![(2, reply(request, &[1, 16, 0, 0, 0, 2]))],
        };
        let (ended, _, took) = with(&mut station(""), answer, identify);
        assert!(ended.is_err() && took < Duration::from_secs(12), "{answered}: {took:?}");
    }
    let babble = |_: usize, _: &[u8]| (0..400).map(|at| (at * 10, vec![0xFF; 9])).collect();
    let (ended, _, took) = read("", babble);
    assert_eq!((ended.unwrap_err(), took < Duration::from_secs(12)), (Error::NeverSilent, true));
}

#[test]
fn recording_answers_any_transaction_number() {
    let mut station = station("");
    station.recorded = true;
    let answer = |_: usize, request: &[u8]| {
        let mut other = registers(request, 42);
        other[..2].copy_from_slice(&[0x77, 0x77]);
        vec![(1, other)]
    };
    assert_eq!(with(&mut station, answer, |master| master.read_in_word()).0.unwrap().word, 42);
}
