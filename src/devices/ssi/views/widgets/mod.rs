//! Widgets of the SSI tab: the bits of a frame, and the timing of a burst.

mod bit_strip;
mod timing_diagram;

pub(crate) use bit_strip::{BitStrip, StripEvent, bit_strip};
pub(crate) use timing_diagram::{TimingDiagram, timing_diagram};

#[cfg(test)]
mod tests;
