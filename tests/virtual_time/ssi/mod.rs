//! Tests of an SSI encoder on an adapter.

mod jobs;
mod streams;
mod support;
