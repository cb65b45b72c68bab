//! Message catalogue of SSI.

use crate::app::Catalogue;

/// Message catalogue of SSI. The common catalogue provides all other IDs.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/ssi.ron"));
