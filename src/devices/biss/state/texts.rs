//! The message catalogue for BiSS.

use crate::app::Catalogue;

/// The catalogue of BiSS messages and labels. The common catalogue provides all other IDs.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/biss.ron"));
