//! The text catalogue for HIPERFACE.

use crate::app::Catalogue;

/// The catalogue of HIPERFACE messages. The common catalogue provides all other IDs.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperface.ron"));
