//! The message catalogue for BiSS.

use crate::app::Catalogue;

/// The catalogue of BiSS messages and labels. IDs that are not listed here are in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/biss.ron"));
