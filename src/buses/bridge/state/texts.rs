//! Text catalogue of the adapter.

use crate::app::Catalogue;

/// Text catalogue of the adapter; other names are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/bridge.ron"));
