//! Test support: a cable to virtual encoders or to an adapter. They continue to exist when the cable is disconnected,
//! and communication can be held at a request.

use std::sync::{Arc, Condvar, Mutex, MutexGuard};

use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::biss::sim as biss;
use encoder_studio::devices::biss::sim::UbicomPort;
use encoder_studio::devices::hiperdrive::sim as hiperdrive;
use encoder_studio::devices::hiperdrive::sim::Target;
use encoder_studio::devices::hiperface::sim as hiperface;
use encoder_studio::devices::hiperface::sim::Bus;
use encoder_studio::devices::interbus::sim as interbus;
use encoder_studio::devices::interbus::sim::Gateway;
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::link::{ByteLink, Clock, LinkError, LinkErrorKind, SimLink, VirtualClock};
use encoder_studio::sim::ByteDevice;
use encoder_studio::units::{CharacterFormat, Moment};

use crate::novo::sim::Virtual;
use crate::support::LONG;

/// A cable to virtual devices that can be disconnected and held.
pub(crate) struct Wire {
    target: String,
    end: End,
    clock: Arc<VirtualClock>,
    state: Mutex<State>,
    changed: Condvar,
}

/// The devices at the end of a cable.
enum End {
    /// HIPERFACE encoders.
    Hiperface(Arc<Mutex<Bus>>),
    /// A BiSS encoder at its configuration pin.
    Pin(Arc<Mutex<UbicomPort>>),
    /// An adapter with a BiSS encoder.
    Adapter(Arc<Mutex<Adapter>>),
    /// A gateway with an INTERBUS encoder.
    Gateway(Arc<Mutex<Gateway>>),
    /// An adapter with a HIPERDRIVE drive.
    Target(Arc<Mutex<Target>>),
    /// An encoder of the test kind.
    Novo(Arc<Mutex<Virtual>>),
}

impl End {
    fn device(&self) -> Arc<Mutex<dyn ByteDevice>> {
        match self {
            End::Hiperface(bus) => bus.clone(),
            End::Pin(port) => port.clone(),
            End::Adapter(adapter) => adapter.clone(),
            End::Gateway(gateway) => gateway.clone(),
            End::Target(target) => target.clone(),
            End::Novo(encoder) => encoder.clone(),
        }
    }

    /// Returns the command in a request, or `None` for a packet to an adapter, which is not parsed.
    fn command(&self, frame: &[u8]) -> Option<u8> {
        match self {
            End::Hiperface(_) => frame.get(1).copied(),
            End::Pin(_) => frame.get(2).copied(),
            End::Adapter(_) => None,
            End::Novo(_) => frame.first().copied(),
            // The service follows the headers of the frame and of its items.
            End::Target(_) => frame.get(40).copied(),
            // The function follows number, protocol, length and unit. For a write, the first byte of the OUT word
            // counts instead.
            End::Gateway(_) => frame.get(if frame.get(7) == Some(&16) { 13 } else { 7 }).copied(),
        }
    }
}

#[derive(Default)]
struct State {
    unplugged: bool,
    /// Whether the next frame to be sent causes a panic.
    deadly: bool,
    /// Every frame sent.
    sent: Vec<Vec<u8>>,
    /// The request at which communication is held: its command, and how many such requests pass first.
    hold: Option<(u8, usize)>,
    held: bool,
}

impl Wire {
    /// Creates a cable to HIPERFACE encoders. `query` describes them as in a `sim:` link.
    pub(crate) fn new(target: &str, query: &str) -> Arc<Self> {
        Self::to(target, End::Hiperface(Arc::new(Mutex::new(bus(query)))))
    }

    /// Creates a cable to the configuration pin of a BiSS encoder.
    pub(crate) fn to_pin(target: &str, query: &str) -> Arc<Self> {
        Self::to(target, End::Pin(Arc::new(Mutex::new(port(query)))))
    }

    /// Creates a cable to a gateway with an INTERBUS encoder.
    pub(crate) fn to_gateway(target: &str, query: &str) -> Arc<Self> {
        Self::to(target, End::Gateway(Arc::new(Mutex::new(gateway(query)))))
    }

    /// Creates a cable to an adapter with a HIPERDRIVE drive.
    pub(crate) fn to_target(target: &str, query: &str) -> Arc<Self> {
        Self::to(target, End::Target(Arc::new(Mutex::new(drive(query)))))
    }

    /// Creates a cable to an encoder of the test kind.
    pub(crate) fn to_novo(target: &str, query: &str) -> Arc<Self> {
        Self::to(target, End::Novo(Arc::new(Mutex::new(novo(query)))))
    }

    /// Creates a cable to an adapter with a BiSS encoder.
    pub(crate) fn to_adapter(target: &str, query: &str) -> Arc<Self> {
        let adapter = Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap();
        Self::to(target, End::Adapter(Arc::new(Mutex::new(adapter))))
    }

    fn to(target: &str, end: End) -> Arc<Self> {
        Arc::new(Wire {
            target: target.to_owned(),
            end,
            clock: Arc::default(),
            state: Mutex::default(),
            changed: Condvar::new(),
        })
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap()
    }

    pub(crate) fn target(&self) -> &str {
        &self.target
    }

    pub(crate) fn clock(&self) -> Arc<dyn Clock> {
        self.clock.clone()
    }

