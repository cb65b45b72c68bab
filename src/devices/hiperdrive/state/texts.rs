//! The texts of HIPERDRIVE.

use crate::app::Catalogue;

/// Text catalogue of HIPERDRIVE. Names not found here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperdrive.ron"));
