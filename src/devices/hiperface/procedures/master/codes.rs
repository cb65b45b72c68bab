//! Reads the status queue. Command 50h removes a code from the encoder, so a lost reply may have contained a code.
//! Therefore, late replies are accepted, and codes that may have been lost are counted.

use super::Master;
use crate::devices::hiperface::procedures::Error;
use crate::devices::hiperface::protocol::{Answer, Reply, Request, StatusCode};

/// Maximum number of codes in an encoder's queue, plus one reply that indicates the end of the queue.
const MAX_CODES: usize = 5;
/// Number of replies without a new code after which the reading ends.
const MAX_REPEATED: u32 = 5;
/// Length of a reply to command 50h in bytes: address, command, one to four codes, checksum.
const REPLY: std::ops::RangeInclusive<usize> = 4..=7;

/// Status codes in a reply to command 50h, and whether more codes follow.
type Codes = (Vec<StatusCode>, bool);

impl Master<'_> {
    /// Reads the complete status queue. Command 50h is repeated until the error bit in the reply is clear.
    ///
    /// # Errors
    /// Returns an error if every attempt fails or the user cancels. The station then holds the codes received so far,
    /// and the number of codes that may have been lost.
    pub(in super::super) fn collect_codes(&mut self) -> Result<(), Error> {
        let (mut seen, mut repeated) = (Vec::new(), 0);
        while seen.len() < MAX_CODES && repeated < MAX_REPEATED {
            let before = seen.len();
            if !self.next_codes(&mut seen)? {
                break;
            }
            repeated += u32::from(seen.len() == before);
        }
        if repeated == MAX_REPEATED {
            // These replies are too many to be late duplicates. The encoder announces the same code again as soon as it
            // is read.
            self.station.unanswered_codes = self.station.unanswered_codes.saturating_sub(repeated);
        }
        Ok(())
    }

    /// Reads the next codes from the queue, and returns whether more codes follow. `seen` holds the codes of all
    /// earlier replies.
    fn next_codes(&mut self, seen: &mut Vec<Vec<StatusCode>>) -> Result<bool, Error> {
        self.detect_echo()?;
        let mut tries = 0;
        loop {
            tries += 1;
            self.line.record_late_bytes();
            let sent = self.station.line.quality.requests;
            let attempt = self.exchange_once(&Request::ReadStatus);
            // After a cancellation, or on a line that is never silent, the request was not sent.
            if self.station.line.quality.requests > sent {
                self.station.unanswered_codes += 1;
            }
            let (answered, ended) = match attempt? {
                Ok(answered) => {
                    // After a repetition, the replies to earlier attempts may still arrive.
                    let ended = if tries > 1 { self.receive_late_bytes(tries) } else { Ok(()) };
                    (Some(codes_in(answered.answer)), ended)
                }
                Err(trouble) => (None, self.prepare_retry(&Request::ReadStatus, tries, trouble)),
            };
            let passed = self.line.take_late_bytes();
            let late = self.find_replies(&passed);
            self.station.line.quality.late += late.len() as u64;
            let mut pending = None;
            for (codes, more) in answered.into_iter().chain(late) {
                pending = Some(more);
                self.record_reply_codes(codes, seen);
            }
            match pending {
                Some(pending) => {
                    self.station.line.clear_error();
                    return Ok(pending);
                }
                None => ended?,
            }
        }
    }

    /// Records the status codes in a reply to command 50h. A reply that equals an earlier one may be a late duplicate,
    /// so it is ignored. The actual reply may then be missing.
    fn record_reply_codes(&mut self, codes: Vec<StatusCode>, seen: &mut Vec<Vec<StatusCode>>) {
        if seen.contains(&codes) {
            return;
        }
        self.station.unanswered_codes = self.station.unanswered_codes.saturating_sub(1);
        self.station.queue_codes(codes.iter().copied());
        seen.push(codes);
    }

    fn receive_late_bytes(&mut self, tries: u32) -> Result<(), Error> {
        let quiet = self.silence_duration();
        Ok(self.line.receive_late_bytes(&mut self.station.line, tries, quiet)?)
    }

    /// Finds replies to command 50h among skipped bytes.
    fn find_replies(&self, bytes: &[u8]) -> Vec<Codes> {
        let (mut rest, mut found) = (bytes, Vec::new());
        while let [_, behind @ ..] = rest {
            rest = match self.parse_status_reply(rest) {
                Some((codes, behind)) => {
                    found.push(codes);
                    behind
                }
                None => behind,
            };
        }
        found
    }

    /// Parses the reply to command 50h at the start of the bytes, and returns the bytes after it. The checksum of a
    /// reply can also match after its first bytes, such as 01h and 11h from address 40h. A length at which the bytes
    /// end or another reply begins therefore takes precedence.
    fn parse_status_reply<'b>(&self, bytes: &'b [u8]) -> Option<(Codes, &'b [u8])> {
        let replies = REPLY.filter_map(|length| bytes.split_at_checked(length)).filter_map(|(frame, behind)| {
            let answer = Request::ReadStatus.parse_reply(self.station.address, frame).ok()?;
            Some((codes_in(answer), behind))
        });
        let ends = |behind: &[u8]| behind.first().is_none_or(|byte| bytes.first() == Some(byte));
        let (mut whole, mut other): (Vec<_>, Vec<_>) = replies.partition(|(_, behind)| ends(behind));
        whole.append(&mut other);
        whole.into_iter().next()
    }
}

fn codes_in(answer: Answer) -> Codes {
    match answer {
        Answer::Reply { reply: Reply::Status(codes), pending } | Answer::Rejected { codes, pending } => {
            (codes, pending)
        }
        Answer::Reply { pending, .. } => (Vec::new(), pending),
    }
}
