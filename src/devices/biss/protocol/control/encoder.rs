//! The encoder's side of the control frame.

use super::super::crc::crc4;
use super::{REGISTERS, REST_CYCLES, with_crc};

/// An encoder's control channel, cycle by cycle: [`cds`](Self::cds) at the start of a cycle, [`cdm`](Self::cdm) at its
/// end.
#[derive(Clone, Debug)]
pub struct Encoder {
    slave: u8,
    zeros: u8,
    state: State,
}

/// The request of a cycle to the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// A register has to be read; [`Encoder::answer`] supplies the value. Until then the host waits.
    Read {
        /// 00h…7Fh.
        address: u8,
    },
    /// A register is to be written.
    Write {
        /// 00h…7Fh.
        address: u8,
        /// The new value.
        value: u8,
    },
    /// The frame is damaged: it has no effect.
    Damaged,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// The zeros before a start bit are still to come, or are there.
    Rest,
    /// A frame that is not for this encoder, or cannot be understood.
    Ignoring,
    /// `cycle` bits have come, the first is the highest.
    Head { bits: u32, cycle: u8 },
    /// The host has sent its S and waits for that of this side.
    Start { address: u8, access: Access },
    /// This side has sent its S and then `sent` bits of `word`, which is DATA and CRC4. In a write, `word` grows with the
    /// received bits.
    Data { address: u8, access: Access, word: u16, sent: u8 },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    /// With DATA and CRC4, once they are known.
    Read(Option<u16>),
    Write,
}

impl Encoder {
    /// S, CTS, ID, ADR, CRC4.
    const HEADER_BITS: u8 = 16;
    /// The header, R, W.
    const HEAD_BITS: u8 = 18;
    const WORD_BITS: u8 = 12;

    /// Creates the control channel of the encoder with this number on its line, 0…7; the kit encoder is 0.
    pub fn new(slave: u8) -> Self {
        Encoder { slave: slave & 7, zeros: 0, state: State::Rest }
    }

    /// Returns CDS of the cycle that begins.
    pub fn cds(&mut self) -> bool {
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

    /// Returns CDM of the cycle that ends.
    pub fn cdm(&mut self, bit: bool) -> Option<Event> {
        let rested = self.zeros >= REST_CYCLES;
        self.zeros = if bit { 0 } else { self.zeros.saturating_add(1) };
        if self.zeros >= REST_CYCLES {
            self.state = State::Rest;
            return None;
        }
        let (state, event) = match self.state {
            State::Rest if bit && rested => (State::Head { bits: 1, cycle: 1 }, None),
            State::Rest | State::Ignoring | State::Start { .. } => (self.state, None),
            State::Head { bits, cycle } => self.head(bits << 1 | u32::from(bit), cycle + 1),
            State::Data { address, access, word, sent } if sent < Self::WORD_BITS => {
                transfer(address, access, word, bit, sent + 1)
            }
            State::Data { address, access, .. } if bit && address + 1 < REGISTERS => begin(address + 1, access),
            State::Data { .. } if bit => (State::Ignoring, None),
            State::Data { .. } => (State::Rest, None),
        };
        self.state = state;
        event
    }

    /// Supplies the value of the register that was requested last. Without a request it has no effect.
    pub fn answer(&mut self, value: u8) {
        if let State::Start { access: access @ Access::Read(None), .. } = &mut self.state {
            *access = Access::Read(Some(with_crc(value)));
        }
    }

    fn head(&self, bits: u32, cycle: u8) -> (State, Option<Event>) {
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
            // The S after R and W.
            _ if bits & 1 == 0 => (State::Ignoring, None),
            _ => {
                let access = if bits & 0b100 != 0 { Access::Read(None) } else { Access::Write };
                begin((bits >> 7 & 0x7F) as u8, access)
            }
        }
    }
}

/// The host has sent S for a register.
fn begin(address: u8, access: Access) -> (State, Option<Event>) {
    match access {
        Access::Read(_) => (State::Start { address, access: Access::Read(None) }, Some(Event::Read { address })),
        Access::Write => (State::Start { address, access }, None),
    }
}

/// Handles a bit of DATA and CRC4; `sent` counts it.
fn transfer(address: u8, access: Access, word: u16, bit: bool, sent: u8) -> (State, Option<Event>) {
    if access != Access::Write {
        return (State::Data { address, access, word, sent }, None);
    }
    let word = word << 1 | u16::from(bit);
    let value = (word >> 4) as u8;
    let event = (sent == Encoder::WORD_BITS).then_some(match with_crc(value) == word {
        true => Event::Write { address, value },
        false => Event::Damaged,
    });
    (State::Data { address, access, word, sent }, event)
}
