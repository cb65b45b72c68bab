//! The cyclic connection as its originator sees it: what is sent when, what comes, what is counted, and when it is lost.
//! Pure: packets and moments are handed in.

mod figures;

pub use figures::{Bucket, CyclicLost, Histogram, LinkFigures};
