//! An SSI encoder at an adapter.

mod jobs;
mod streams;
mod support;
