//! The encoder's side of the control frame.

use super::super::crc::crc4;
use super::{REGISTERS, REST_CYCLES, append_crc4};

/// The encoder's side of the control channel. For each cycle, call [`next_cds`](Self::next_cds) at its start and
/// [`receive_cdm`](Self::receive_cdm) at its end.
#[derive(Clone, Debug)]
pub struct Encoder {
    slave: u8,
    zeros: u8,
    state: State,
}

/// A register access by the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The host reads a register and waits until [`Encoder::provide_value`] supplies its value.
    Read {
        /// Register address, 00h to 7Fh.
        address: u8,
    },
    /// The host writes a register.
    Write {
        /// Register address, 00h to 7Fh.
        address: u8,
        /// Value to write.
        value: u8,
    },
    /// The frame is damaged and has no effect.
    Damaged,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Waiting for a start bit, or for the zeros that must come first.
    Rest,
    /// Ignoring a frame that is damaged or addressed to another encoder.
    Ignoring,
    /// Receiving the head of a frame. `bits` holds the first `cycle` bits, the latest in bit 0.
    Head { bits: u32, cycle: u8 },
    /// About to send the start bit S. A read must wait until its value is known.
    Start { address: u8, access: Access },
    /// Sending DATA and CRC4. After the start bit S, `sent` bits of `word` have been sent. For a write, received bits
    /// are appended to `word`.
    Data { address: u8, access: Access, word: u16, sent: u8 },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    /// Read access. The reply, DATA and CRC4, is `None` until the value is known.
    Read(Option<u16>),
    Write,
}

impl Encoder {
    /// Number of bits in the header: S, CTS, ID, ADR and CRC4.
    const HEADER_BITS: u8 = 16;
    /// Number of bits in the head, which is the header followed by R and W.
    const HEAD_BITS: u8 = 18;
    const WORD_BITS: u8 = 12;

    /// Creates the control channel of an encoder with the given number on the line, 0 to 7. A kit encoder has number 0.
    pub fn new(slave: u8) -> Self {
        Encoder { slave: slave & 7, zeros: 0, state: State::Rest }
    }

    /// Starts a cycle, and returns its CDS bit.
    pub fn next_cds(&mut self) -> bool {
        match self.state {
            State::Rest | State::Ignoring | State::Start { access: Access::Read(None), .. } => false,
            State::Head { bits, cycle } => match cycle {
                1..=8 => cycle == self.slave + 1,
                17 | 18 => bits & 1 == 1,
                _ => false,
            },
            State::Start { address, access } => {
                let word = match access {
                    Access::Read(word) => word.unwrap_or(0),
                    Access::Write => 0,
                };
                self.state = State::Data { address, access, word, sent: 0 };
                true
            }
            State::Data { sent: 0, .. } => true,
            State::Data { access: Access::Write, word, .. } => word & 1 == 1,
            State::Data { word, sent, .. } => word >> (Self::WORD_BITS - sent) & 1 == 1,
        }
    }

    /// Ends a cycle with its CDM bit, and returns the resulting event, if any.
    pub fn receive_cdm(&mut self, bit: bool) -> Option<Event> {
        let rested = self.zeros >= REST_CYCLES;
        self.zeros = if bit { 0 } else { self.zeros.saturating_add(1) };
        if self.zeros >= REST_CYCLES {
            self.state = State::Rest;
            return None;
        }
        let (state, event) = match self.state {
            State::Rest if bit && rested => (State::Head { bits: 1, cycle: 1 }, None),
            State::Rest | State::Ignoring | State::Start { .. } => (self.state, None),
            State::Head { bits, cycle } => self.receive_head(bits << 1 | u32::from(bit), cycle + 1),
            State::Data { address, access, word, sent } if sent < Self::WORD_BITS => {
                transfer_bit(address, access, word, bit, sent + 1)
            }
            State::Data { address, access, .. } if bit && address + 1 < REGISTERS => {
                begin_transfer(address + 1, access)
            }
            State::Data { .. } if bit => (State::Ignoring, None),
            State::Data { .. } => (State::Rest, None),
        };
        self.state = state;
        event
    }

    /// Supplies the value of the requested register. Has no effect if no read is pending.
    pub fn provide_value(&mut self, value: u8) {
        if let State::Start { access: access @ Access::Read(None), .. } = &mut self.state {
            *access = Access::Read(Some(append_crc4(value)));
        }
    }

    fn receive_head(&self, bits: u32, cycle: u8) -> (State, Option<Event>) {
        match cycle {
            Self::HEADER_BITS => {
                let header = (bits >> 4 & 0x7FF) as u16;
                let (register_access, slave) = (header & 0x400 != 0, (header >> 7 & 7) as u8);
                if u32::from(crc4(header, 11)) != bits & 0xF {
                    (State::Ignoring, Some(Event::Damaged))
                } else if register_access && slave == self.slave {
                    (State::Head { bits, cycle }, None)
                } else {
                    (State::Ignoring, None)
                }
            }
            Self::HEAD_BITS if !matches!(bits & 3, 0b01 | 0b10) => (State::Ignoring, None),
            0..=Self::HEAD_BITS => (State::Head { bits, cycle }, None),
            // The start bit S after R and W is missing.
            _ if bits & 1 == 0 => (State::Ignoring, None),
            _ => {
                let access = if bits & 0b100 != 0 { Access::Read(None) } else { Access::Write };
                begin_transfer((bits >> 7 & 0x7F) as u8, access)
            }
        }
    }
}

fn begin_transfer(address: u8, access: Access) -> (State, Option<Event>) {
    match access {
        Access::Read(_) => (State::Start { address, access: Access::Read(None) }, Some(Event::Read { address })),
        Access::Write => (State::Start { address, access }, None),
    }
}

/// Handles one bit of DATA and CRC4. `sent` counts the bits sent, including this one.
fn transfer_bit(address: u8, access: Access, word: u16, bit: bool, sent: u8) -> (State, Option<Event>) {
    if access != Access::Write {
        return (State::Data { address, access, word, sent }, None);
    }
    let word = word << 1 | u16::from(bit);
    let value = (word >> 4) as u8;
    let event = (sent == Encoder::WORD_BITS).then_some(match append_crc4(value) == word {
        true => Event::Write { address, value },
        false => Event::Damaged,
    });
    (State::Data { address, access, word, sent }, event)
}
