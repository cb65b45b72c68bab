//! A BiSS encoder in virtual time, at its configuration pin or at an adapter.

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
