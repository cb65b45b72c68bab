//! The texts of HIPERFACE.

use crate::app::Catalogue;

/// The texts that HIPERFACE alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperface.ron"));
