//! Text catalogue of the Signals tab.

use crate::app::Catalogue;

/// Messages of the Signals tab. Identifiers that it does not contain are looked up in the common catalogue.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../assets/texts/signals.ron"));
