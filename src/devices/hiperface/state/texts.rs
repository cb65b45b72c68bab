//! Text catalogue of HIPERFACE.

use crate::app::Catalogue;

/// Message catalogue of HIPERFACE; names not found here are those of common messages.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperface.ron"));
