//! The texts of HIPERDRIVE.

use crate::app::Catalogue;

/// The texts that HIPERDRIVE alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperdrive.ron"));
