//! A virtual gateway that connects several Modbus/TCP clients to the encoders behind it. An encoder executes the last
//! command, whichever client sent it. It is assumed that a reply takes two milliseconds, and that requests for another
//! unit or an unpowered encoder return exception 0Bh.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use fastrand::Rng;

use super::config::Config;
use super::encoder::Encoder;
use super::frame::{self, Exception, Registers};
use super::registers::{EncoderList, RegisterMap};
use crate::sim::line::TransitQueue;
use crate::sim::{ByteDevice, Motor, SimulatedFaults};
use crate::units::Moment;

/// One client's connection to a virtual gateway. Use [`new_connection`](Self::new_connection) for another client.
#[derive(Clone)]
pub struct Gateway {
    shared: Arc<Mutex<Shared>>,
    /// Received bytes of an incomplete frame.
    received: Vec<u8>,
    to_host: TransitQueue<Vec<u8>>,
}

struct Shared {
    unit: u8,
    map: RegisterMap,
    encoders: EncoderList,
    faults: SimulatedFaults,
    exceptions: f64,
    rng: Rng,
    requests: u32,
    now: Moment,
}

impl Gateway {
    const REPLY: Duration = Duration::from_millis(2);

    pub fn new(config: &Config) -> Self {
        let shared = Shared {
            unit: config.unit,
            map: RegisterMap::new(config),
            encoders: EncoderList::new(config),
            faults: config.faults.clone(),
            exceptions: config.exceptions,
            rng: Rng::with_seed(config.seed),
            requests: 0,
            now: Moment::START,
        };
        Gateway { shared: Arc::new(Mutex::new(shared)), received: Vec::new(), to_host: TransitQueue::default() }
    }

    /// Returns another connection to the same gateway and its encoders.
    pub fn new_connection(&self) -> Self {
        Gateway { shared: self.shared.clone(), received: Vec::new(), to_host: TransitQueue::default() }
    }

    pub fn shaft_motor(&self) -> Motor {
        self.with_encoder(|encoder| encoder.motor())
    }

    /// Runs `work` on the first encoder, bypassing the bus.
    pub fn with_encoder<T>(&self, work: impl FnOnce(&mut Encoder) -> T) -> T {
        work(&mut self.lock().encoders.first)
    }

    /// Replaces the simulated faults of the gateway, as if it were repaired or broke down. The numbers of requests and
    /// EEPROM write cycles are kept.
    pub fn set_faults(&self, faults: &SimulatedFaults) {
        let mut shared = self.lock();
        shared.faults = faults.clone();
        shared.encoders.iter_mut().for_each(|encoder| encoder.set_faults(faults));
    }

    fn lock(&self) -> MutexGuard<'_, Shared> {
        // The virtual device must remain usable after a test has panicked.
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct GatewayRegisters<'a>(&'a mut Shared);

impl Registers for GatewayRegisters<'_> {
    fn inputs(&mut self, first: u16, count: u16) -> Result<Vec<u16>, Exception> {
        self.0.map.inputs(&mut self.0.encoders, self.0.now, first, count)
    }

    fn holding_registers(&mut self, first: u16, count: u16) -> Result<Vec<u16>, Exception> {
        self.0.map.outputs(&mut self.0.encoders, first, count)
    }

    fn write(&mut self, first: u16, values: &[u16]) -> Result<(), Exception> {
        self.0.map.write(&mut self.0.encoders, self.0.now, first, values)
    }
}

impl Shared {
    /// Handles a request and returns the reply that reaches the host, if any.
    fn handle_request(&mut self, request: &[u8]) -> Option<Vec<u8>> {
        let silent = self.faults.silent_after().is_some_and(|requests| requests <= self.requests);
        self.requests = self.requests.saturating_add(1);
        if silent {
            return None;
        }
        // `f64()` is below 1, so a fraction of 1 always matches and 0 never does.
        let reply = if self.rng.f64() < self.exceptions {
            frame::exception_reply(request, Exception::NoAnswer)
        } else {
            let unit = self.unit;
            frame::reply_to(request, unit, &mut GatewayRegisters(self))
        };
        self.apply_faults(reply)
    }

    /// Applies the configured faults to a reply. A fault that would damage one byte on a serial line applies to the
    /// whole reply, since TCP delivers complete data.
    fn apply_faults(&mut self, mut reply: Vec<u8>) -> Option<Vec<u8>> {
        let passage = self.faults.transmit_byte(&mut self.rng, 0);
        let carried = passage.carried?;
        if passage.inserted.is_some() {
            reply.iter_mut().for_each(|byte| *byte = self.rng.u8(..));
        } else if carried.flipped
            && let Some(byte) = self.rng.choice(&mut reply)
        {
            *byte ^= carried.byte;
        }
        Some(reply)
    }
}

impl ByteDevice for Gateway {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.received.extend(bytes);
        while let Some(request) = frame::next(&mut self.received) {
            let mut shared = self.lock();
            shared.now = shared.now.max(now);
            let due = shared.now + Self::REPLY + shared.faults.reply_delay();
            let reply = shared.handle_request(&request);
            drop(shared);
            if let Some(reply) = reply {
                self.to_host.insert(due, reply);
            }
        }
    }

    fn poll(&mut self, now: Moment) -> Vec<u8> {
        std::iter::from_fn(|| self.to_host.pop_until(now)).flatten().collect()
    }

    fn poll_at(&self) -> Option<Moment> {
        self.to_host.next_due()
    }

    /// Connects a client. Replies still pending from its previous connection are dropped, and encoders that have lost
    /// power are switched on again.
    fn connect(&mut self, now: Moment) {
        self.received.clear();
        self.to_host = TransitQueue::default();
        let mut shared = self.lock();
        shared.now = shared.now.max(now);
        let now = shared.now;
        shared.encoders.iter_mut().for_each(|encoder| encoder.connect(now));
    }
}
