//! Text catalogue of the Signals tab.

use crate::app::Catalogue;

/// Texts of the Signals tab; other names are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../assets/texts/signals.ron"));
