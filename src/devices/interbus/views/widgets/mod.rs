//! Widgets of the INTERBUS tab: cam programs, and the bits of a cam output word.

mod cam_chart;
mod cam_lanes;
mod cam_ring;
mod word_layout;

pub(crate) use cam_chart::{CamChart, CamEvent};
pub(crate) use cam_lanes::cam_lanes;
pub(crate) use cam_ring::cam_ring;
pub(crate) use word_layout::{WordLayout, word_layout};

#[cfg(test)]
mod tests;
