//! Message catalogue of SSI.

use crate::app::Catalogue;

/// Message catalogue of SSI. Identifiers that it does not contain are looked up in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/ssi.ron"));
