//! The three encoder classes with their identification codes on the bus, and the words of K1 and K2 encoders, which
//! accept no commands (reference 1).

use super::value::Value;

/// Class of an encoder, which determines the process data that it exchanges with its master.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Class {
    /// An IN word of 16 bits, which contains the position.
    K1,
    /// An IN word of 32 bits, which contains the position.
    K2,
    /// An IN word and an OUT word of 32 bits each: seven bits for status or command, and 25 data bits.
    K3,
}

/// Physical layer of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interface {
    /// Copper cable.
    Standard,
    /// Optical fibre (*LWL*).
    OpticalFibre,
    /// INTERBUS Loop 2.
    Loop2,
}

impl Interface {
    /// All interfaces in the order of the manual.
    pub const ALL: [Interface; 3] = [Interface::Standard, Interface::OpticalFibre, Interface::Loop2];
}

impl Class {
    /// All classes.
    pub const ALL: [Class; 3] = [Class::K1, Class::K2, Class::K3];

    /// Returns the number of bytes that the encoder sends, and the number that it receives.
    pub const fn bytes(self) -> (usize, usize) {
        match self {
            Class::K1 => (2, 0),
            Class::K2 => (4, 0),
            Class::K3 => (4, 4),
        }
    }
}

/// Returns the identification code of an encoder. The manual gives the code of K3 with copper or fibre as 36h (55), but
/// 55 is 37h (manual 5.1, reference 6.1).
pub const fn id_code(class: Class, interface: Interface) -> u8 {
    match (class, interface) {
        (Class::K1 | Class::K2, Interface::Standard | Interface::OpticalFibre) => 0x36,
        (Class::K1 | Class::K2, Interface::Loop2) => 0xB2,
        (Class::K3, Interface::Standard | Interface::OpticalFibre) => 0x37,
        (Class::K3, Interface::Loop2) => 0xB3,
    }
}

/// Returns the devices with an identification code. Several devices may share a code, and an unknown code has none.
pub fn devices_with_id(code: u8) -> impl Iterator<Item = (Class, Interface)> {
    Class::ALL
        .into_iter()
        .flat_map(|class| Interface::ALL.map(|interface| (class, interface)))
        .filter(move |(class, interface)| id_code(*class, *interface) == code)
}

/// The word of a K1 or K2 encoder, with the position right-justified. The bits above it should be 0, but are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SingleWord {
    /// 12 position bits of a single-turn encoder in a 16-bit word.
    K1(u16),
    /// Up to 25 position bits in a 32-bit word.
    K2(u32),
}

impl SingleWord {
    /// Creates the word of a K1 encoder.
    pub const fn parse_k1(word: u16) -> Self {
        SingleWord::K1(word)
    }

    /// Creates the word of a K2 encoder.
    pub const fn parse_k2(word: u32) -> Self {
        SingleWord::K2(word)
    }

    /// Returns the word with the position in its lowest bits.
    pub const fn emit(self) -> u32 {
        match self {
            SingleWord::K1(word) => word as u32,
            SingleWord::K2(word) => word,
        }
    }

    /// Returns the position in steps.
    pub const fn position(self) -> Value {
        match self {
            SingleWord::K1(word) => Value::from_word((word & 0x0FFF) as u32),
            SingleWord::K2(word) => Value::from_word(word),
        }
    }

    /// Returns the bits above the position that should be 0 but are set.
    pub const fn unexpected_bits(self) -> u32 {
        self.emit() & !self.position().get()
    }
}
