//! Checks whether an encoder is of the type that a profile was read from. A type is the reported identity (profile ID,
//! manufacturer, device ID) and the widths of the position: a preset is a number of steps, which means another angle if
//! widths differ.

use std::fmt;

use super::ProfileIdentity;
use crate::devices::biss::protocol::Identity;

/// A profile and an encoder of two types.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OtherType {
    /// Their identities differ.
    #[error("the profile is of {profile}, the encoder says {device}")]
    Kind {
        /// In the profile.
        profile: Box<Identity>,
        /// In the encoder.
        device: Box<Identity>,
    },
    /// Their positions are not equally wide.
    #[error("the profile is of an encoder with {profile} bits, the encoder has {device}")]
    Width {
        /// In the profile.
        profile: Width,
        /// In the encoder.
        device: Width,
    },
}

/// Bits of a position, as far as known: turns, and within the turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Width {
    /// Bits of the turns.
    pub multiturn: Option<u8>,
    /// Within the revolution.
    pub singleturn: Option<u8>,
}

impl Width {
    fn of(identity: &ProfileIdentity) -> Self {
        Width { multiturn: identity.multiturn_bits, singleturn: identity.singleturn_bits }
    }

    /// Returns whether a part is known on both sides and differs.
    fn differs(self, other: Self) -> bool {
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

/// Returns the types of a profile and of an encoder if they differ; `None` if they are equal. Unknown parts equal
/// everything.
pub fn other_type(profile: &ProfileIdentity, device: &ProfileIdentity) -> Option<OtherType> {
    let (of_profile, of_device) = (profile.kind(), device.kind());
    if of_profile != of_device {
        return Some(OtherType::Kind { profile: Box::new(of_profile), device: Box::new(of_device) });
    }
    let (profile, device) = (Width::of(profile), Width::of(device));
    profile.differs(device).then_some(OtherType::Width { profile, device })
}
