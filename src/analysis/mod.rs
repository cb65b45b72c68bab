//! Analysis of samples: times, unwrapped positions, speed and acceleration, long histories, and pictures of any range.
//! For sine and cosine, it covers the angle within a period, the ellipse and its correction, the quality, and the
//! synchronisation with the absolute position. The verdicts of a device check are also defined here. All functions are
//! pure: samples and their times are arguments, and nothing waits, reads a clock or a file, or draws.
//!
//! Follows SICK 8010701 (HIPERFACE, process data channel) and Heydemann, Applied Optics 20, 3382 (1981).

pub mod arctan;
pub mod capture;
pub mod check;
pub mod commutation;
pub mod continuity;
pub mod coverage;
pub mod diagnosis;
pub mod ellipse;
pub mod history;
pub mod input_circuit;
pub mod lissajous;
pub mod moments;
mod motion;
pub mod nonlinearity;
pub mod outliers;
pub mod position_error;
pub mod quality;
pub mod revolution;
pub mod signal_analysis;
pub mod spectrum;
pub mod synchronise;
mod time;
mod unwrap;
pub mod wiring;

pub use motion::{Motion, MotionRates};
pub use time::SampleTime;
pub use unwrap::{PositionUnwrapper, UnwrappedPosition};
