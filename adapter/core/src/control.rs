//! Control frames of BiSS C, which read and write registers using one bit per frame (`protocol/biss.md`, section 3).
//!
//! The control bit of the host (CDM) is the inverted level of the clock line during the time-out. The control bit of
//! the encoder (CDS) follows one frame later: in frame k, the encoder responds to the bit that the host sent in frame
//! k−1.

use bridge_codec::ErrorCode;

/// An access to a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RegisterAccess {
    /// Number of the encoder on the line, 0 to 7.
    pub slave: u8,
    /// Register address, 00h to 7Fh.
    pub address: u8,
    /// Value to write, or `None` to read.
    pub value: Option<u8>,
}

/// The reason why a register access has failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlError {
    /// A frame could not be read.
    NoFrame,
    /// No encoder with this number responds.
    NoSlave,
    /// The encoder does not accept the access.
    Refused,
    /// The encoder did not respond within the processing time.
    NotReady,
    /// The checksum of the reply does not match.
    Checksum,
}

/// Number of 0 bits that terminate an earlier control frame.
const PAUSE: usize = 14;
/// Maximum number of frames by which an encoder may delay a register value. The maximum is not documented (`U`).
const PROCESSING: usize = 50;

impl ControlError {
    /// Returns the error code and message to send to the host.
    pub const fn refusal(self) -> (ErrorCode, &'static str) {
        match self {
            ControlError::NoFrame => (ErrorCode::NO_REPLY, "the encoder does not answer"),
            ControlError::NoSlave => (ErrorCode::NO_REPLY, "no encoder with this number answers"),
            ControlError::Refused => (ErrorCode::NO_REPLY, "the encoder refuses the register"),
            ControlError::NotReady => (ErrorCode::NO_REPLY, "the encoder does not provide the register"),
            ControlError::Checksum => (ErrorCode::INVALID_REPLY, "CRC of the control frame"),
        }
    }
}

/// Reads or writes a register. `frame` sends one bit and returns the encoder's bit in the same frame, or `None` if the
/// frame could not be read. Returns the value sent by the encoder.
///
/// # Errors
/// Returns a [`ControlError`] if the access fails. The encoder ignores an incomplete access.
pub fn access_register(
    access: RegisterAccess,
    mut frame: impl FnMut(bool) -> Option<bool>,
) -> Result<u8, ControlError> {
    let mut exchange = |cdm: bool| frame(cdm).ok_or(ControlError::NoFrame);
    for _ in 0..PAUSE {
        exchange(false)?;
    }
    // Bits 0 to 15: start, register access, slave, address and checksum.
    let selection = 1 << 10 | u32::from(access.slave & 7) << 7 | u32::from(access.address & 0x7F);
    let header = 1 << 15 | selection << 4 | crc4(selection, 11);
    let mut locked = 0_u32;
    for at in (0..16).rev() {
        locked = locked << 1 | u32::from(exchange(header >> at & 1 == 1)?);
    }
    // Bits 1 to 8 from the encoder represent slaves 0 to 7.
    if locked >> (14 - (access.slave & 7)) & 1 == 0 {
        return Err(ControlError::NoSlave);
    }
    let is_write = access.value.is_some();
    exchange(!is_write)?;
    let reads = exchange(is_write)?;
    let writes = exchange(true)?;
    if (reads, writes) != (!is_write, is_write) {
        return Err(ControlError::Refused);
    }
    // In a write, the value and its checksum follow the start bit. In a read, zeros follow.
    let data = access.value.map_or(0, |value| u32::from(value) << 4 | crc4(value.into(), 8));
    let mut bits = (0..12).rev().map(|at| data >> at & 1 == 1);
    let mut is_ready = exchange(bits.next().unwrap_or(false))?;
    // An encoder that is not ready would miss the data of a write, so the write ends here. A read repeats the start
    // bit, because 14 bits of 0 would end the control frame.
    for _ in 0..if is_write { 0 } else { PROCESSING } {
        if is_ready {
            break;
        }
        is_ready = exchange(true)?;
    }
    if !is_ready {
        return Err(ControlError::NotReady);
    }
    let mut answer = 0_u32;
    for _ in 0..12 {
        answer = answer << 1 | u32::from(exchange(bits.next().unwrap_or(false))?);
    }
    // The stop bit.
    exchange(false)?;
    let value = answer >> 4;
    if crc4(value, 8) != answer & 0xF {
        return Err(ControlError::Checksum);
    }
    // The value has eight bits.
    Ok(value as u8)
}

