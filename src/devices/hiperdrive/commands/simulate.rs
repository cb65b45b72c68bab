//! The `simulate hiperdrive` command: simulates drives behind an adapter or a hub as an EtherNet/IP target.

use std::net::{Ipv4Addr, SocketAddrV4};

use crate::cli::args::SimulateArgs;
use crate::cli::output::Output;
use crate::cli::simulate::{ServableDevice, settings};
use crate::cli::{Failure, Result};
use crate::devices::hiperdrive::sim::{Config, Target};
use crate::sim::DatagramDevice;

pub(super) fn create_simulated(output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
    if arguments.pty.is_some() {
        let what = "HIPERDRIVE is reached over EtherNet/IP: use --listen HOST:PORT instead of --pty";
        return Err(Failure::Usage(what.to_owned()));
    }
    if arguments.bridge {
        return Err(Failure::Usage("--bridge is for biss: hiperdrive is reached over EtherNet/IP".to_owned()));
    }
    let config =
        Config::from_pairs(&settings(output, arguments)?).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Box::new(Target::new(&config)))
}

impl ServableDevice for Target {
    /// Accepts another connection, because a target can serve several originators at once.
    fn clone_for_peer(&self, peer: Ipv4Addr) -> Option<Box<dyn ServableDevice>> {
        Some(Box::new(self.connect_from(peer)))
    }

    fn datagram_device(&self) -> Option<Box<dyn DatagramDevice>> {
        Some(Box::new(self.clone()))
    }

    fn on_listening(&self, at: SocketAddrV4) {
        self.set_address(at);
    }

    fn has_ended(&self) -> bool {
        Target::has_ended(self)
    }
}
