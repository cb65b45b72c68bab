//! Text catalogue of the adapter.

use crate::app::Catalogue;

/// Text catalogue of the adapter. Names that it does not define are looked up in the common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/bridge.ron"));