    /// Returns the HIPERFACE encoders.
    fn bus(&self) -> MutexGuard<'_, Bus> {
        let End::Hiperface(bus) = &self.end else { panic!("{} leads to no HIPERFACE encoder", self.target) };
        bus.lock().unwrap()
    }

    /// Writes registers of a BiSS encoder directly, bypassing the window.
    pub(crate) fn enter(&self, entries: &[(&str, u8)]) {
        let End::Pin(port) = &self.end else { panic!("{} leads to no configuration pin", self.target) };
        let (now, mut port) = (self.clock.now(), port.lock().unwrap());
        for (place, value) in entries {
            assert!(port.encoder_mut().write(now, place.parse().unwrap(), *value), "{place}");
        }
    }

    /// Replaces the devices at the end of the cable.
    pub(crate) fn exchange(&self, query: &str) {
        match &self.end {
            End::Hiperface(own) => *own.lock().unwrap() = bus(query),
            End::Pin(own) => *own.lock().unwrap() = port(query),
            End::Gateway(own) => *own.lock().unwrap() = gateway(query),
            End::Target(own) => *own.lock().unwrap() = drive(query),
            End::Novo(own) => *own.lock().unwrap() = novo(query),
            End::Adapter(_) => panic!("the encoder is behind it"),
        }
    }

    pub(crate) fn unplug(&self) {
        self.state().unplugged = true;
    }

    pub(crate) fn plug(&self) {
        self.state().unplugged = false;
    }

    /// Makes the next thread that sends a frame panic.
    pub(crate) fn kill(&self) {
        self.state().deadly = true;
    }

    /// Holds the cable before a request with this command. `number` counts from the next request, starting with 1.
    pub(crate) fn hold_at(&self, command: u8, number: usize) {
        self.state().hold = Some((command, number - 1));
    }

    /// Waits until the cable is held at the request.
    pub(crate) fn wait_until_held(&self) {
        let state = self.state();
        let (state, _) = self.changed.wait_timeout_while(state, LONG, |state| !state.held).unwrap();
        assert!(state.held, "the line was never held");
    }

    pub(crate) fn is_held(&self) -> bool {
        self.state().held
    }

    pub(crate) fn release(&self) {
        let mut state = self.state();
        (state.hold, state.held) = (None, false);
        self.changed.notify_all();
    }

    /// Returns the number of frames sent.
    pub(crate) fn sent(&self) -> usize {
        self.state().sent.len()
    }

    /// Returns how often a command was sent.
    pub(crate) fn count(&self, command: u8) -> usize {
        self.state().sent.iter().filter(|frame| self.end.command(frame) == Some(command)).count()
    }

    /// Returns how often an OUT word was written to the gateway.
    pub(crate) fn outs(&self) -> usize {
        self.state().sent.iter().filter(|frame| frame.get(7) == Some(&16)).count()
    }

    /// Returns the bytes of a data field, read directly from the simulated encoder.
    pub(crate) fn field(&self, number: u8) -> Vec<u8> {
        self.bus().encoders()[0].memory().field_bytes(number).unwrap().to_vec()
    }

    /// Returns the number of write cycles used in the encoder's EEPROM.
    pub(crate) fn wear(&self) -> u64 {
        self.bus().encoders()[0].wear().total().into()
    }

    fn check_plug(&self) -> Result<(), LinkError> {
        match self.state().unplugged {
            true => Err(LinkError::new(&self.target, LinkErrorKind::Lost)),
            false => Ok(()),
        }
    }

    fn pass(&self, frame: &[u8]) {
        let mut state = self.state();
        if std::mem::take(&mut state.deadly) {
            drop(state);
            panic!("as the test wants it");
        }
        state.sent.push(frame.to_vec());
        match &mut state.hold {
            Some((command, 0)) if Some(*command) == self.end.command(frame) => {}
            Some((command, left)) if Some(*command) == self.end.command(frame) => {
                *left -= 1;
                return;
            }
            _ => return,
        }
        state.held = true;
        self.changed.notify_all();
        drop(self.changed.wait_while(state, |state| state.held).unwrap());
    }
}

/// The host's end of the cable.
pub(crate) struct TestLink {
    wire: Arc<Wire>,
    line: SimLink,
}

impl TestLink {
    /// Connects to the cable. Returns an error if it is disconnected.
    pub(crate) fn plug_into(wire: &Arc<Wire>) -> Result<Self, LinkError> {
        let missing = |_| LinkError::new(&wire.target, LinkErrorKind::NotFound);
        wire.check_plug().map_err(missing)?;
        Ok(TestLink { wire: wire.clone(), line: SimLink::connect(wire.end.device(), wire.clock.clone()) })
    }
}

impl ByteLink for TestLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        self.wire.check_plug()?;
        self.wire.pass(bytes);
        self.wire.check_plug()?;
        self.line.send(bytes)
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        self.wire.check_plug()?;
        self.line.receive(until, into)
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        self.wire.check_plug()?;
        self.line.set_format(format)
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.wire.check_plug()
    }
}

fn pairs(query: &str) -> Vec<(String, String)> {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}

fn bus(query: &str) -> Bus {
    Bus::new(&hiperface::Config::from_pairs(&pairs(query)).unwrap())
}

fn gateway(query: &str) -> Gateway {
    Gateway::new(&interbus::Config::from_pairs(&pairs(query)).unwrap())
}

fn drive(query: &str) -> Target {
    Target::new(&hiperdrive::Config::from_pairs(&pairs(query)).unwrap())
}

fn novo(query: &str) -> Virtual {
    Virtual::from_pairs(&pairs(query)).unwrap()
}

fn port(query: &str) -> UbicomPort {
    UbicomPort::new(&biss::Config::from_pairs(&pairs(query)).unwrap())
}
