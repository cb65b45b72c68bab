//! A kind of device that is not part of the program: an encoder called Novo, which is registered from outside with one
//! folder and one line. It uses only the interface available to all kinds.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

#[cfg(unix)]
mod cli;
mod desk;
mod novo;
mod studio;
