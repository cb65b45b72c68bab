//! Text catalogue of INTERBUS.

use crate::app::Catalogue;

/// Texts of INTERBUS; other names are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/interbus.ron"));
