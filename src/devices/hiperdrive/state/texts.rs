//! The messages of HIPERDRIVE.

use crate::app::Catalogue;

/// Message catalogue of HIPERDRIVE. IDs that are not in it are looked up in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperdrive.ron"));
