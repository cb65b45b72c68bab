//! The two number fields of a word (reference 2).

/// Bits 24..0 of a word: a position, a parameter's data, a cam's edge. 0 to 1FFFFFFh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(u32);

/// Bits 28..25 of a word: the parameter, cam or error. 0 to 15.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Code(u8);

impl Value {
    /// Bits of the field.
    pub const BITS: u32 = 25;
    /// 1FFFFFFh.
    pub const MAX: Value = Value((1 << Value::BITS) - 1);

    /// Creates it from a number; `None` beyond 25 bits.
    pub const fn new(number: u32) -> Option<Self> {
        if number <= Value::MAX.0 { Some(Value(number)) } else { None }
    }

    /// Returns its number.
    pub const fn get(self) -> u32 {
        self.0
    }

    /// Returns the number with a sign in bit 24, as for a speed (`U`, reference 6.13).
    pub const fn signed(self) -> i32 {
        let above = u32::BITS - Value::BITS;
        (self.0 << above) as i32 >> above
    }

    /// Returns the value in the lower 25 bits of a word.
    pub const fn of_word(word: u32) -> Self {
        Value(word & Value::MAX.0)
    }
}

impl Code {
    /// Creates it from a number; `None` beyond 4 bits.
    pub const fn new(code: u8) -> Option<Self> {
        if code < 16 { Some(Code(code)) } else { None }
    }

    /// Returns its number.
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Creates the field of a word.
    pub const fn of_word(word: u32) -> Self {
        Code((word >> Value::BITS & 0xF) as u8)
    }

    /// Returns the value at its position in a word.
    pub const fn in_word(self) -> u32 {
        (self.0 as u32) << Value::BITS
    }
}
