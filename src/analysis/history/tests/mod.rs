//! The history as a whole: by hand, against a full scan of the same samples, and over days.

mod by_hand;
mod days;
mod model;
mod properties;
