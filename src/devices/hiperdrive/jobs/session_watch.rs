//! Supervision of explicit messages while drives are under control. If the device stops replying, the motion ends as
//! quickly as after any other loss, even if cyclic packets still arrive.
//!
//! | case | time |
//! |---|---|
//! | minimum rate of requests while a drive moves ([`REQUEST`]) | 60 ms |
//! | maximum time without a reply ([`REPLY_TIMEOUT`]), or twice the recent response time | 130 ms |
//! | total | 190 ms |
//!
//! Only time during which the thread has listened is counted. If a busy computer prevented the thread from listening, a
//! missing reply proves nothing. After a further [`UNCHECKED_TIMEOUT`], the reply is considered missing anyway.

use std::sync::Arc;
use std::time::Duration;

use super::Motion;
use crate::buses::ethernet_ip::protocol::Receiver;
use crate::link::{ByteLink, Clock, LinkError};
use crate::units::{CharacterFormat, Moment};

/// Maximum interval between requests while a drive moves.
pub(super) const REQUEST: Duration = Duration::from_millis(60);
/// Maximum time for which a request may stay unanswered while a drive moves.
const REPLY_TIMEOUT: Duration = Duration::from_millis(130);
/// Additional time after which a request counts as unanswered even if the line has not been checked since.
const UNCHECKED_TIMEOUT: Duration = Duration::from_millis(250);
/// Interval between checks of the line while a reply is pending.
const CHECK_INTERVAL: Duration = Duration::from_millis(10);
/// Maximum time allowed for a reply, no matter how slowly the device replied before.
const MAX_REPLY_TIMEOUT: Duration = Duration::from_secs(1);

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ReplyMonitor {
    /// Time at which the oldest unanswered request was sent.
    requested: Option<Moment>,
    /// Time at which the line was last checked and had no new bytes.
    looked: Moment,
    /// Longest recent reply time. Each shorter reply time lowers it by up to an eighth.
    slowest: Duration,
    /// Whether the last bytes received did not form a frame.
    broken: bool,
}

impl ReplyMonitor {
    pub(super) const fn record_request(&mut self, now: Moment) {
        if self.requested.is_none() {
            self.requested = Some(now);
        }
    }

    pub(super) fn record_reply(&mut self, now: Moment) {
        self.broken = false;
        // A reply that takes seconds is an exception and does not raise the time allowed for other replies.
        if let Some(took) =
            self.requested.take().map(|asked| now.duration_since(asked)).filter(|took| *took <= MAX_REPLY_TIMEOUT)
        {
            self.slowest = took.max(self.slowest * 7 / 8);
        }
    }

    /// Records that nothing had arrived by the given time.
    pub(super) const fn record_silence(&mut self, now: Moment) {
        self.looked = now;
    }

    pub(super) const fn abort_session(&mut self) {
        self.broken = true;
    }

    /// Returns whether motion must end because the device has been silent for too long or has sent bytes that do not
    /// form a frame.
    pub(super) fn is_silent(&self, now: Moment) -> bool {
        let patience = (self.slowest * 2).clamp(REPLY_TIMEOUT, MAX_REPLY_TIMEOUT);
        let is_late = |asked| {
            self.looked.duration_since(asked) > patience || now.duration_since(asked) > patience + UNCHECKED_TIMEOUT
        };
        self.broken || self.requested.is_some_and(is_late)
    }
}

pub(super) struct MonitoredLink {
    wire: Box<dyn ByteLink>,
    clock: Arc<dyn Clock>,
    motion: Motion,
    frames: Receiver,
}

impl MonitoredLink {
    pub(super) fn new(wire: Box<dyn ByteLink>, clock: Arc<dyn Clock>, motion: Motion) -> Self {
        MonitoredLink { wire, clock, motion, frames: Receiver::default() }
    }
}

