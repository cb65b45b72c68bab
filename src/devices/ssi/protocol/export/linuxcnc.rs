//! Format string of LinuxCNC's hostmot2 driver (`ssi_chan_0=…`).
//!
//! The string lists the fields from the last clock to the first. A field consists of a name, `%`, the number of bits,
//! and the type: `p` for padding, `b` for a bit, `u` for a number, and `e` for a position. A `g` before the type means
//! Gray code.

use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::{BitMeaning, ErrorBit, FrameDescriptor, GrayCoverage};
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::{Layout, LayoutError};
use crate::devices::ssi::protocol::range::Range;

/// A property of a frame that LinuxCNC cannot decode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnsupportedProperty {
    /// Gray code that covers more than the position.
    #[error("Gray code that also covers zeros or error bits")]
    GrayOver,
    /// Gray excess code.
    #[error("gray excess")]
    GrayExcess,
    /// BCD code.
    #[error("BCD")]
    Bcd,
    /// Zeros between multiturn and singleturn.
    #[error("zeros between turns and steps")]
    Between,
    /// Swapped data wires, which invert all bits.
    #[error("swapped data wires")]
    Inverted,
}

/// The reason why a frame cannot be converted to a LinuxCNC format string, or a format string to a frame.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// LinuxCNC cannot decode a frame with this property.
    #[error("LinuxCNC cannot decode {0}")]
    Cannot(UnsupportedProperty),
    /// A field is not of the form `name%bits` followed by a letter.
    #[error("\"{0}\" must be NAME%BITS followed by a type (p, b, u, s, f or e; for Gray code, put g before the type)")]
    Form(String),
    /// A field type is not supported for SSI frames.
    #[error("the field type \"{0}\" is not supported; use p, b, u, s, f or e (for Gray code, put g before the type)")]
    Kind(char),
    /// There is more than one position field.
    #[error("the format string contains two positions, \"{0}\" and \"{1}\"")]
    Two(String, String),
    /// There is no position field.
    #[error(
        "the format string contains no position; add a field of type e or u (for Gray code, put g before the type)"
    )]
    None,
    /// The fields exceed the length of a frame.
    #[error("the fields together have more than 64 bits")]
    Long,
    /// The frame is invalid.
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

/// Returns the format string of a frame.
///
/// # Errors
/// Returns [`FormatError::Cannot`] if LinuxCNC cannot decode the frame.
pub fn to_linuxcnc(layout: &Layout) -> Result<String, FormatError> {
    let descriptor = layout.descriptor();
    let modifier = match layout.position_code().code() {
        Code::Binary if descriptor.coded == GrayCoverage::Position => "",
        Code::Gray => "g",
        Code::Binary => return Err(FormatError::Cannot(UnsupportedProperty::GrayOver)),
        Code::GrayExcess => return Err(FormatError::Cannot(UnsupportedProperty::GrayExcess)),
        Code::Bcd => return Err(FormatError::Cannot(UnsupportedProperty::Bcd)),
    };
    if descriptor.between > 0 {
        return Err(FormatError::Cannot(UnsupportedProperty::Between));
    }
    if descriptor.inverted {
        return Err(FormatError::Cannot(UnsupportedProperty::Inverted));
    }
    let mut fields: Vec<(BitField, u8)> = Vec::new();
    for role in layout.clock_roles().into_iter().rev() {
        let field = match role {
            Role::Zero | Role::Repetition(_) => BitField::Padding,
            Role::Multiturn(_) | Role::Singleturn(_) | Role::Position(_) => BitField::Position,
            Role::Error(index) => {
                BitField::Bit(descriptor.errors.get(index).map_or("error", |bit| &bit.name).to_owned())
            }
            Role::Parity => BitField::Bit("parity".to_owned()),
        };
        match fields.last_mut() {
            Some((last, bits)) if *last == field && !matches!(field, BitField::Bit(_)) => *bits += 1,
            _ => fields.push((field, 1)),
        }
    }
    let mut taken = vec!["position".to_owned()];
    let words = fields.into_iter().map(|(field, bits)| match field {
        BitField::Padding => format!("%{bits}p"),
        BitField::Position => format!("position%{bits}{modifier}e"),
        BitField::Bit(name) => format!("{}%1b", pin_name(&name, &mut taken)),
    });
    Ok(words.collect())
}

