//! Text catalogue of the Signals tab.

use crate::app::Catalogue;

/// Messages of the Signals tab; any other name refers to a common message.
pub static TEXTS: Catalogue = Catalogue::new(include_str!("../../../assets/texts/signals.ron"));
