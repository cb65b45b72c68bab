//! The serial line of the adapter with its device. An assumption of this implementation: the time-out starts when
//! sending ends.

use std::time::Duration;

use super::attached::SerialDevice;
use crate::buses::bridge::protocol::MAX_BODY;
use crate::units::{Baud, CharacterFormat, Moment, Parity};

#[derive(Clone)]
pub(super) struct Uart {
    line: Box<dyn SerialDevice>,
    format: Option<CharacterFormat>,
}

pub(super) struct Transfer {
    /// Start of the first start bit, or the end of the wait if there was no reply.
    pub(super) start: Moment,
    pub(super) rx: Vec<u8>,
    /// Time at which the adapter stopped waiting.
    pub(super) end: Moment,
}

impl Uart {
    /// Maximum number of received bytes in a reply, not counting its time stamp.
    const MAX_RX: usize = MAX_BODY - 8;

    pub(super) fn new(line: Box<dyn SerialDevice>) -> Self {
        Uart { line, format: None }
    }

    pub(super) fn set_rpm(&mut self, now: Moment, rpm: f64) {
        self.line.turn(now, rpm);
    }

    /// Sets baud rate and parity. Returns `false` if they are not supported.
    pub(super) fn configure(&mut self, now: Moment, baud: u32, parity: u8) -> bool {
        let parity = match parity {
            0 => Some(Parity::None),
            1 => Some(Parity::Odd),
            2 => Some(Parity::Even),
            _ => None,
        };
        let Some((baud, parity)) = Baud::new(baud).zip(parity) else { return false };
        let format = CharacterFormat { baud, parity };
        self.line.set_host_format(now, format);
        self.format = Some(format);
        true
    }

    /// Sends and receives bytes, or returns `None` before the line is configured. The simulated line runs ahead of the
    /// adapter's time until the reply is complete.
    pub(super) fn transfer(&mut self, now: Moment, timeout: Duration, idle: Duration, tx: &[u8]) -> Option<Transfer> {
        let character = self.format?.character_time();
        self.line.poll(now);
        self.line.on_bytes(now, tx);
        let sent = now + character * u32::try_from(tx.len()).unwrap_or(u32::MAX);
        let (mut rx, mut start, mut end) = (Vec::new(), sent + timeout, sent + timeout);
        while let Some(at) = self.line.poll_at().filter(|at| *at <= end && rx.len() < Self::MAX_RX) {
            let bytes = self.line.poll(at);
            if bytes.is_empty() {
                continue;
            }
            if rx.is_empty() {
                start = at - character;
            }
            rx.extend(bytes);
            end = at + idle;
        }
        Some(Transfer { start, rx, end })
    }
}
