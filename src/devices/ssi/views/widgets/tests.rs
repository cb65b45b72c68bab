//! The widgets driven as a user would: by their accessible labels, with keys and pointer.

mod bit_strip;
mod timing_diagram;
