//! The display format of addresses in a hex editor.

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HexAddresses {
    /// Address counted from the first byte, such as `0x1F`.
    #[default]
    Counted,
    /// Address given as bank and offset, such as `0x24:0x1F`.
    Banked {
        /// Number of the bank that starts with the first byte.
        first: usize,
        size: usize,
    },
}

impl HexAddresses {
    /// Formats an address in hexadecimal. It has as many digits as the last of `len` addresses needs, but at least two.
    pub(super) fn text(self, at: usize, len: usize) -> String {
        match self.bank_and_offset(at) {
            (None, at) => format!("0x{at:0digits$X}", digits = digit_count(len)),
            (Some(bank), offset) => format!("0x{bank:02X}:0x{offset:02X}"),
        }
    }

    pub(super) fn heading(self, at: usize, len: usize) -> String {
        self.text(at, len).replace("0x", "")
    }

    pub(super) fn width(self, len: usize) -> usize {
        self.heading(len.saturating_sub(1), len).len()
    }

    fn bank_and_offset(self, at: usize) -> (Option<usize>, usize) {
        match self {
            HexAddresses::Counted => (None, at),
            HexAddresses::Banked { first, size } => {
                let size = size.max(1);
                (Some(first + at / size), at % size)
            }
        }
    }
}

fn digit_count(len: usize) -> usize {
    format!("{:X}", len.saturating_sub(1)).len().max(2)
}

#[cfg(test)]
mod tests {
    use super::HexAddresses::{Banked, Counted};

    #[test]
    fn addresses_count_up_or_have_bank() {
        assert_eq!((Counted.text(0x1F, 32), Counted.heading(0x10, 32)), ("0x1F".to_owned(), "10".to_owned()));
        assert_eq!((Counted.text(0x1F, 2048).as_str(), Counted.width(2048)), ("0x01F", 3));
        let banked = Banked { first: 0x24, size: 64 };
        assert_eq!((banked.text(0x4A, 2048).as_str(), banked.heading(0x40, 2048).as_str()), ("0x25:0x0A", "25:00"));
        assert_eq!(banked.width(2048), 5);
    }
}
