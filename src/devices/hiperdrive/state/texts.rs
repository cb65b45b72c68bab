//! The texts of HIPERDRIVE.

use crate::app::Catalogue;

/// Text catalogue of HIPERDRIVE. IDs not found here are looked up in the common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperdrive.ron"));
