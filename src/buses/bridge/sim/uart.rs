//! The serial line between the adapter and its device. The time-out is assumed to start when all bytes have been sent.

use std::time::Duration;

use super::attached::SerialDevice;
use crate::buses::bridge::protocol::MAX_BODY;
use crate::units::{Baud, CharacterFormat, Moment, Parity};

#[derive(Clone)]
pub(super) struct Uart {
    line: Box<dyn SerialDevice>,
    format: Option<CharacterFormat>,
}

pub(super) struct UartTransfer {
    /// Time of the first start bit, or the end of the wait if there is no reply.
    pub(super) start: Moment,
    pub(super) rx: Vec<u8>,
    /// Time at which the adapter stopped waiting.
    pub(super) end: Moment,
}

impl Uart {
    /// Maximum number of bytes in a reply. The time stamp is not included.
    const MAX_RX: usize = MAX_BODY - 8;

    pub(super) fn new(line: Box<dyn SerialDevice>) -> Self {
        Uart { line, format: None }
    }

    pub(super) fn set_rpm(&mut self, now: Moment, rpm: f64) {
        self.line.turn_shaft(now, rpm);
    }

    /// Sets the baud rate and the parity. Returns `false` if they are not supported.
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

    /// Sends and receives bytes. Returns `None` if the line is not configured. The simulation of the line runs ahead of
    /// the adapter until the reply is complete.
    pub(super) fn transfer(
        &mut self,
        now: Moment,
        timeout: Duration,
        idle: Duration,
        tx: &[u8],
    ) -> Option<UartTransfer> {
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
        Some(UartTransfer { start, rx, end })
    }
}
