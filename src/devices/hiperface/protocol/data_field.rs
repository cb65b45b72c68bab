//! Data fields, the partitions of the encoder's EEPROM (manual, "Datenspeicherung und Verwaltung", figure 28).

use std::fmt;

/// Number of the read-only field that contains the extended type label.
pub const EXTENDED_LABEL_FIELD: u8 = 0xFF;

/// Maximum number of data bytes in a request with command 4Ah or 4Bh.
pub const MAX_TRANSFER: usize = 128;

/// Number of an access code, 0 to 3. An encoder has four access codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AccessCodeNumber(u8);

impl AccessCodeNumber {
    /// Access code 0, which also protects the settings of the encoder.
    pub const ZERO: AccessCodeNumber = AccessCodeNumber(0);

    /// Creates an access code number 0 to 3, or returns `None` for a greater number.
    pub const fn new(number: u8) -> Option<Self> {
        if number < 4 { Some(AccessCodeNumber(number)) } else { None }
    }

    /// Returns all four numbers.
    pub fn all() -> impl Iterator<Item = AccessCodeNumber> {
        (0..4).map(AccessCodeNumber)
    }

    /// Returns the number.
    pub const fn get(self) -> u8 {
        self.0
    }
}

impl fmt::Display for AccessCodeNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// Access code. It never appears in a log, a trace, an error or test output.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct AccessCode(u8);

impl AccessCode {
    /// Factory value of all four access codes, 55h.
    pub const FACTORY: AccessCode = AccessCode(0x55);

    /// Creates an access code from a byte. Every byte is valid.
    pub const fn new(byte: u8) -> Self {
        AccessCode(byte)
    }

    /// Returns the byte to be sent.
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl fmt::Debug for AccessCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("AccessCode(**)")
    }
}

/// Size of a data field: a multiple of 16 bytes, from 16 to 128.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FieldSize(u8);

impl FieldSize {
    /// Size in bytes of a block, the unit of memory allocation.
    pub const BLOCK: usize = 16;

    /// Creates a size from a number of bytes, which must be a multiple of 16 from 16 to 128. Returns `None` otherwise.
    pub fn from_bytes(bytes: usize) -> Option<Self> {
        if !bytes.is_multiple_of(Self::BLOCK) {
            return None;
        }
        Self::from_blocks(u8::try_from(bytes / Self::BLOCK).ok()?)
    }

    /// Creates a size from a number of blocks from 1 to 8, or returns `None` for any other number.
    pub const fn from_blocks(blocks: u8) -> Option<Self> {
        if 0 < blocks && blocks <= 8 { Some(FieldSize(blocks)) } else { None }
    }

    /// Returns all sizes, smallest first.
    pub fn all() -> impl Iterator<Item = FieldSize> {
        (1..=8).map(FieldSize)
    }

    /// Returns the size in bytes.
    pub const fn bytes(self) -> usize {
        self.0 as usize * Self::BLOCK
    }

    /// Returns the size in blocks of 16 bytes.
    pub const fn block_count(self) -> u8 {
        self.0
    }
}

/// Status byte of a data field, used in commands 4Ch and 4Dh.
///
/// | bit | 7 | 6 | 5..4 | 3 | 2..0 |
/// |---|---|---|---|---|---|
/// | | E exists | WE write enable | access code 0…3 | CE code required | blocks − 1 |
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct DataFieldStatus(u8);

impl DataFieldStatus {
    const EXISTS: u8 = 0x80;
    const WRITE_ENABLE: u8 = 0x40;
    const CODE_REQUIRED: u8 = 0x08;

    /// Creates a status from its byte. Every byte is valid.
    pub const fn from_byte(byte: u8) -> Self {
        DataFieldStatus(byte)
    }

    /// Creates the status of an existing, writable field.
    pub const fn new(size: FieldSize, code: AccessCodeNumber, code_required: bool) -> Self {
        let required = if code_required { Self::CODE_REQUIRED } else { 0 };
        DataFieldStatus(Self::EXISTS | Self::WRITE_ENABLE | code.0 << 4 | required | (size.0 - 1))
    }

    /// Returns the status byte as transmitted.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns whether the field exists (bit E).
    pub const fn exists(self) -> bool {
        self.0 & Self::EXISTS != 0
    }

    /// Returns whether the field may be written (bit WE).
    pub const fn is_writable(self) -> bool {
        self.0 & Self::WRITE_ENABLE != 0
    }

    /// Returns the access code that protects the field.
    pub const fn code(self) -> AccessCodeNumber {
        AccessCodeNumber(self.0 >> 4 & 3)
    }

