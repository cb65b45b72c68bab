//! Values in the memory that are valid only while an encoder stays mounted on its motor.

use super::encoder::Encoder;
use crate::app::session::Source;
use crate::devices::hiperface::procedures::create_profile;
use crate::devices::hiperface::profile::{HiperfaceProfile, RecordedValues};

impl Encoder {
    /// Returns the byte ranges of a field whose values depend on the mounting, each with its meaning.
    pub fn mounting_ranges(&self, field: u8) -> Vec<(std::ops::Range<usize>, String)> {
        let own = |profile: &HiperfaceProfile| {
            let marks = profile.mounting.iter().filter(|mark| mark.item.field == field);
            marks
                .map(|mark| {
                    let start = mark.item.start;
                    (start..start.saturating_add(mark.item.count.unwrap_or(0)), mark.meaning.clone())
                })
                .collect()
        };
        match &self.session.source {
            Source::File { document, .. } => document.body.get::<HiperfaceProfile>().map(own).unwrap_or_default(),
            Source::Link(_) | Source::New { .. } => {
                let Some(identity) = &self.identity else { return Vec::new() };
                own(&create_profile(identity, self.staged.device().to_vec(), RecordedValues::default()))
            }
        }
    }
}
