//! Text catalogue of the Signals tab.

use crate::app::Catalogue;

/// Messages of the Signals tab. Names that it does not define refer to common messages.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../assets/texts/signals.ron"));
