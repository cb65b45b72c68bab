//! Format string of LinuxCNC's hostmot2 driver (`ssi_chan_0=…`): fields from the last clock to the first, each
//! consisting of a name, `%`, the number of bits, and the type: `p` padding, `b` bit, `u` number, `e` position; a
//! preceding `g` denotes Gray.

use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::{Descriptor, ErrorBit, GrayCoverage, Meaning};
use crate::devices::ssi::protocol::explain::Role;
use crate::devices::ssi::protocol::layout::{Layout, LayoutError};
use crate::devices::ssi::protocol::range::Range;

/// A property of a frame that LinuxCNC cannot decode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnsupportedProperty {
    /// Gray code over more than the position.
    #[error("a Gray code that includes zeros or error bits")]
    GrayOver,
    /// Gray excess code.
    #[error("gray excess")]
    GrayExcess,
    /// BCD code.
    #[error("BCD")]
    Bcd,
    /// Zeros between the multiturn and the singleturn part.
    #[error("zeros between turns and steps")]
    Between,
    /// Swapped data wires.
    #[error("exchanged data wires")]
    Inverted,
}

/// The reason why a frame has no format string, or a format string does not describe a frame.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// LinuxCNC cannot decode the frame.
    #[error("LinuxCNC cannot decode {0}")]
    Cannot(UnsupportedProperty),
    /// A field is not of the form `name%bits` followed by a letter.
    #[error("\"{0}\" is not NAME%BITS and one of p b u s f e, with g before for Gray")]
    Form(String),
    /// A field type is not supported for SSI frames.
    #[error("\"{0}\" is a field of other encoders: only p b u s f e are supported, with g before for Gray")]
    Kind(char),
    /// There is more than one position field.
    #[error("there are two positions, \"{0}\" and \"{1}\"")]
    Two(String, String),
    /// There is no position field.
    #[error("the position is missing: a field of type e or u, with g before for Gray")]
    None,
    /// The fields exceed the length of a frame.
    #[error("the fields have more than 64 bits together")]
    Long,
    /// The frame is impossible.
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

/// Returns the format string of a frame.
///
/// # Errors
/// [`FormatError::Cannot`]: BCD, Gray excess, Gray over more than the position, zeros between multiturn and singleturn,
/// or swapped wires.
pub fn to_linuxcnc(layout: &Layout) -> Result<String, FormatError> {
    let descriptor = layout.descriptor();
    let modifier = match layout.coding().code() {
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
    let mut fields: Vec<(Field, u8)> = Vec::new();
    for role in layout.clock_roles().into_iter().rev() {
        let field = match role {
            Role::Zero | Role::Again(_) => Field::Padding,
            Role::Multiturn(_) | Role::Singleturn(_) | Role::Position(_) => Field::Position,
            Role::Error(index) => Field::Bit(descriptor.errors.get(index).map_or("error", |bit| &bit.name).to_owned()),
            Role::Parity => Field::Bit("parity".to_owned()),
        };
        match fields.last_mut() {
            Some((last, bits)) if *last == field && !matches!(field, Field::Bit(_)) => *bits += 1,
            _ => fields.push((field, 1)),
        }
    }
    let mut taken = vec!["position".to_owned()];
    let words = fields.into_iter().map(|(field, bits)| match field {
        Field::Padding => format!("%{bits}p"),
        Field::Position => format!("position%{bits}{modifier}e"),
        Field::Bit(name) => format!("{}%1b", pin_name(&name, &mut taken)),
    });
    Ok(words.collect())
}

/// Returns a valid pin name that is not taken yet.
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
enum Field {
    Padding,
    Position,
    Bit(String),
}

/// Parses a format string as a frame with a single undivided position. Bit fields become error bits that invalidate the
/// position, which the user can change.
///
/// # Errors
/// [`FormatError`] with the invalid field.
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
    // The last field is on the first clocks.
    fields.reverse();
    let mut position: Option<(Given, u8)> = None;
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
                meaning: Meaning::Invalid,
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
    let descriptor = Descriptor {
        clocks,
        range,
        code: if field.gray { Code::Gray } else { Code::Binary },
        area: begins - 1 + field.bits,
        lead: begins - 1,
        errors,
        ..Descriptor::plain(0, 0)
    };
    Ok(Layout::new(descriptor)?)
}

#[derive(Clone, Debug)]
struct Given {
    name: String,
    bits: u8,
    kind: char,
    gray: bool,
}

fn field(text: &str) -> Result<(Given, &str), FormatError> {
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
                return Ok((Given { name: name.trim().to_owned(), bits, kind, gray }, letters.as_str()));
            }
            'h' | 'l' | 'm' => return Err(FormatError::Kind(kind)),
            _ => return Err(wrong()),
        }
    }
}
