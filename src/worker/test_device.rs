//! A test device that sends nothing.

use super::{Device, JobInterruption, JobReport, SessionContext, WatchReply};
use crate::link::LinkError;

/// A placeholder device that is never queried.
#[derive(Debug)]
pub(super) struct TestDevice;

impl JobInterruption for () {
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Device for TestDevice {
    type Job = ();
    type Output = ();
    type Error = ();
    type DeviceMessage = ();
    type Sample = ();
    type Watch = ();
    type JobStep = ();

    fn run(&mut self, _: &mut SessionContext, (): (), _: &mut dyn FnMut(JobReport<(), ()>)) -> Result<(), ()> {
        Err(())
    }

    fn take_sample(&mut self, _: &mut SessionContext) -> Result<(), ()> {
        Err(())
    }

    fn read_watched(&mut self, _: &mut SessionContext, (): &()) -> Result<WatchReply<()>, ()> {
        Err(())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}
