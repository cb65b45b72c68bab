//! Message catalogue of the adapter.

use crate::app::Catalogue;

/// Message catalogue of the adapter. All other message IDs are in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/bridge.ron"));
