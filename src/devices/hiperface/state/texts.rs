//! Text catalogue of HIPERFACE.

use crate::app::Catalogue;

/// Messages of HIPERFACE encoders. Names that it does not define refer to common messages.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../../assets/texts/hiperface.ron"));
