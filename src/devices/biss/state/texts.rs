//! The texts of BiSS.

use crate::app::Catalogue;

/// The texts that BiSS alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/biss.ron"));