/// Calculates the CRC of the lowest `count` bits: polynomial x⁴ + x + 1, initial value 0, inverted result.
fn crc4(bits: u32, count: u32) -> u32 {
    let crc = (0..count).rev().fold(0, |crc, at| {
        let feedback = (crc >> 3 ^ bits >> at) & 1;
        (crc << 1 & 0xF) ^ (feedback * 3)
    });
    crc ^ 0xF
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::{String, ToString};
    use std::vec::Vec;

    /// The expected checksums are from `protocol/biss.md`, section 3.
    #[test]
    fn checksums_match_reference() {
        let header = [(0x00, 0x6), (0x05, 0x9), (0x40, 0x1), (0x42, 0x7), (0x66, 0x1), (0x68, 0x0), (0x69, 0x3)];
        for (address, crc) in header.into_iter().chain([(0x6A, 0x6), (0x6B, 0x5), (0x6E, 0xA), (0x7F, 0xC)]) {
            assert_eq!(crc4(1 << 10 | address, 11), crc, "{address:02X}");
        }
        let data = [(0x00, 0xF), (0x01, 0xC), (0x2A, 0x8), (0x46, 0x2), (0x4B, 0x6), (0x80, 0x1), (0xFF, 0xB)];
        for (value, crc) in data {
            assert_eq!(crc4(value, 8), crc, "{value:02X}");
        }
    }

    /// Simulates an encoder that sends the given control bits, starting at bit 0. Returns the result and the host's
    /// bits.
    fn play(access: RegisterAccess, answer: &str) -> (Result<u8, ControlError>, String) {
        let mut answer = answer.chars().filter(|bit| *bit != ' ').map(|bit| bit == '1');
        let mut sent = Vec::new();
        let result = access_register(access, |cdm| {
            sent.push(cdm);
            if sent.len() <= PAUSE { Some(false) } else { Some(answer.next().unwrap_or(false)) }
        });
        assert!(sent.iter().take(PAUSE).all(|bit| !bit));
        (result, sent.iter().skip(PAUSE).map(|bit| u8::from(*bit).to_string()).collect())
    }

    const READ: &str = "0 10000000 00000000 1 0";
    const WRITE: &str = "0 10000000 00000000 0 1";

    fn read(address: u8) -> RegisterAccess {
        RegisterAccess { slave: 0, address, value: None }
    }

    /// The expected bits are from `protocol/biss.md`, section 3. A read takes one more frame for the stop bit.
    #[test]
    fn host_bits_match_reference() {
        for (address, bits) in [
            (0x00, "11000000000001101010000000000000"),
            (0x05, "11000000010110011010000000000000"),
            (0x42, "11000100001001111010000000000000"),
            (0x66, "11000110011000011010000000000000"),
            (0x6B, "11000110101101011010000000000000"),
            (0x7F, "11000111111111001010000000000000"),
        ] {
            let (result, sent) = play(read(address), &[READ, "1 01001011 0110 0"].concat());
            assert_eq!((result, sent.as_str()), (Ok(0x4B), [bits, "0"].concat().as_str()), "{address:02X}");
        }
        for (address, value, bits, answer) in [
            (0x40, 0x01, "11000100000000010110000000111000", "1 00000001 1100 0"),
            (0x6B, 0x2A, "11000110101101010110010101010000", "1 00101010 1000 0"),
            (0x6A, 0x00, "11000110101001100110000000011110", "1 00000000 1111 0"),
            (0x03, 0x80, "11000000001100110111000000000010", "1 10000000 0001 0"),
        ] {
            let access = RegisterAccess { slave: 0, address, value: Some(value) };
            let (result, sent) = play(access, &[WRITE, answer].concat());
            assert_eq!(
                (result, sent.as_str()),
                (Ok(value), [bits, "0"].concat().as_str()),
                "{address:02X}={value:02X}"
            );
        }
    }

    #[test]
    fn waits_for_late_value() {
        let late = [READ, &"0".repeat(50), "1 01001011 0110 0"].concat();
        let (result, sent) = play(read(0x66), &late);
        assert_eq!(result, Ok(0x4B));
        assert!(!sent.contains(&"0".repeat(14)), "14 zeros would end the access: {sent}");
        let never = [READ, &"0".repeat(51), "1 01001011 0110 0"].concat();
        assert_eq!(play(read(0x66), &never).0, Err(ControlError::NotReady));
        let access = RegisterAccess { slave: 0, address: 0x40, value: Some(1) };
        let (result, sent) = play(access, &[WRITE, "0 1 00000001 1100 0"].concat());
        assert_eq!((result, sent.len()), (Err(ControlError::NotReady), 20), "no more data are sent");
    }

    #[test]
    fn distinguishes_failures() {
        let cases = [
            ("0 00000000 00000000 1 0 1 01001011 0110 0", ControlError::NoSlave),
            ("0 10000000 00000000 0 0 1 01001011 0110 0", ControlError::Refused),
            ("0 10000000 00000000 0 1 1 01001011 0110 0", ControlError::Refused),
            ("0 10000000 00000000 1 0 1 01001011 0111 0", ControlError::Checksum),
            ("0 10000000 00000000 1 0 1 01001010 0110 0", ControlError::Checksum),
        ];
        for (answer, error) in cases {
            assert_eq!(play(read(0x66), answer).0, Err(error), "{answer}");
        }
        let mut frames = 0;
        let broken = access_register(read(0x66), |_| {
            frames += 1;
            (frames != 20).then_some(false)
        });
        assert_eq!((broken, frames), (Err(ControlError::NoFrame), 20));
    }

    /// Bits 1 to 8 of a control frame select slaves 0 to 7.
    #[test]
    fn slaves_have_separate_bits() {
        let access = RegisterAccess { slave: 2, address: 0x66, value: None };
        let answer = |locked: &str| ["0", locked, "00000000 1 0", "1 01001011 0110 0"].concat();
        assert_eq!(play(access, &answer("00100000")).0, Ok(0x4B));
        assert_eq!(play(access, &answer("10000000")).0, Err(ControlError::NoSlave));
    }
}
