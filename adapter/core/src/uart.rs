//! The serial line: its settings, the encoding of characters, and transfers of a request and its reply.

use alloc::vec::Vec;

use bridge_codec::{ErrorCode, MAX_BODY};

use crate::{Bus, Refusal};

/// Settings of the serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UartSetting {
    /// Duration of an eighth of a bit, in 256ths of a system clock cycle.
    pub divisor: u32,
    parity: Parity,
    turnaround_us: u16,
    /// Duration of a character in microseconds, rounded up.
    character_us: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Parity {
    None,
    Odd,
    Even,
}

/// A transfer in progress: sending a request and receiving its reply.
#[derive(Clone, Debug)]
pub(crate) struct Transfer {
    /// Sequence number of the host's request.
    pub(crate) seq: u8,
    timeout_us: u32,
    idle_us: u32,
    /// Time at which the last character was sent, or `None` while characters are being sent.
    sent_us: Option<u64>,
    /// Number of characters received so far, and the time at which this number last changed.
    received: (usize, u64),
}

impl UartSetting {
    /// Bit rate of the state machines with a divisor of 1. They need eight cycles per bit.
    const BASE_HZ: u64 = 120_000_000 / 8;
    const BAUD: core::ops::RangeInclusive<u32> = 300..=1_000_000;

    /// Checks the requested settings.
    pub(crate) fn new(baud: u32, parity: u8, turnaround_us: u16) -> Result<Self, Refusal> {
        if !Self::BAUD.contains(&baud) {
            return Err((ErrorCode::BAD_ARGUMENT, "300 to 1000000 baud"));
        }
        let parity = match parity {
            0 => Parity::None,
            1 => Parity::Odd,
            2 => Parity::Even,
            _ => return Err((ErrorCode::BAD_ARGUMENT, "parity none, odd or even")),
        };
        let rate = u64::from(baud);
        // At most 50 000 · 256.
        let divisor = ((Self::BASE_HZ * 256 + rate / 2) / rate) as u32;
        let bits = if parity == Parity::None { 10 } else { 11 };
        let character_us = (bits * 1_000_000_u32).div_ceil(baud);
        Ok(UartSetting { divisor, parity, turnaround_us, character_us })
    }

    /// Returns the number of bits in a character, including start and stop bits.
    pub const fn bits(self) -> u32 {
        match self.parity {
            Parity::None => 10,
            Parity::Odd | Parity::Even => 11,
        }
    }

    /// Returns the mean delay in microseconds until the receiver marks an edge. It is one and a half cycles, at eight
    /// cycles per bit.
    pub const fn mark_delay_us(self) -> u32 {
        self.divisor * 3 / 2 / 256 / (Self::BASE_HZ as u32 * 8 / 1_000_000)
    }

    /// Returns the bits of a character with the start bit lowest.
    fn encode(self, byte: u8) -> u32 {
        let is_odd = byte.count_ones() % 2 == 1;
        let stop = match self.parity {
            Parity::None => 1,
            Parity::Odd => u32::from(!is_odd) | 0b10,
            Parity::Even => u32::from(is_odd) | 0b10,
        };
        u32::from(byte) << 1 | stop << 9
    }

    /// Decodes a word from the receiver, or returns `None` if the stop bit is missing. The highest bits of the word are
    /// the character, with its last bit at the top. Parity is not checked, because the host's checksums detect such
    /// errors.
    fn decode(self, word: u32) -> Option<u8> {
        // Eight data bits remain.
        (word >> 31 == 1).then_some((word >> (33 - self.bits())) as u8)
    }
}

impl Transfer {
    /// Maximum number of received bytes in a reply, which also contains the time.
    pub(crate) const MAX_RX: usize = MAX_BODY - 8;
    const MAX_TIMEOUT_US: u32 = 2_000_000;
    const MAX_IDLE_US: u32 = 500_000;