impl ByteLink for MonitoredLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let now = self.clock.now();
        self.motion.update_session_watch(|session| session.record_request(now));
        self.wire.send(bytes)
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        let before = into.len();
        let mut now = self.clock.now();
        loop {
            let began = now;
            self.wire.receive((began + CHECK_INTERVAL).min(until), into)?;
            now = self.clock.now();
            if into.len() > before {
                break;
            }
            self.motion.update_session_watch(|session| session.record_silence(now));
            // If the clock does not advance, no more bytes will arrive.
            if now >= until || now <= began {
                return Ok(());
            }
        }
        self.frames.push(into.get(before..).unwrap_or_default());
        loop {
            match self.frames.next_frame() {
                Ok(Some(_)) => self.motion.update_session_watch(|session| session.record_reply(now)),
                Ok(None) => return Ok(()),
                Err(_) => {
                    self.frames = Receiver::default();
                    self.motion.update_session_watch(ReplyMonitor::abort_session);
                }
            }
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.wire.set_format(format)
    }

    fn can_set_format(&self) -> bool {
        self.wire.can_set_format()
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_connection()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::procedures::dead_man::MotionLock;
    use crate::devices::hiperdrive::protocol::DriveNumber;
    use crate::link::VirtualClock;

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    /// The limit of 130 ms without a reply counts from the first unanswered request (issue 21.13).
    #[test]
    fn silence_starts_at_first_unanswered_request() {
        let mut watch = ReplyMonitor::default();
        assert!(!watch.is_silent(at(10_000)), "nothing was asked");
        watch.record_request(at(100));
        watch.record_request(at(180));
        watch.record_silence(at(230));
        assert!(!watch.is_silent(at(260)), "listened for 130 ms");
        watch.record_silence(at(231));
        assert!(watch.is_silent(at(231)));
        watch.record_reply(at(250));
        assert!(!watch.is_silent(at(1000)), "it was answered");
        watch.abort_session();
        assert!(watch.is_silent(at(1000)), "with bytes that are no frame");
        watch.record_reply(at(1001));
        assert!(!watch.is_silent(at(1001)));
    }

    /// A line that delivers only the bytes stored in it.
    #[derive(Default)]
    struct Line(Vec<u8>);

    impl ByteLink for Line {
        fn send(&mut self, _: &[u8]) -> Result<(), LinkError> {
            Ok(())
        }

        fn receive(&mut self, _: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
            into.append(&mut self.0);
            Ok(())
        }

        fn set_format(&mut self, _: CharacterFormat) -> Result<(), LinkError> {
            Ok(())
        }

        fn check_connection(&mut self) -> Result<(), LinkError> {
            Ok(())
        }
    }

    /// An unanswered request or bytes that do not form a frame lock motion until a reply arrives. The reply to
    /// RegisterSession (reference, section 9) arrives in two parts (issue 21.13).
    #[test]
    fn silent_session_locks_motion() {
        let mut reply = vec![0x65, 0, 4, 0, 0x78, 0x56, 0x34, 0x12];
        reply.extend([0; 16]);
        reply.extend([1, 0, 0, 0]);
        let clock = Arc::new(VirtualClock::default());
        let motion = Motion::new(clock.clone());
        let locked = || {
            let locks = motion.with_motion_intent(|_, permit| permit(DriveNumber::FIRST).locks);
            assert_eq!(
                motion.motion_permit(DriveNumber::FIRST).locks,
                locks,
                "the window shows what the dead-man asks"
            );
            locks.contains(&MotionLock::NoAnswer)
        };
        let later = |ms| clock.sleep_until(clock.now() + Duration::from_millis(ms));
        let receive = |bytes: &[u8]| {
            let mut wire = MonitoredLink::new(Box::new(Line(bytes.to_vec())), clock.clone(), motion.clone());
            wire.receive(clock.now(), &mut Vec::new()).unwrap();
        };
        let mut wire = MonitoredLink::new(Box::new(Line::default()), clock.clone(), motion.clone());
        wire.send(&[0]).unwrap();
        later(130);
        let _ = wire.receive(clock.now(), &mut Vec::new());
        assert!(!locked());
        later(1);
        let _ = wire.receive(clock.now(), &mut Vec::new());
        assert!(locked());
        receive(&reply[..20]);
        assert!(locked(), "half a frame is no answer");
        receive(&reply);
        assert!(!locked());
        receive(&[0xFF; 64]);
        assert!(locked(), "no frame");
        receive(&reply);
        assert!(!locked());
    }

    /// A device that takes 300 ms for each reply is allowed 600 ms. The allowed time shrinks again when the device
    /// becomes faster.
    #[test]
    fn slow_device_extends_timeout() {
        let mut watch = ReplyMonitor::default();
        watch.record_request(at(0));
        watch.record_reply(at(300));
        watch.record_request(at(1000));
        // The line is not read for another 250 ms.
        assert!(!watch.is_silent(at(1850)) && watch.is_silent(at(1851)));
        watch.record_reply(at(1900));
        watch.record_request(at(7000));
        assert!(!watch.is_silent(at(8250)) && watch.is_silent(at(8251)), "never more than a second");
        for step in 0..40 {
            watch.record_reply(at(8100 + step * 100));
            watch.record_request(at(8190 + step * 100));
        }
        watch.record_silence(at(12_090 + 131));
        assert!(watch.is_silent(at(12_090 + 131)), "{watch:?}");
        // A presence test takes eight seconds on a hub, which does not affect the time allowed for later requests.
        let mut watch = ReplyMonitor::default();
        watch.record_request(at(0));
        watch.record_reply(at(8000));
        watch.record_request(at(9000));
        watch.record_silence(at(9131));
        assert!(watch.is_silent(at(9131)));
    }
}
