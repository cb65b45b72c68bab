//! Text catalogue of INTERBUS.

use crate::app::Catalogue;

/// Message catalogue for INTERBUS; all other IDs come from the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/interbus.ron"));
