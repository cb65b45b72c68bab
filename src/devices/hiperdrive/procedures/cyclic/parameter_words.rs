//! Parameters that are read one at a time through the parameter words of a cyclic connection (reference, section 6).
//! The words are used for reading only. Writing requires explicit messages and a plan.

use std::collections::BTreeMap;
use std::time::Duration;

use crate::devices::hiperdrive::protocol::{Answer, ParameterNumber, Pkw, PkwError, Task, Value};
use crate::units::Moment;

/// Reader that polls the watched parameters in turn through the parameter words.
///
/// A request is repeated in every packet until its reply has arrived. Before the next request, the words are cleared in
/// both directions. A late reply is therefore never mistaken for the reply to a later request for the same parameter.
#[derive(Clone, Debug, Default)]
pub struct ParameterWords {
    watched: Vec<ParameterNumber>,
    readings: ParameterReadings,
    phase: Phase,
    /// Index of the parameter to request next.
    next: usize,
}

pub type ParameterReadings = BTreeMap<ParameterNumber, ParameterReading>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterReading {
    /// Time at which the reply arrived or was given up.
    pub at: Moment,
    pub result: ParameterResult,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterResult {
    Number(i64),
    Refused(PkwError),
    /// The device did not reply within the time limit.
    NoReply,
}

#[derive(Clone, Copy, Debug, Default)]
enum Phase {
    /// The request has been cleared, but the device has not confirmed this yet.
    #[default]
    Clear,
    /// As [`Clear`](Self::Clear), with a parameter that waits to be read since the given time.
    Clearing {
        since: Moment,
    },
    /// The device has confirmed that no request is pending.
    Ready,
    Reading {
        number: ParameterNumber,
        since: Moment,
    },
}

/// Time limit for a reply. The manual does not give one (`U`).
const LIMIT: Duration = Duration::from_secs(1);

impl ParameterWords {
    /// Sets the parameters to read. Readings of other parameters are dropped.
    pub fn set_watched(&mut self, watched: &[ParameterNumber]) {
        if self.watched != watched {
            self.watched = watched.to_vec();
            self.readings.retain(|number, _| watched.contains(number));
        }
    }

    pub const fn readings(&self) -> &ParameterReadings {
        &self.readings
    }

    pub fn request(&mut self, now: Moment) -> Pkw {
        match self.phase {
            Phase::Clear if !self.watched.is_empty() => self.phase = Phase::Clearing { since: now },
            Phase::Clearing { since } if now.duration_since(since) > LIMIT => {
                let silent = ParameterReading { at: now, result: ParameterResult::NoReply };
                self.readings.extend(self.watched.iter().map(|number| (*number, silent)));
                self.phase = Phase::Clear;
            }
            Phase::Reading { number, since } if now.duration_since(since) > LIMIT => {
                self.finish(number, ParameterReading { at: now, result: ParameterResult::NoReply });
            }
            Phase::Ready => {
                let after = self.next + 1;
                if let Some(number) = self.watched.get(self.next).or(self.watched.first()) {
                    self.phase = Phase::Reading { number: *number, since: now };
                    self.next = if after < self.watched.len() { after } else { 0 };
                }
            }
            _ => {}
        }
        match self.phase {
            Phase::Reading { number, .. } => read_request(number),
            _ => Pkw::default(),
        }
    }

    pub fn receive(&mut self, now: Moment, words: Pkw) {
        match self.phase {
            Phase::Clearing { .. } if words.answer_to(Pkw::default()).is_some() => self.phase = Phase::Ready,
            Phase::Reading { number, .. } => {
                if let Some(result) =
                    words.answer_to(read_request(number)).and_then(|answer| parameter_result(number, words, answer))
                {
                    self.finish(number, ParameterReading { at: now, result });
                }
            }
            _ => {}
        }
    }

    fn finish(&mut self, number: ParameterNumber, reading: ParameterReading) {
        if self.watched.contains(&number) {
            self.readings.insert(number, reading);
        }
        self.phase = Phase::Clear;
    }
}

fn read_request(number: ParameterNumber) -> Pkw {
    Pkw::request(Task::Read, number.get(), 0, 0)
}

/// Returns the reading that an answer contains, or `None` if the answer is not a number. Numbers shorter than 32 bits
/// are in the low bytes.
fn parameter_result(number: ParameterNumber, words: Pkw, answer: Answer) -> Option<ParameterResult> {
    if let Answer::Refused(why) = answer {
        return Some(ParameterResult::Refused(why));
    }
    let kind = number.row()?.kind;
    let bytes = words.pwe.to_le_bytes();
    match kind.parse(bytes.get(..kind.byte_length()?)?).ok()? {
        Value::Number(value) => Some(ParameterResult::Number(value)),
        Value::Text(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::protocol::ByteOrder;

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    fn words(text: &str) -> Pkw {
        let bytes: Vec<u8> = text.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
        Pkw::parse(bytes.try_into().unwrap(), ByteOrder::Little)
    }

    fn number(number: u16) -> ParameterNumber {
        ParameterNumber::new(number).unwrap()
    }

    const CLEAR: &str = "00 00 00 00 00 00 00 00";
    /// Request to read parameter 166, and the reply with the value 350 (reference, section 9).
    const READ_166: &str = "A6 10 00 00 00 00 00 00";
    const IS_350: &str = "A6 10 00 00 5E 01 00 00";

    #[test]
    fn requests_parameter_until_reply() {
        let mut own = ParameterWords::default();
        assert_eq!(own.request(at(0)), words(CLEAR), "nothing is watched");
        own.set_watched(&[number(166)]);
        assert_eq!(own.request(at(10)), words(CLEAR));
        own.receive(at(15), words(CLEAR));
        for ms in [20, 30, 40] {
            assert_eq!(own.request(at(ms)), words(READ_166));
            own.receive(at(ms + 5), words(CLEAR));
        }
        own.receive(at(48), words(IS_350));
        let reading = ParameterReading { at: at(48), result: ParameterResult::Number(350) };
        assert_eq!(own.readings().get(&number(166)), Some(&reading));
        // The old reply is repeated until the device confirms that nothing is requested.
        for ms in [50, 60] {
            assert_eq!(own.request(at(ms)), words(CLEAR));
            own.receive(at(ms + 5), words(IS_350));
        }
        own.receive(at(68), words(CLEAR));
        assert_eq!(own.request(at(70)), words(READ_166));
        assert_eq!(own.readings().get(&number(166)), Some(&reading), "not read again yet");
    }

    #[test]
    fn ignores_replies_to_other_requests() {
        let mut own = ParameterWords::default();
        own.set_watched(&[number(166)]);
        own.request(at(0));
        own.receive(at(1), words(CLEAR));
        own.request(at(10));
        // Replies to other requests: another parameter, the write of an array, and no request.
        for other in ["A5 10 00 00 5E 01 00 00", "A6 40 00 00 5E 01 00 00", CLEAR] {
            own.receive(at(11), words(other));
        }
        assert!(own.readings().is_empty());
        own.receive(at(12), words("A6 70 00 00 11 00 00 00"));
        let refused = ParameterResult::Refused(PkwError::STATE);
        assert_eq!(own.readings().get(&number(166)).map(|reading| reading.result), Some(refused));
    }

    #[test]
    fn number_size_and_sign_match_parameter() {
        // Parameter 11 is I16, 119 is I8, and 107 is I32. Each reply contains −5, with arbitrary bits above the number.
        let cases =
            [(11, "0B 10 00 00 FB FF 00 00"), (119, "77 10 00 00 FB 00 00 00"), (107, "6B 20 00 00 FB FF FF FF")];
        for (parameter, reply) in cases {
            let mut own = ParameterWords::default();
            own.set_watched(&[number(parameter)]);
            own.request(at(0));
            own.receive(at(1), words(CLEAR));
            own.request(at(10));
            own.receive(at(11), words(reply));
            let result = own.readings().get(&number(parameter)).map(|reading| reading.result);
            assert_eq!(result, Some(ParameterResult::Number(-5)), "{parameter}");
        }
    }

    #[test]
    fn reports_and_retries_missing_reply() {
        let mut own = ParameterWords::default();
        own.set_watched(&[number(11), number(119)]);
        let mut ms = 0;
        while ms < 1200 {
            assert_eq!(own.request(at(ms)), words(CLEAR), "it never shows that nothing is requested");
            own.receive(at(ms + 5), words(IS_350));
            ms += 10;
        }
        let silent: Vec<ParameterResult> = own.readings().values().map(|reading| reading.result).collect();
        assert_eq!(silent, [ParameterResult::NoReply; 2]);
        own.receive(at(ms), words(CLEAR));
        assert_eq!(own.request(at(ms)), words("0B 10 00 00 00 00 00 00"));
        own.receive(at(ms + 5), words("0B 10 00 00 22 00 00 00"));
        own.request(at(ms + 10));
        own.receive(at(ms + 15), words(CLEAR));
        assert_eq!(own.request(at(ms + 20)), words("77 10 00 00 00 00 00 00"), "the other one in turn");
        own.set_watched(&[number(119)]);
        assert!(!own.readings().contains_key(&number(11)), "it is no longer watched");
    }
}
