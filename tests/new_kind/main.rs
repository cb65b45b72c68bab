//! A kind of device that is not part of the program, an encoder called Novo, registered from outside with one folder
//! and one line. It uses only the interface that other kinds use.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

#[cfg(unix)]
mod cli;
mod desk;
mod novo;
mod studio;
