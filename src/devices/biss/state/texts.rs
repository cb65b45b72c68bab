//! The message catalogue for BiSS.

use crate::app::Catalogue;

/// The catalogue of BiSS messages and labels. Other ids refer to the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/biss.ron"));
