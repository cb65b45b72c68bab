//! The virtual encoder's position and the frames that it sends.

use super::injected_fault::InjectedFault;
use crate::buses::bridge::sim::SsiDevice;
use crate::devices::ssi::protocol::{Direction, Families, Flags, Layout, Settings};
use crate::units::Moment;

#[derive(Clone, Debug, PartialEq)]
pub struct Encoder {
    pub layout: Layout,
    pub direction: Direction,
    /// Position at the zero point of the shaft, within the range of the frame.
    pub preset: u64,
}

impl Encoder {
    /// Parses an encoder from a family with settings, such as `atm60,code=gray`. Returns `None` if the family is
    /// unknown.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let (key, settings) = Settings::parse(text).ok()?;
        let families = Families::built_in();
        let resolved = settings.resolve(families.find_by_key(&key)?).ok()?;
        Some(Encoder { layout: resolved.layout, direction: resolved.direction, preset: resolved.preset })
    }
}

#[derive(Clone)]
pub(super) struct FrameSender {
    pub(super) encoder: Encoder,
    pub(super) troubles: Vec<InjectedFault>,
    pub(super) transferred: Option<Moment>,
}

impl FrameSender {
    fn frame_at(&self, (raw, per_turn): (u64, u64), at: Moment) -> u64 {
        let Encoder { layout, direction, preset } = &self.encoder;
        let happening = || self.troubles.iter().filter(|trouble| trouble.occurs(at, self.transferred));
        if let Some(word) = happening().find_map(InjectedFault::sent_word) {
            return word;
        }
        let flags = happening().fold(Flags::NONE, |flags, trouble| flags.union(trouble.set_flag()));
        let position = layout.descriptor().range.position_with_preset(raw, per_turn, *direction, *preset);
        layout.encode(position, flags).unwrap_or(0)
    }
}

impl SsiDevice for FrameSender {
    fn clone_device(&self) -> Box<dyn SsiDevice> {
        Box::new(self.clone())
    }

    fn word_at(&mut self, at: Moment, place: (u64, u64)) -> (u64, u8) {
        let frame = self.frame_at(place, at);
        self.transferred = Some(at);
        (frame, self.encoder.layout.clock_count())
    }
}
