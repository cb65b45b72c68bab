//! The virtual adapter of the command `simulate`.

use crate::buses::bridge::sim::Adapter;
use crate::cli::simulate::ServableDevice;

impl ServableDevice for Adapter {}
