//! A BiSS encoder at the end of its line.

mod adapter;
mod faults;
mod jobs;
mod master;
mod support;
mod unknown;
