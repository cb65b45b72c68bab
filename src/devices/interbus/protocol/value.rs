//! The two numeric parts of a process data word (reference 2).

/// Bits 24..0 of a word: a position, parameter data or a cam edge, 0 to 1FFFFFFh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(u32);

/// Bits 28..25 of a word: a parameter, cam or error code, 0 to 15.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Code(u8);

impl Value {
    /// Width of the field in bits.
    pub const BITS: u32 = 25;
    /// Maximum value, 1FFFFFFh.
    pub const MAX: Value = Value((1 << Value::BITS) - 1);

    /// Creates a value, or returns `None` if the number has more than 25 bits.
    pub const fn new(number: u32) -> Option<Self> {
        if number <= Value::MAX.0 { Some(Value(number)) } else { None }
    }

    /// Returns the value as a number.
    pub const fn get(self) -> u32 {
        self.0
    }

    /// Returns the value as a signed number with its sign in bit 24, as used for speeds (`U`: not documented). See
    /// reference 6.13.
    pub const fn to_signed(self) -> i32 {
        let above = u32::BITS - Value::BITS;
        (self.0 << above) as i32 >> above
    }

    /// Extracts the value from the lower 25 bits of a word.
    pub const fn from_word(word: u32) -> Self {
        Value(word & Value::MAX.0)
    }
}

impl Code {
    /// Creates a code, or returns `None` if the number has more than 4 bits.
    pub const fn new(code: u8) -> Option<Self> {
        if code < 16 { Some(Code(code)) } else { None }
    }

    /// Returns the code as a number.
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Extracts the code from bits 28..25 of a word.
    pub const fn from_word(word: u32) -> Self {
        Code((word >> Value::BITS & 0xF) as u8)
    }

    /// Returns the code shifted to bits 28..25.
    pub const fn to_word_bits(self) -> u32 {
        (self.0 as u32) << Value::BITS
    }
}