    /// Returns whether reading and writing require the access code (bit CE).
    pub const fn code_required(self) -> bool {
        self.0 & Self::CODE_REQUIRED != 0
    }

    /// Returns the field size, which is (SIZE + 1) · 16 bytes.
    pub const fn size(self) -> FieldSize {
        FieldSize((self.0 & 7) + 1)
    }

    /// Returns a copy of the status with writing enabled or disabled.
    #[must_use]
    pub const fn with_write_enable(self, writable: bool) -> Self {
        DataFieldStatus(if writable { self.0 | Self::WRITE_ENABLE } else { self.0 & !Self::WRITE_ENABLE })
    }

    /// Returns a copy of the status with another access code. `required` sets bit CE.
    #[must_use]
    pub const fn with_code(self, code: AccessCodeNumber, required: bool) -> Self {
        let rest = self.0 & !(Self::CODE_REQUIRED | 0x30);
        DataFieldStatus(rest | code.0 << 4 | if required { Self::CODE_REQUIRED } else { 0 })
    }

    /// Returns a copy of the status with another size.
    #[must_use]
    pub const fn with_size(self, size: FieldSize) -> Self {
        DataFieldStatus(self.0 & !7 | (size.0 - 1))
    }

    /// Returns a copy of the status with bit E cleared. A request with command 4Dh and this status deletes the field.
    #[must_use]
    pub const fn as_deleted(self) -> Self {
        DataFieldStatus(self.0 & !Self::EXISTS)
    }
}

impl fmt::Debug for DataFieldStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02X}h ({self})", self.0)
    }
}

impl fmt::Display for DataFieldStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.exists() {
            return f.write_str("not defined");
        }
        let access = if self.is_writable() { "writable" } else { "write protected" };
        let code = if self.code_required() { "code required" } else { "code not required" };
        write!(f, "{} bytes, {access}, code {}, {code}", self.size().bytes(), self.code())
    }
}

/// Free memory of the encoder, as reported in the reply to 4Eh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FreeMemory {
    /// Number of free blocks of 16 bytes.
    pub blocks: u8,
    /// Number of data fields, excluding the extended label.
    pub fields: u8,
}

impl FreeMemory {
    /// Returns the free memory in bytes.
    pub fn bytes(self) -> usize {
        usize::from(self.blocks) * FieldSize::BLOCK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_bytes_match_reference() {
        // byte, exists, writable, code, code required, size
        let cases = [
            (0xC9, true, true, 0, true, 32),
            (0xE0, true, true, 2, false, 16),
            (0xE8, true, true, 2, true, 16),
            (0xC8, true, true, 0, true, 16),
            (0xCF, true, true, 0, true, 128),
            (0xA8, true, false, 2, true, 16),
            (0x8B, true, false, 0, true, 64),
            (0x83, true, false, 0, false, 64),
            (0x49, false, true, 0, true, 32),
        ];
        for (byte, exists, writable, code, required, size) in cases {
            let status = DataFieldStatus::from_byte(byte);
            assert_eq!(status.exists(), exists, "{byte:02X}");
            assert_eq!(status.is_writable(), writable, "{byte:02X}");
            assert_eq!(status.code().get(), code, "{byte:02X}");
            assert_eq!(status.code_required(), required, "{byte:02X}");
            assert_eq!(status.size().bytes(), size, "{byte:02X}");
        }
    }

    #[test]
    fn status_encoding_matches_manual() {
        let size = FieldSize::from_bytes(32).unwrap();
        let status = DataFieldStatus::new(size, AccessCodeNumber::ZERO, true);
        assert_eq!(status.byte(), 0xC9);
        assert_eq!(status.as_deleted().byte(), 0x49);
        assert_eq!(DataFieldStatus::from_byte(0xE8).with_write_enable(false).byte(), 0xA8);
        assert_eq!(status.with_size(FieldSize::from_bytes(128).unwrap()).byte(), 0xCF);
    }

    #[test]
    fn rounds_sizes_to_blocks() {
        assert!([0, 1, 15, 17, 127, 129, 144].iter().all(|bytes| FieldSize::from_bytes(*bytes).is_none()));
        assert_eq!(FieldSize::all().map(FieldSize::bytes).collect::<Vec<_>>(), [16, 32, 48, 64, 80, 96, 112, 128]);
    }

    #[test]
    fn debug_output_hides_access_code() {
        assert_eq!(format!("{:?}", AccessCode::FACTORY), "AccessCode(**)");
    }
}
