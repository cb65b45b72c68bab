//! Tests of the complete history: worked examples, comparisons with a full scan, and recordings over days.

mod by_hand;
mod days;
mod model;
mod properties;
