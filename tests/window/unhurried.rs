//! Test support: virtual HIPERDRIVE drives whose time passes more slowly. A motion that is not refreshed for 250 ms
//! stops on purpose, but a busy computer without a graphics card may need longer for a frame.

use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex};

use encoder_studio::devices::hiperdrive::jobs::{DeviceConnection, Hiperdrive};
use encoder_studio::devices::hiperdrive::procedures::Station;
use encoder_studio::devices::hiperdrive::sim::{Config, Target};
use encoder_studio::link::{Clock, LinkUrl, RealClock, SimLink, SimPort};
use encoder_studio::store::Store;
use encoder_studio::units::Moment;
use encoder_studio::worker::{OpenError, Session};

use crate::support::MARGIN;

/// Number of real seconds for one second of simulated time.
const SLOWDOWN_FACTOR: u32 = 2;

struct SlowedClock(RealClock);

impl Clock for SlowedClock {
    fn now(&self) -> Moment {
        Moment::from_elapsed(self.0.now().since_start() / SLOWDOWN_FACTOR)
    }

    fn sleep_until(&self, moment: Moment) {
        self.0.sleep_until(Moment::from_elapsed(moment.since_start() * SLOWDOWN_FACTOR));
    }
}

/// Opens a session with the virtual drives of a `sim:` link, on the slower clock.
pub(crate) fn open(url: &LinkUrl, store: Store) -> Result<Session<Hiperdrive>, OpenError> {
    let clock: Arc<dyn Clock> = Arc::new(SlowedClock(RealClock::start()));
    let target = Target::new(&Config::from_pairs(&url.query.without(&["rpi", "udp", "timeout"]))?);
    let connection = Arc::new(Mutex::new(target.connect_from(Ipv4Addr::UNSPECIFIED)));
    let wire = Box::new(SimLink::connect(connection, clock.clone()));
    let port = Box::new(SimPort::new(Arc::new(Mutex::new(target.clone())), clock.clone()));
    let station = Station::from_query(&url.query, None, MARGIN)?;
    Ok(Session::for_target(DeviceConnection { wire, port: Some(port), station, target: Some(target) }, clock, store))
}
