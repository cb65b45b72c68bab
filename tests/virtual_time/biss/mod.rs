//! A BiSS encoder at the end of its line.

mod adapter;
mod jobs;
mod master;
mod support;
