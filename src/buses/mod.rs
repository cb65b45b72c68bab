//! What several devices speak.

pub mod bridge;
pub mod ubicom;
