//! The command `simulate interbus`, which runs the virtual gateway and its encoders as a Modbus/TCP server.

use std::net::Ipv4Addr;

use crate::cli::args::SimulateArgs;
use crate::cli::output::Output;
use crate::cli::simulate::{ServableDevice, settings};
use crate::cli::{Failure, Result};
use crate::devices::interbus::sim::{Config, Gateway};

pub(super) fn create_simulated(output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
    if arguments.pty.is_some() {
        let what =
            "an INTERBUS encoder is reached through a Modbus/TCP gateway: use --listen HOST:PORT instead of --pty";
        return Err(Failure::Usage(what.to_owned()));
    }
    if arguments.bridge {
        let what = "--bridge is for biss: interbus is reached through a Modbus/TCP gateway";
        return Err(Failure::Usage(what.to_owned()));
    }
    let config =
        Config::from_pairs(&settings(output, arguments)?).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Box::new(Gateway::new(&config)))
}

impl ServableDevice for Gateway {
    /// Returns another connection to the gateway, which can serve several masters at once.
    fn clone_for_peer(&self, _peer: Ipv4Addr) -> Option<Box<dyn ServableDevice>> {
        Some(Box::new(self.new_connection()))
    }
}
