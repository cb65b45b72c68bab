//! Tests that use the widgets as a user does, through accessible labels, keys and the pointer.

mod cams;
mod word_layout;
