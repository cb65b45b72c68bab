//! A BiSS encoder on its line.

mod adapter;
mod cuts;
mod faults;
mod flood;
pub(crate) mod hands;
mod jobs;
mod master;
mod procedures;
mod streams;
mod supply;
pub(crate) mod support;
mod unknown;
mod writing;
