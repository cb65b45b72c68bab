//! Who is there in this network: asked of all at once, answered within a second, while the window goes on.

use std::fmt;
use std::net::Ipv4Addr;
use std::sync::Arc;

use super::connect_form::HiperdriveWay;
use crate::app::Text;
use crate::app::action::Done;
use crate::app::studio::Studio;
use crate::buses::ethernet_ip::protocol::EXPLICIT_PORT;
use crate::devices::hiperdrive::procedures::{Error, Found, discover};
use crate::devices::hiperdrive::state::explain as words;
use crate::link::{Cancel, Clock, RealClock, UdpShout};

/// A question to all, and its answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Discovery {
    /// Which one it is: answers to an earlier one are dropped.
    number: u32,
    /// Who has answered, or why nobody could be asked; `None` while answers come.
    pub found: Option<Result<Vec<FoundDevice>, Text>>,
}

/// A device that has answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundDevice {
    /// Where it answers from.
    pub address: Ipv4Addr,
    /// Where it takes explicit messages.
    pub port: u16,
    /// What it calls itself.
    pub name: String,
    /// Its serial number in its identity object.
    pub serial_number: u32,
    /// It is of the maker of HIPERDRIVE.
    pub is_hiperdrive: bool,
}

impl FoundDevice {
    fn of(found: &Found) -> Self {
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
    /// Answers are still coming.
    pub fn is_running(&self) -> bool {
        self.found.is_none()
    }

    /// Those that have answered.
    pub fn devices(&self) -> &[FoundDevice] {
        match &self.found {
            Some(Ok(found)) => found,
            _ => &[],
        }
    }
}

/// Asks who is there in this network, in place of a question to all who are in reach. Given by tests only.
#[derive(Clone)]
pub struct Discover(Arc<dyn Fn() -> Result<Vec<Found>, Error> + Send + Sync>);

impl Discover {
    /// Asks so.
    pub fn new(ask: impl Fn() -> Result<Vec<Found>, Error> + Send + Sync + 'static) -> Self {
        Discover(Arc::new(ask))
    }
}

impl fmt::Debug for Discover {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Discover")
    }
}

/// Asks all who are in reach, and waits for a second.
///
/// # Errors
/// Nobody could be asked.
fn ask_all() -> Result<Vec<Found>, Error> {
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let mut shout = UdpShout::to_all(EXPLICIT_PORT, clock.clone())?;
    discover(&mut shout, &*clock, &Cancel::default())
}

impl Studio {
    /// Asks who is there, as a task.
    pub(crate) fn discover(&mut self) {
        let number = self.new_number();
        let Some(connect) = &mut self.connect else { return };
        connect.discovery = Some(Discovery { number, found: None });
        connect.problem = None;
        let given = self.services.world.given.get::<Discover>().cloned();
        self.services.tasks.run("discover", move || {
            let found = given.map_or_else(ask_all, |discover| (discover.0)());
            let found = found.map(|found| found.iter().map(FoundDevice::of).collect());
            let found = found.map_err(|error| words::device(&error));
            crate::app::Action::Done(Done::FoundDrives(number, found))
        });
    }

    /// Answers have come. Those of HIPERDRIVE come first.
    pub(crate) fn found_drives(&mut self, number: u32, found: Result<Vec<FoundDevice>, Text>) {
        let discovery = self.connect.as_mut().and_then(|connect| connect.discovery.as_mut());
        let Some(discovery) = discovery.filter(|own| own.number == number) else { return };
        discovery.found = Some(found.map(|mut found| {
            found.sort_by_key(|own| !own.is_hiperdrive);
            found
        }));
    }

    /// Fills in the device that answered; it is connected by the button for that.
    pub(crate) fn choose_device(&mut self, at: usize) {
        let Some(connect) = &mut self.connect else { return };
        let found = connect.discovery.as_ref().and_then(|own| own.devices().get(at)).cloned();
        let Some(device) = found else { return };
        let form = &mut connect.hiperdrive;
        form.way = HiperdriveWay::Network;
        form.host = device.address.to_string();
        form.tcp_port = if device.port == EXPLICIT_PORT { String::new() } else { device.port.to_string() };
        (connect.typed, connect.problem) = (None, None);
    }
}
