//! UBICOM: registers and positions over a serial line.

pub mod protocol;
