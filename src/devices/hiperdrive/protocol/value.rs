//! Values of parameters as CIP carries them: numbers of their type's length, texts (reference 7).

/// What a parameter's value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// 8 bits without a sign.
    U8,
    /// 8 bits with a sign.
    I8,
    /// 16 bits without a sign.
    U16,
    /// 16 bits with a sign.
    I16,
    /// 32 bits without a sign.
    U32,
    /// 32 bits with a sign.
    I32,
    /// ASCII.
    Text,
}

/// A value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// Of any kind but text.
    Number(i64),
    /// Of that.
    Text(String),
}

/// Why data and values do not fit together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ValueError {
    /// Another length than the kind has.
    #[error("a value of {got} bytes where {expected} were expected")]
    Length {
        /// The kind's.
        expected: usize,
        /// How many there were.
        got: usize,
    },
    /// A number that the kind cannot hold.
    #[error("{number} is not within {low} to {high}")]
    Number {
        /// As given.
        number: i64,
        /// The least.
        low: i64,
        /// The greatest.
        high: i64,
    },
    /// A number for a parameter that is a text.
    #[error("a text is expected, not a number")]
    NumberForText,
    /// A text for a parameter that is a number.
    #[error("a number is expected, not a text")]
    TextForNumber,
}

impl Kind {
    /// Bytes of a number; `None` for texts.
    pub const fn length(self) -> Option<usize> {
        match self {
            Kind::U8 | Kind::I8 => Some(1),
            Kind::U16 | Kind::I16 => Some(2),
            Kind::U32 | Kind::I32 => Some(4),
            Kind::Text => None,
        }
    }

    /// The least and the greatest number; `None` for texts.
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

    /// Reads a value. A text may come as characters alone or with its length before them (`U`); zeros and blanks at its end
    /// fall away, and what is no ASCII is a question mark.
    ///
    /// # Errors
    /// [`ValueError::Length`] of a number.
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

    /// The data of a value.
    ///
    /// # Errors
    /// [`ValueError`] where it is not of this kind.
    pub fn emit(self, value: &Value) -> Result<Vec<u8>, ValueError> {
        let (number, length, (low, high)) = match (value, self.length(), self.limits()) {
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

/// What a nominal datum says (parameters 126 to 129): a number, of tenths where an `A` stands before it (manual 6.2).
pub fn nominal(text: &str) -> Option<f64> {
    let (digits, by) = text.strip_prefix('A').map_or((text, 1.0), |tenths| (tenths, 10.0));
    digits.parse::<u32>().ok().map(|number| f64::from(number) / by)
}

fn text(data: &[u8]) -> String {
    let characters = match data {
        [length, characters @ ..] if usize::from(*length) == characters.len() && *length < b' ' => characters,
        _ => data,
    };
    let text: String = characters.iter().map(|byte| if byte.is_ascii() { char::from(*byte) } else { '?' }).collect();
    text.trim_end_matches(['\0', ' ']).to_owned()
}
