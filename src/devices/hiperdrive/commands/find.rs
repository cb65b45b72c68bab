//! The `find` command: discovers every adapter and hub in the network by broadcast, or at one address. No connection is
//! opened.

use std::net::{SocketAddr, SocketAddrV4, ToSocketAddrs};
use std::sync::Arc;

use serde_json::{Value as Json, json};

use crate::app::explain;
use crate::buses::ethernet_ip::protocol::EXPLICIT_MESSAGE_PORT;
use crate::cli::args::CommonArgs;
use crate::cli::output::Output;
use crate::cli::runner::to_failure;
use crate::cli::{Failure, Result, Success};
use crate::devices::hiperdrive::procedures::{DiscoveredDevice, discover};
use crate::devices::hiperdrive::state::explain as words;
use crate::link::{CancelToken, Clock, LinkScheme, LinkUrl, RealClock, UdpBroadcast, Wire};

pub(super) fn find(common: &CommonArgs, output: &Output) -> Result {
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let shout = match &common.link {
        None => UdpBroadcast::on_all_networks(EXPLICIT_MESSAGE_PORT, clock.clone()),
        Some(url) => UdpBroadcast::new(query_addresses(url)?, clock.clone()),
    };
    let mut shout = shout.map_err(|error| to_failure(&explain::link_error_text(&error)))?;
    let found = discover(&mut shout, &*clock, &CancelToken::default())
        .map_err(|error| to_failure(&words::device_error_text(&error)))?;
    let (drives, others): (Vec<DiscoveredDevice>, Vec<DiscoveredDevice>) =
        found.into_iter().partition(DiscoveredDevice::is_hiperdrive);
    let list: Vec<Json> = drives.iter().map(discovered_device_json).collect();
    let text: String = drives.iter().map(discovered_device_text).collect();
    output.show(&json!({"devices": list, "others": others.len()}), &text)?;
    if !drives.is_empty() {
        return Ok(Success::Completed);
    }
    let summary = match others.len() {
        0 => "No device answered.".to_owned(),
        others => format!("No HIPERDRIVE answered; other EtherNet/IP devices: {others}."),
    };
    let hint = match &common.link {
        None => {
            "only devices in the network of this computer are searched; for other devices, use --link enip:ADDRESS."
        }
        Some(_) => "only this address was searched; without --link, the whole network of this computer is searched.",
    };
    Err(Failure::Failed(vec![format!("{summary} Check supply, cable and address: {hint}")]))
}

/// Returns the addresses to query: that of a single device, or the broadcast address of a network. An example of a
/// broadcast link is `enip:192.168.1.255`.
fn query_addresses(url: &LinkUrl) -> Result<Vec<SocketAddrV4>> {
    let (LinkScheme::Enip, Wire::Host(host)) = (url.scheme, url.wire()) else {
        return Err(Failure::Usage(
            "find hiperdrive takes --link enip:ADDRESS, or no link to search the whole network".to_owned(),
        ));
    };
    let found = host.to_socket_addrs().map_err(|error| {
        Failure::Failed(vec![format!(
            "{host} could not be resolved: {error}. Enter its IP address, such as enip:192.168.1.10."
        )])
    })?;
    let of_version_4 = |address| match address {
        SocketAddr::V4(address) => Some(address),
        SocketAddr::V6(_) => None,
    };
    let found: Vec<SocketAddrV4> = found.filter_map(of_version_4).take(1).collect();
    if found.is_empty() {
        return Err(Failure::Failed(vec![format!("{host} has no IPv4 address, which these devices require.")]));
    }
    Ok(found)
}

fn discovered_device_link(found: &DiscoveredDevice) -> String {
    match found.port {
        EXPLICIT_MESSAGE_PORT => format!("enip:{}", found.address),
        port => format!("enip:{}:{port}", found.address),
    }
}

fn discovered_device_json(found: &DiscoveredDevice) -> Json {
    let identity = &found.identity.identity;
    json!({
        "link": discovered_device_link(found),
        "address": found.address.to_string(),
        "port": found.port,
        "product_name": identity.product_name,
        "serial_number": identity.serial_number.to_string(),
        "revision": format!("{}.{}", identity.revision.major, identity.revision.minor),
    })
}

fn discovered_device_text(found: &DiscoveredDevice) -> String {
    let identity = &found.identity.identity;
    format!("{}  {}, serial number {}\n", discovered_device_link(found), identity.product_name, identity.serial_number)
}
