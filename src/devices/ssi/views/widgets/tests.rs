//! Tests that operate the widgets like a user, through accessible labels, keys and pointer.

mod bit_strip;
mod timing_diagram;
