//! Catalogue of HIPERFACE messages in English and German.

use crate::app::Catalogue;

/// The messages specific to HIPERFACE. All other message IDs are in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperface.ron"));
