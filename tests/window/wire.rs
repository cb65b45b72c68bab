//! A cable with virtual encoders at its end: they stay when it is pulled, and it can be held at a request.

use std::sync::{Arc, Condvar, Mutex, MutexGuard};

use encoder_studio::link::{ByteLink, Clock, LinkError, LinkErrorKind, SimLink, VirtualClock};
use encoder_studio::sim::hiperface::{Bus, Config};
use encoder_studio::units::{CharacterFormat, Moment};

use crate::support::LONG;

/// A cable with virtual encoders at its end.
pub(crate) struct Wire {
    target: String,
    bus: Arc<Mutex<Bus>>,
    clock: Arc<VirtualClock>,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    unplugged: bool,
    /// Whoever sends dies.
    deadly: bool,
    /// Every frame that was handed to the line.
    sent: Vec<Vec<u8>>,
    /// Hold before the request of this command that has so many before it.
    hold: Option<(u8, usize)>,
    held: bool,
}

impl Wire {
    pub(crate) fn new(target: &str, query: &str) -> Arc<Self> {
        Arc::new(Wire {
            target: target.to_owned(),
            bus: Arc::new(Mutex::new(bus(query))),
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

    /// The encoders.
    fn bus(&self) -> MutexGuard<'_, Bus> {
        self.bus.lock().unwrap()
    }

    /// Other encoders from now on.
    pub(crate) fn exchange(&self, query: &str) {
        *self.bus() = bus(query);
    }

    pub(crate) fn unplug(&self) {
        self.state().unplugged = true;
    }

    pub(crate) fn plug(&self) {
        self.state().unplugged = false;
    }

    /// The thread that sends next dies without a word.
    pub(crate) fn kill(&self) {
        self.state().deadly = true;
    }

    /// Holds the line before the `number`th request of a command from now on, 1 first.
    pub(crate) fn hold_at(&self, command: u8, number: usize) {
        self.state().hold = Some((command, number - 1));
    }

    /// Waits until the line is held.
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

    /// How many frames were handed to the line.
    pub(crate) fn sent(&self) -> usize {
        self.state().sent.len()
    }

    /// How often a command was sent.
    pub(crate) fn count(&self, command: u8) -> usize {
        self.state().sent.iter().filter(|frame| frame[1] == command).count()
    }

    /// The bytes of a data field, looked at in the encoder.
    pub(crate) fn field(&self, number: u8) -> Vec<u8> {
        self.bus().encoders()[0].memory().field_bytes(number).unwrap().to_vec()
    }

    /// How often the encoder's EEPROM was written.
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
            Some((command, 0)) if *command == frame[1] => {}
            Some((command, left)) if *command == frame[1] => {
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

/// Our end of a cable.
pub(crate) struct TestLink {
    wire: Arc<Wire>,
    line: SimLink,
}

impl TestLink {
    /// Plugs in; a cable that is not there cannot be.
    pub(crate) fn plug_into(wire: &Arc<Wire>) -> Result<Self, LinkError> {
        let missing = |_| LinkError::new(&wire.target, LinkErrorKind::NotFound);
        wire.check_plug().map_err(missing)?;
        Ok(TestLink { wire: wire.clone(), line: SimLink::connect(wire.bus.clone(), wire.clock.clone()) })
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

    fn check(&mut self) -> Result<(), LinkError> {
        self.wire.check_plug()
    }
}

/// A virtual line as `sim:?…` describes it.
fn bus(query: &str) -> Bus {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    let pairs: Vec<_> = pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
    Bus::new(&Config::from_pairs(&pairs).unwrap())
}
