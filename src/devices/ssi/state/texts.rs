//! The texts of SSI.

use crate::app::Catalogue;

/// The texts that SSI alone has; names that are not here are those of common texts.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/ssi.ron"));