    /// Starts a transfer. The line must not be driven before `free_us`.
    pub(crate) fn begin<B: Bus>(
        bus: &mut B,
        setting: UartSetting,
        (seq, timeout_us, idle_us): (u8, u32, u32),
        tx: &[u8],
    ) -> Result<Self, Refusal> {
        if timeout_us > Self::MAX_TIMEOUT_US || idle_us > Self::MAX_IDLE_US || tx.is_empty() {
            return Err((ErrorCode::BAD_ARGUMENT, "at least a byte, 2 s and 0.5 s of silence at most"));
        }
        let words: Vec<u32> = tx.iter().map(|byte| setting.encode(*byte)).collect();
        bus.begin_transfer(&words);
        Ok(Transfer { seq, timeout_us, idle_us, sent_us: None, received: (0, 0) })
    }

    /// Returns the time of the first start bit and the received bytes, or `None` while the transfer is in progress.
    pub(crate) fn poll<B: Bus>(&mut self, bus: &mut B, setting: UartSetting) -> Option<(u64, Vec<u8>)> {
        let now = bus.now_us();
        if !bus.has_sent() {
            return None;
        }
        let sent_us = *self.sent_us.get_or_insert(now);
        let count = bus.received_characters().min(Self::MAX_RX);
        if count != self.received.0 {
            self.received = (count, now);
        }
        let first_edge = bus.first_edge_us();
        let is_complete = match first_edge {
            // The silence begins at the end of the last character, even if it is still being received.
            Some(edge) => {
                let last = if count == 0 { edge + u64::from(setting.character_us) } else { self.received.1 };
                count == Self::MAX_RX || now > last + u64::from(self.idle_us)
            }
            None => now > sent_us + u64::from(self.timeout_us),
        };
        if !is_complete {
            return None;
        }
        let rx = (0..count).filter_map(|at| setting.decode(bus.received_character(at))).collect();
        bus.end_transfer();
        Some((first_edge.unwrap_or(now), rx))
    }

    /// Returns the time until which the line must not be driven after this transfer.
    pub(crate) fn free_us(now_us: u64, setting: UartSetting) -> u64 {
        now_us + u64::from(setting.turnaround_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divisors_match_baud_within_one_per_mille() {
        for baud in [300, 600, 1200, 2400, 4800, 9600, 19_200, 38_400, 115_200, 1_000_000] {
            let setting = UartSetting::new(baud, 2, 0).unwrap();
            let actual = 120e6 / 8.0 * 256.0 / f64::from(setting.divisor);
            assert!((actual / f64::from(baud) - 1.0).abs() < 1e-3, "{baud}: {actual}");
            assert!(setting.divisor >> 8 < 65_536);
        }
        for (baud, parity) in [(299, 0), (1_000_001, 0), (9_600, 3)] {
            assert!(UartSetting::new(baud, parity, 0).is_err());
        }
        // A bit takes 104 µs; one and a half of its eight cycles are 19 µs.
        assert_eq!(UartSetting::new(9_600, 2, 0).unwrap().mark_delay_us(), 19);
        // HIPERFACE reference, section 3: a character of 11 bits takes 1.146 ms at 9600 baud.
        assert_eq!(UartSetting::new(9_600, 2, 0).unwrap().character_us, 1_146);
    }

    /// A character consists of start bit 0, data with the lowest bit first, parity, and stop bit 1.
    #[test]
    fn orders_character_bits() {
        let line = |parity, byte| {
            let setting = UartSetting::new(9_600, parity, 0).unwrap();
            let bits = setting.encode(byte);
            (0..setting.bits()).map(|at| if bits >> at & 1 == 1 { '1' } else { '0' }).collect::<alloc::string::String>()
        };
        assert_eq!(line(0, 0x42), "0010000101");
        // Even parity: the number of ones, including the parity bit, is even.
        assert_eq!(line(2, 0x42), "00100001001");
        assert_eq!(line(2, 0x43), "01100001011");
        assert_eq!(line(1, 0x42), "00100001011");
        assert_eq!(line(1, 0x43), "01100001001");
    }

    #[test]
    fn decodes_received_bits() {
        for parity in [0, 2] {
            let setting = UartSetting::new(9_600, parity, 0).unwrap();
            for byte in [0x00, 0x42, 0x80, 0x01, 0xFF] {
                // The receiver shifts in all bits except the start bit from the top.
                let received = setting.encode(byte) >> 1 << (33 - setting.bits());
                assert_eq!(setting.decode(received), Some(byte));
                assert_eq!(setting.decode(received & 0x7FFF_FFFF), None, "without a stop bit");
            }
        }
    }
}
