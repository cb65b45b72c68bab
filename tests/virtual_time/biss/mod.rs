//! A BiSS encoder at the end of its line.

mod master;
mod support;
