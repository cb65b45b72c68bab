//! Text catalogue of HIPERFACE.

use crate::app::Catalogue;

/// Text catalogue of HIPERFACE; other names are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperface.ron"));
