//! The texts of INTERBUS.

use crate::app::Catalogue;

/// The texts that INTERBUS alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/interbus.ron"));
