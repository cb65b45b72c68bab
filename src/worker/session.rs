//! A session: one wire and what is known about the device at its end.

use std::sync::Arc;

use super::{Event, Job, JobError, JobId, Progress, hiperface};
use crate::device::hiperface::{Codes, Master, Station};
use crate::link::{ByteLink, Cancel, Clock, Ctx, LinkError, Trace, TraceEntry};
use crate::protocol::hiperface::EncoderTypes;
use crate::store::Store;

/// One wire, from opening to closing. A test runs jobs on it inline; a worker runs them on a thread of its own.
pub struct Session {
    wire: Box<dyn ByteLink>,
    clock: Arc<dyn Clock>,
    cancel: Cancel,
    trace: Trace,
    station: Station,
    pub(super) store: Store,
    pub(super) types: EncoderTypes,
    pub(super) is_virtual: bool,
}

impl Session {
    /// A session on an open wire. `is_virtual`: the device lives in this process, and its wear counts apart.
    pub fn new(
        wire: Box<dyn ByteLink>,
        clock: Arc<dyn Clock>,
        station: Station,
        store: Store,
        types: EncoderTypes,
        is_virtual: bool,
    ) -> Self {
        let (cancel, trace) = (Cancel::default(), Trace::default());
        Session { wire, clock, cancel, trace, station, store, types, is_virtual }
    }

    /// The wish to end what runs.
    pub fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    /// Listens to another wish from now on: a test's, that comes by itself.
    pub fn set_cancel(&mut self, cancel: Cancel) {
        self.cancel = cancel;
    }

    /// Shows every frame from now on to `watcher`.
    pub fn watch(&mut self, watcher: impl FnMut(&TraceEntry) + Send + 'static) {
        self.trace.watch(watcher);
    }

    /// The access codes that the user knows.
    pub fn codes_mut(&mut self) -> &mut Codes {
        &mut self.station.codes
    }

    /// What is known about the line.
    pub fn station(&self) -> &Station {
        &self.station
    }

    /// The time of the session.
    pub fn clock(&self) -> &Arc<dyn Clock> {
        &self.clock
    }

    /// Looks whether the wire is still there.
    ///
    /// # Errors
    /// When it is not.
    pub fn check(&mut self) -> Result<(), LinkError> {
        self.wire.check()
    }

    /// Carries out a job here and now. `tell` hears all events but the last, which is given back.
    pub fn run(&mut self, id: JobId, job: Job, tell: &mut dyn FnMut(Event)) -> Event {
        tell(Event::Started(id));
        let result = match job {
            Job::Hiperface(job) => hiperface::run(self, job, &mut |progress| tell(Event::Progress(id, progress))),
        };
        let codes = self.station.take_codes();
        if !codes.is_empty() {
            tell(Event::Codes(codes));
        }
        match result {
            Ok(output) => Event::Finished(id, Box::new(output)),
            Err(error) if error.is_cancelled() => Event::Cancelled(id, Box::new(error)),
            Err(error) => Event::Failed(id, Box::new(error)),
        }
    }

    /// Carries out a job here and now, for whoever wants nothing but its result.
    ///
    /// # Errors
    /// Those of the job.
    pub fn run_inline(&mut self, job: super::HiperfaceJob) -> Result<super::HiperfaceOutput, JobError> {
        hiperface::run(self, job, &mut |_: Progress| {}).map(|super::JobOutput::Hiperface(output)| output)
    }

    /// The host's side of the line.
    pub(super) fn master(&mut self) -> Master<'_> {
        let ctx = Ctx { wire: &mut *self.wire, clock: &*self.clock, cancel: &self.cancel, trace: &mut self.trace };
        Master::new(ctx, &mut self.station)
    }
}
