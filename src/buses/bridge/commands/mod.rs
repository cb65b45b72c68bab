//! The virtual adapter for the `simulate` command.

use crate::buses::bridge::sim::Adapter;
use crate::cli::simulate::ServableDevice;

impl ServableDevice for Adapter {}