/// Converts a name to a pin name that is not yet in `taken`, and adds the pin name to `taken`.
fn pin_name(name: &str, taken: &mut Vec<String>) -> String {
    let is_known = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_' | '.');
    let letters = name.chars().map(|letter| if is_known(letter) { letter.to_ascii_lowercase() } else { '-' });
    let own: String = letters.collect();
    let own = if own.is_empty() { "bit".to_owned() } else { own };
    let further = (2..).map(|number| format!("{own}-{number}"));
    let free = std::iter::once(own.clone()).chain(further).find(|name| !taken.contains(name)).unwrap_or(own);
    taken.push(free.clone());
    free
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum BitField {
    Padding,
    Position,
    Bit(String),
}

/// Parses a format string as a frame whose position is a single number. Bit fields become error bits that make the
/// position invalid, which the user can change later.
///
/// # Errors
/// Returns a [`FormatError`] with the invalid field if the format string is not a frame.
pub fn from_linuxcnc(text: &str) -> Result<Layout, FormatError> {
    let text = text.trim().trim_matches('"');
    let text = text.split_once('=').filter(|(key, _)| key.starts_with("ssi_chan_")).map_or(text, |(_, format)| format);
    let mut fields = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let (field, behind) = field(rest)?;
        fields.push(field);
        rest = behind;
    }
    let clocks = fields.iter().try_fold(0_u8, |sum, field| sum.checked_add(field.bits)).filter(|sum| *sum <= 64);
    let clocks = clocks.ok_or(FormatError::Long)?;
    // The last field is sent first.
    fields.reverse();
    let mut position: Option<(OutputPin, u8)> = None;
    let mut errors = Vec::new();
    let mut clock = 1;
    for field in fields {
        let begins = clock;
        clock += field.bits;
        match field.kind {
            'b' | 'f' => errors.extend((0..field.bits).map(|bit| ErrorBit {
                name: if field.bits == 1 {
                    field.name.clone()
                } else {
                    format!("{}-{}", field.name, field.bits - 1 - bit)
                },
                clock: begins + bit,
                meaning: BitMeaning::Invalid,
                active_low: false,
                cleared_by_transfer: false,
            })),
            'p' => {}
            _ => {
                if let Some((first, _)) = position.replace((field.clone(), begins)) {
                    return Err(FormatError::Two(first.name, field.name));
                }
            }
        }
    }
    let (field, begins) = position.ok_or(FormatError::None)?;
    let range = match field.bits {
        bits @ 0..=32 => Range::Bits { multiturn: 0, singleturn: bits },
        bits => Range::Bits { multiturn: bits - 32, singleturn: 32 },
    };
    let descriptor = FrameDescriptor {
        clocks,
        range,
        code: if field.gray { Code::Gray } else { Code::Binary },
        area: begins - 1 + field.bits,
        lead: begins - 1,
        errors,
        ..FrameDescriptor::binary(0, 0)
    };
    Ok(Layout::new(descriptor)?)
}

#[derive(Clone, Debug)]
struct OutputPin {
    name: String,
    bits: u8,
    kind: char,
    gray: bool,
}

fn field(text: &str) -> Result<(OutputPin, &str), FormatError> {
    let wrong = || FormatError::Form(text.to_owned());
    let (name, behind) = text.split_once('%').ok_or_else(wrong)?;
    let digits = behind.find(|c: char| !c.is_ascii_digit()).ok_or_else(wrong)?;
    let (bits, behind) = behind.split_at_checked(digits).ok_or_else(wrong)?;
    let bits = bits.parse().ok().filter(|bits| *bits > 0).ok_or_else(wrong)?;
    let mut letters = behind.chars();
    let mut gray = false;
    loop {
        let kind = letters.next().ok_or_else(wrong)?.to_ascii_lowercase();
        match kind {
            'g' => gray = true,
            'p' | 'b' | 'u' | 's' | 'f' | 'e' => {
                return Ok((OutputPin { name: name.trim().to_owned(), bits, kind, gray }, letters.as_str()));
            }
            'h' | 'l' | 'm' => return Err(FormatError::Kind(kind)),
            _ => return Err(wrong()),
        }
    }
}
