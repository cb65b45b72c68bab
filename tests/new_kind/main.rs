//! Tests that a kind of device can be added from outside the program. An invented encoder called Novo is registered by
//! one folder and one line, and uses only the interface available to every kind.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

#[cfg(unix)]
mod cli;
mod desk;
mod novo;
mod studio;
