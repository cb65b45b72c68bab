//! The texts of the Signals tab.

use crate::app::Catalogue;

/// The texts that the Signals tab alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../assets/texts/signals.ron"));
