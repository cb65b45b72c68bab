//! INTERBUS: what a K3 encoder holds, what is saved of it, how two differ, and what a write would do.

mod image;
mod plan;

pub use image::{Direction, DirectionError, Image, Parameters};
pub use plan::{Base, CamChange, Edge, InterbusPlan, Op, ParameterChange, ProgramChange};
