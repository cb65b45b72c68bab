//! Text catalogue of the Signals tab.

use crate::app::Catalogue;

/// Messages of the Signals tab. Ids that are missing here are looked up in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../assets/texts/signals.ron"));
