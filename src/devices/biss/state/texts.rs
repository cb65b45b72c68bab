//! The texts of BiSS.

use crate::app::Catalogue;

/// Texts of BiSS; other names are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/biss.ron"));
