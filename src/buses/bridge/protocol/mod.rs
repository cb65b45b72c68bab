//! The bridge protocol. Its packets, version and limits are in the crate `bridge-codec` (`adapter/codec`), which the
//! firmware of the adapter uses as well.

pub use bridge_codec::*;
