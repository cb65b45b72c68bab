//! A BiSS encoder at the end of its line.

mod adapter;
mod faults;
mod jobs;
mod master;
mod streams;
mod support;
mod unknown;
