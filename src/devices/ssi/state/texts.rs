//! Text catalogue of SSI.

use crate::app::Catalogue;

/// SSI message catalogue. Identifiers not found in it are looked up in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/ssi.ron"));
