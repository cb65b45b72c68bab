//! A BiSS encoder at the end of its line.

mod adapter;
mod master;
mod support;
