//! The texts of the adapter.

use crate::app::Catalogue;

/// The texts that the adapter alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/bridge.ron"));
