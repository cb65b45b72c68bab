//! Parameter values in CIP: strings, and numbers whose length depends on the type (reference, section 7).

/// Type of a parameter value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Unsigned, 8 bits.
    U8,
    /// Signed, 8 bits.
    I8,
    /// Unsigned, 16 bits.
    U16,
    /// Signed, 16 bits.
    I16,
    /// Unsigned, 32 bits.
    U32,
    /// Signed, 32 bits.
    I32,
    /// ASCII string.
    Text,
}

/// A parameter value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// A number of any integer type.
    Number(i64),
    /// A string.
    Text(String),
}

/// Reason why data or a value does not match a type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// The length does not match the type.
    #[error("the value has the wrong length (bytes received: {got}, expected: {expected})")]
    Length {
        /// Required length in bytes.
        expected: usize,
        /// Actual length in bytes.
        got: usize,
    },
    /// The number is out of the range of the type.
    #[error("{number} is outside the range {low} to {high}")]
    Number {
        /// Rejected number.
        number: i64,
        /// Minimum value.
        low: i64,
        /// Maximum value.
        high: i64,
    },
    /// A number was given for a string parameter.
    #[error("the value must be text, not a number")]
    NumberForText,
    /// A string was given for a numeric parameter.
    #[error("the value must be a number, not text")]
    TextForNumber,
}

impl Kind {
    /// Returns the length in bytes, or `None` for strings.
    pub const fn byte_length(self) -> Option<usize> {
        match self {
            Kind::U8 | Kind::I8 => Some(1),
            Kind::U16 | Kind::I16 => Some(2),
            Kind::U32 | Kind::I32 => Some(4),
            Kind::Text => None,
        }
    }

    /// Returns the minimum and maximum value, or `None` for strings.
    pub fn limits(self) -> Option<(i64, i64)> {
        let limits = match self {
            Kind::U8 => (0, u8::MAX.into()),
            Kind::I8 => (i8::MIN.into(), i8::MAX.into()),
            Kind::U16 => (0, u16::MAX.into()),
            Kind::I16 => (i16::MIN.into(), i16::MAX.into()),
            Kind::U32 => (0, u32::MAX.into()),
            Kind::I32 => (i32::MIN.into(), i32::MAX.into()),
            Kind::Text => return None,
        };
        Some(limits)
    }

    /// Parses a value. The first byte of a string may be its length (`U`: not documented). Trailing zeros and blanks
    /// are removed, and non-ASCII bytes become question marks.
    ///
    /// # Errors
    /// Returns [`ValueError::Length`] if the data of a number have the wrong length.
    pub fn parse(self, data: &[u8]) -> Result<Value, ValueError> {
        let wrong = |expected| ValueError::Length { expected, got: data.len() };
        let number = match self {
            Kind::U8 => <[u8; 1]>::try_from(data).map(|[byte]| i64::from(byte)).map_err(|_| wrong(1)),
            Kind::I8 => <[u8; 1]>::try_from(data).map(|[byte]| i64::from(byte.cast_signed())).map_err(|_| wrong(1)),
            Kind::U16 => data.try_into().map(|bytes| u16::from_le_bytes(bytes).into()).map_err(|_| wrong(2)),
            Kind::I16 => data.try_into().map(|bytes| i16::from_le_bytes(bytes).into()).map_err(|_| wrong(2)),
            Kind::U32 => data.try_into().map(|bytes| u32::from_le_bytes(bytes).into()).map_err(|_| wrong(4)),
            Kind::I32 => data.try_into().map(|bytes| i32::from_le_bytes(bytes).into()).map_err(|_| wrong(4)),
            Kind::Text => return Ok(Value::Text(text(data))),
        };
        number.map(Value::Number)
    }

    /// Encodes a value.
    ///
    /// # Errors
    /// Returns [`ValueError`] if the value is not of this type.
    pub fn emit(self, value: &Value) -> Result<Vec<u8>, ValueError> {
        let (number, length, (low, high)) = match (value, self.byte_length(), self.limits()) {
            (Value::Number(number), Some(length), Some(limits)) => (*number, length, limits),
            (Value::Text(text), None, _) => {
                return Ok(text.chars().map(|c| if c.is_ascii() { c as u8 } else { b'?' }).collect());
            }
            (Value::Number(_), ..) => return Err(ValueError::NumberForText),
            (Value::Text(_), ..) => return Err(ValueError::TextForNumber),
        };
        if !(low..=high).contains(&number) {
            return Err(ValueError::Number { number, low, high });
        }
        Ok(number.to_le_bytes().into_iter().take(length).collect())
    }
}

/// Parses a nominal value (parameters 126 to 129) and returns it with its number of decimals. A value with the prefix
/// `A` is in tenths and has one decimal (manual 6.2).
pub fn nominal_value(text: &str) -> Option<(f64, usize)> {
    let (digits, by, decimals) = text.strip_prefix('A').map_or((text, 1.0, 0), |tenths| (tenths, 10.0, 1));
    digits.parse::<u32>().ok().map(|number| (f64::from(number) / by, decimals))
}

fn text(data: &[u8]) -> String {
    let characters = match data {
        [length, characters @ ..] if usize::from(*length) == characters.len() && *length < b' ' => characters,
        _ => data,
    };
    let text: String = characters.iter().map(|byte| if byte.is_ascii() { char::from(*byte) } else { '?' }).collect();
    text.trim_end_matches(['\0', ' ']).to_owned()
}
