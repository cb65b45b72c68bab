//! Text catalogue of SSI.

use crate::app::Catalogue;

/// Texts of SSI; other names are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/ssi.ron"));
