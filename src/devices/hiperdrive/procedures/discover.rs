//! Discovery: broadcasts a ListIdentity request and collects replies for one second. No connection is opened.

use core::net::Ipv4Addr;
use std::time::Duration;

use super::Error;
use crate::buses::ethernet_ip::protocol::{Body, Command, Frame, IdentityItem};
use crate::devices::hiperdrive::protocol::VENDOR;
use crate::link::{BroadcastChannel, CancelToken, Clock};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiscoveredDevice {
    pub address: Ipv4Addr,
    pub port: u16,
    pub identity: IdentityItem,
}

impl DiscoveredDevice {
    /// Returns whether the device is from the manufacturer of HIPERDRIVE, according to its vendor ID.
    pub const fn is_hiperdrive(&self) -> bool {
        self.identity.identity.vendor == VENDOR
    }
}

/// Time for collecting replies. A discovery request can allow devices to delay their replies, but this one does not.
const COLLECTION_TIME: Duration = Duration::from_secs(1);
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(50);

/// Broadcasts a request and collects replies for a second. Each device is returned once, sorted by address.
///
/// # Errors
/// Returns a network error, or [`Error::Cancelled`] if the job is cancelled.
pub fn discover(
    shout: &mut dyn BroadcastChannel,
    clock: &dyn Clock,
    cancel: &CancelToken,
) -> Result<Vec<DiscoveredDevice>, Error> {
    shout.broadcast(&Frame::list_identity([0; 8]).emit())?;
    let until = clock.now() + COLLECTION_TIME;
    let mut found: Vec<DiscoveredDevice> = Vec::new();
    let mut packet = Vec::new();
    while clock.now() < until {
        if cancel.is_requested() {
            return Err(Error::Cancelled);
        }
        let Some(address) = shout.receive((clock.now() + CANCEL_CHECK_INTERVAL).min(until), &mut packet)? else {
            continue;
        };
        let identity =
            parse_reply(&packet).map(|identity| DiscoveredDevice { address, port: identity.socket.port, identity });
        found
            .extend(identity.filter(|new| !found.iter().any(|old| old.address == new.address && old.port == new.port)));
    }
    found.sort_by_key(|found| (found.address, found.port));
    Ok(found)
}

/// Parses a discovery reply. Returns `None` for any other packet.
fn parse_reply(packet: &[u8]) -> Option<IdentityItem> {
    let frame = Frame::parse(packet).ok().filter(|frame| frame.command == Command::LIST_IDENTITY)?;
    match frame.parse_body().ok()? {
        Body::List(items) => items.identity().cloned(),
        _ => None,
    }
}
