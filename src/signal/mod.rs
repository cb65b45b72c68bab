//! What sine and cosine samples mean: the angle inside a period, the ellipse they draw and how to make it a circle, their
//! quality, and how they go together with the absolute position. Pure numbers: no file, no clock, no thread, no drawing.
//!
//! Follows SICK 8010701 (HIPERFACE, process data channel) and Heydemann, Applied Optics 20, 3382 (1981).

pub mod analysis;
pub mod arctan;
pub mod capture;
pub mod commutation;
pub mod coverage;
pub mod ellipse;
pub mod input_circuit;
pub mod moments;
pub mod nonlinearity;
pub mod position_error;
pub mod quality;
pub mod spectrum;
pub mod synchronise;
