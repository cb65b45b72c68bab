//! Tests that operate the widgets like a user, through accessible labels, keys and pointer.

mod cams;
mod word_layout;
