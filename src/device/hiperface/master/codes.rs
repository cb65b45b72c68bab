//! The queue of status codes. 50h takes a code out of the encoder, so that a reply to it that is lost may have been one: a
//! reply that comes late is taken all the same, and what may have been lost is counted.

use super::Master;
use crate::device::hiperface::Error;
use crate::protocol::hiperface::{Answer, Reply, Request, StatusCode};

/// Codes in an encoder's queue at most, and one more to see its end.
const MOST_CODES: usize = 5;
/// Bytes of a reply to 50h: address, command, one to four codes, checksum.
const REPLY: std::ops::RangeInclusive<usize> = 4..=7;

/// A reply to 50h: its codes, and whether more wait behind them.
type Codes = (Vec<StatusCode>, bool);

impl Master<'_> {
    /// Reads the whole queue into the station: 50h until the error bit is gone.
    ///
    /// # Errors
    /// When every try failed, or when the user wished an end. Codes that came until then are in the station, and what may
    /// have been lost is counted there.
    pub(in super::super) fn collect_codes(&mut self) -> Result<(), Error> {
        for _ in 0..MOST_CODES {
            if !self.next_codes()? {
                break;
            }
        }
        Ok(())
    }

    /// Takes the next codes out of the queue; true where more wait behind them.
    fn next_codes(&mut self) -> Result<bool, Error> {
        let mut tries = 0;
        loop {
            tries += 1;
            self.line.keep_passed();
            let attempt = self.attempt(&Request::ReadStatus);
            // A wish to end is heard before it is sent.
            if !matches!(attempt, Err(Error::Cancelled)) {
                self.station.codes_unheard += 1;
            }
            let (answered, ended) = match attempt? {
                Ok(answered) => {
                    // Behind a repetition, the replies to the tries before it may still come.
                    let ended = if tries > 1 { self.hear_late(tries) } else { Ok(()) };
                    (Some(codes(answered.answer)), ended)
                }
                Err(trouble) => (None, self.may_try_again(&Request::ReadStatus, tries, trouble)),
            };
            let passed = self.line.take_passed();
            let late = self.replies_in(&passed);
            self.station.line.quality.late += late.len() as u64;
            let mut pending = None;
            for (codes, more) in answered.into_iter().chain(late) {
                self.station.meet_codes(codes);
                self.station.codes_unheard = self.station.codes_unheard.saturating_sub(1);
                pending = Some(more);
            }
            match pending {
                Some(pending) => {
                    self.station.line.recovered();
                    return Ok(pending);
                }
                None => ended?,
            }
        }
    }

    fn hear_late(&mut self, tries: u32) -> Result<(), Error> {
        let quiet = self.quiet();
        Ok(self.line.hear_late(&mut self.station.line, tries, quiet)?)
    }

    /// The replies to 50h among bytes that were let pass.
    fn replies_in(&self, bytes: &[u8]) -> Vec<Codes> {
        let (mut rest, mut found) = (bytes, Vec::new());
        while let [_, behind @ ..] = rest {
            let reply = REPLY.filter_map(|length| rest.split_at_checked(length)).find_map(|(frame, behind)| {
                let answer = Request::ReadStatus.parse_reply(self.station.address, frame).ok()?;
                Some((codes(answer), behind))
            });
            rest = match reply {
                Some((codes, behind)) => {
                    found.push(codes);
                    behind
                }
                None => behind,
            };
        }
        found
    }
}

/// What an answer to 50h says.
fn codes(answer: Answer) -> Codes {
    match answer {
        Answer::Reply { reply: Reply::Status(codes), pending } | Answer::Rejected { codes, pending } => {
            (codes, pending)
        }
        Answer::Reply { pending, .. } => (Vec::new(), pending),
    }
}
