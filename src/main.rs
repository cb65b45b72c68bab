//! The program: arguments → a command.

fn main() {}
