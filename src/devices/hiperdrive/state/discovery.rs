//! Device discovery: broadcasts a request and collects replies for a second without blocking the window.

use std::fmt;
use std::net::Ipv4Addr;
use std::sync::Arc;

use super::connect_form::{HiperdriveForm, HiperdriveLinkKind};
use super::unit::HiperdriveDevice;
use crate::app::action::{Action, TaskResult};
use crate::app::connect::context::FinderContext;
use crate::app::connect::form::Finder;
use crate::app::services::Services;
use crate::app::{DeviceModel, Text};
use crate::buses::ethernet_ip::protocol::EXPLICIT_MESSAGE_PORT;
use crate::devices::hiperdrive::procedures::{DiscoveredDevice, Error, discover};
use crate::devices::hiperdrive::state::explain;
use crate::link::{CancelToken, Clock, RealClock, UdpBroadcast};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Discovery {
    /// Number of the current discovery. Replies to earlier discoveries are dropped.
    number: u32,
    /// Devices found, or the reason why the request failed. `None` while replies are still being collected.
    pub found: Option<Result<Vec<FoundDevice>, Text>>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundDevice {
    pub address: Ipv4Addr,
    pub port: u16,
    pub name: String,
    pub serial_number: u32,
    pub is_hiperdrive: bool,
}

impl FoundDevice {
    fn from_reply(found: &DiscoveredDevice) -> Self {
        let identity = &found.identity.identity;
        FoundDevice {
            address: found.address,
            port: found.port,
            name: identity.product_name.clone(),
            serial_number: identity.serial_number,
            is_hiperdrive: found.is_hiperdrive(),
        }
    }
}

impl Discovery {
    /// Returns whether replies are still being collected.
    pub fn is_running(&self) -> bool {
        self.found.is_none()
    }

    pub fn devices(&self) -> &[FoundDevice] {
        match &self.found {
            Some(Ok(found)) => found,
            _ => &[],
        }
    }
}

/// A replacement for the discovery broadcast in tests.
#[derive(Clone)]
pub struct DiscoveryStub(Arc<dyn Fn() -> Result<Vec<DiscoveredDevice>, Error> + Send + Sync>);

impl DiscoveryStub {
    pub fn new(ask: impl Fn() -> Result<Vec<DiscoveredDevice>, Error> + Send + Sync + 'static) -> Self {
        DiscoveryStub(Arc::new(ask))
    }
}

impl fmt::Debug for DiscoveryStub {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Discover")
    }
}

/// Broadcasts a discovery request and collects replies for a second.
///
/// # Errors
/// Returns an error if the request cannot be sent.
fn broadcast_discovery() -> Result<Vec<DiscoveredDevice>, Error> {
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let mut shout = UdpBroadcast::on_all_networks(EXPLICIT_MESSAGE_PORT, clock.clone())?;
    discover(&mut shout, &*clock, &CancelToken::default())
}

#[derive(Default)]
pub struct DiscoveryFinder {
    pub discovery: Option<Discovery>,
}

pub enum DiscoveryAction {
    Discover,
    /// Fills in the address of a device that replied, so that the Connect button connects to it.
    Choose(usize),
}

pub struct DiscoveryReplies {
    number: u32,
    found: Result<Vec<FoundDevice>, Text>,
}

impl Finder for DiscoveryFinder {
    type Form = HiperdriveForm;
    type Action = DiscoveryAction;
    type TaskResult = DiscoveryReplies;

    fn handle_action(&mut self, action: DiscoveryAction, form: &mut HiperdriveForm, context: &mut FinderContext<'_>) {
        match action {
            DiscoveryAction::Discover => {
                let number = context.next_number();
                self.discovery = Some(Discovery { number, found: None });
                let services = context.services();
                let given = services.world.given.get::<DiscoveryStub>().cloned();
                services.tasks.run("discover", move || {
                    let found = given.map_or_else(broadcast_discovery, |discover| (discover.0)());
                    let found = found.map(|found| found.iter().map(FoundDevice::from_reply).collect());
                    let found = found.map_err(|error| explain::device_error_text(&error));
                    Action::Done(TaskResult::from_finder::<DiscoveryFinder>(
                        HiperdriveDevice::TAB,
                        DiscoveryReplies { number, found },
                    ))
                });
            }
            DiscoveryAction::Choose(at) => {
                let devices = self.discovery.as_ref().map(Discovery::devices).unwrap_or_default();
                let Some(device) = devices.get(at) else { return };
                form.kind = HiperdriveLinkKind::Network;
                form.host = device.address.to_string();
                form.tcp_port =
                    if device.port == EXPLICIT_MESSAGE_PORT { String::new() } else { device.port.to_string() };
            }
        }
    }

    /// Handles the discovery replies. HIPERDRIVE devices are listed first.
    fn handle_result(finder: Option<&mut Self>, done: DiscoveryReplies, _services: &mut Services) {
        let DiscoveryReplies { number, found } = done;
        let discovery = finder.and_then(|finder| finder.discovery.as_mut());
        let Some(discovery) = discovery.filter(|own| own.number == number) else { return };
        discovery.found = Some(found.map(|mut found| {
            found.sort_by_key(|own| !own.is_hiperdrive);
            found
        }));
    }
}
