//! A device that exists only in tests and never sends a message.

use super::{Device, EndedEarly, SessionContext, Tell, Watched};
use crate::link::LinkError;

/// The device, which is never asked.
#[derive(Debug)]
pub(super) struct Invented;

impl EndedEarly for () {
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Device for Invented {
    type Job = ();
    type Output = ();
    type Error = ();
    type DeviceMessage = ();
    type Sample = ();
    type Watch = ();
    type JobStep = ();

    fn run(&mut self, _: &mut SessionContext, (): (), _: &mut dyn FnMut(Tell<(), ()>)) -> Result<(), ()> {
        Err(())
    }

    fn sample(&mut self, _: &mut SessionContext) -> Result<(), ()> {
        Err(())
    }

    fn watch(&mut self, _: &mut SessionContext, (): &()) -> Result<Watched<()>, ()> {
        Err(())
    }

    fn check(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}
