//! Message catalogue of the adapter.

use crate::app::Catalogue;

/// Message catalogue of the adapter. The common catalogue provides all other IDs.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/bridge.ron"));
