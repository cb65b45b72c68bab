//! An SSI encoder behind an adapter.

mod jobs;
mod streams;
mod support;
