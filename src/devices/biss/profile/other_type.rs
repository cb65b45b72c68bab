//! Comparison of an encoder's type with the type in a profile. The type consists of the profile ID, the manufacturer,
//! the device ID and the position widths. The widths matter because a preset value is a number of steps, which is a
//! different angle at another width.

use std::fmt;

use super::ProfileIdentity;
use crate::devices::biss::protocol::Identity;

/// The reason why a profile is for another type of encoder.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TypeMismatch {
    /// The reported identities differ.
    #[error("the profile is for {profile}, but the encoder reports {device}")]
    Kind {
        /// Identity in the profile.
        profile: Box<Identity>,
        /// Identity of the encoder.
        device: Box<Identity>,
    },
    /// The position widths differ.
    #[error("the profile is for an encoder with {profile} bits, but the encoder has {device}")]
    Width {
        /// Widths in the profile.
        profile: Width,
        /// Widths of the encoder.
        device: Width,
    },
}

/// Multiturn and singleturn widths of a position in bits, if known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Width {
    /// Multiturn width in bits, if known.
    pub multiturn: Option<u8>,
    /// Singleturn width in bits, if known.
    pub singleturn: Option<u8>,
}

impl Width {
    fn from_identity(identity: &ProfileIdentity) -> Self {
        Width { multiturn: identity.multiturn_bits, singleturn: identity.singleturn_bits }
    }

    /// Returns whether both widths are known and differ.
    fn differs_from(self, other: Self) -> bool {
        let parts = [(self.multiturn, other.multiturn), (self.singleturn, other.singleturn)];
        parts.into_iter().any(|(one, other)| one.zip(other).is_some_and(|(one, other)| one != other))
    }
}

impl fmt::Display for Width {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [multiturn, singleturn] =
            [self.multiturn, self.singleturn].map(|bits| bits.map_or_else(|| "?".to_owned(), |bits| bits.to_string()));
        write!(f, "{multiturn} + {singleturn}")
    }
}

/// Returns how the types of a profile and an encoder differ, or `None` if they match. An unknown width matches any
/// width.
pub fn other_type(profile: &ProfileIdentity, device: &ProfileIdentity) -> Option<TypeMismatch> {
    let (of_profile, of_device) = (profile.kind(), device.kind());
    if of_profile != of_device {
        return Some(TypeMismatch::Kind { profile: Box::new(of_profile), device: Box::new(of_device) });
    }
    let (profile, device) = (Width::from_identity(profile), Width::from_identity(device));
    profile.differs_from(device).then_some(TypeMismatch::Width { profile, device })
}
