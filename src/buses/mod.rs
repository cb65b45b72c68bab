//! What several devices speak.

pub mod ubicom;
