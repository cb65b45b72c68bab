//! Tests that operate the widgets like a user, through accessible labels, the keyboard and the pointer.

mod bit_strip;
mod timing_diagram;
