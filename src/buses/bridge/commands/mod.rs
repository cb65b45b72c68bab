//! The virtual adapter served by `simulate`.

use crate::buses::bridge::sim::Adapter;
use crate::cli::simulate::Simulated;

impl Simulated for Adapter {}
