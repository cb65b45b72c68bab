//! Message catalogue for INTERBUS.

use crate::app::Catalogue;

/// Message catalogue for INTERBUS. The common catalogue provides all other IDs.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/interbus.ron"));
