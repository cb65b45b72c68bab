//! The widgets driven as a user would: by their accessible labels, with keys and pointer.

mod cams;
mod word_layout;
