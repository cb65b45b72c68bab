//! BiSS: what is saved of an encoder, how two differ, and what restoring would do.

mod item;
mod record;
mod text;

pub use item::{ItemError, RegisterRange};
pub use record::{
    Bank, BissProfile, DataImage, ListedBank, MountingItem, MountingMark, PresetSetting, ProfileIdentity, Recorded,
};
