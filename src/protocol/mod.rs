//! Bytes ↔ meaning. Pure functions and tables: no socket, port, clock, thread, channel or file.

pub mod hiperdrive;
