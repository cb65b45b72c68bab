//! A kind of device that is not part of the program: an encoder called Novo. One folder and one line register it from
//! outside, and it uses only the interface that other kinds use.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

#[cfg(unix)]
mod cli;
mod desk;
mod novo;
mod studio;
