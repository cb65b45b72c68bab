//! A kind of device that the program does not have, an encoder called Novo, registered from outside: one folder and one
//! line. What it uses, others use as well.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

#[cfg(unix)]
mod cli;
mod desk;
mod novo;
mod studio;
