//! A session on its own thread, as seen by the window: the running job, the trace and the samples. It is the same for
//! all kinds of devices.

use std::time::Duration;

use jiff::Zoned;

use super::Text;
use super::action::OpenedConnection;
use super::session::Kind;
use crate::link::TraceEntry;
use crate::worker::{Device, Event, JobId, Progress, Ring, SubmitError, Worker, WorkerStopHandle};

#[derive(Clone, Debug)]
pub struct RunningJob<W> {
    pub id: JobId,
    pub title: Text,
    pub since: Zoned,
    pub progress: Option<Progress<W>>,
    pub writes: bool,
    pub stopping: bool,
}

pub struct LiveSession<D: Device> {
    worker: Worker<D>,
    trace: Ring<TraceEntry>,
    running: Option<RunningJob<D::JobStep>>,
    pub is_virtual: bool,
}

#[derive(Clone, Debug)]
pub struct JobProgress {
    pub title: Text,
    /// Number of completed steps, total number of steps, and description of the current step.
    pub progress: Option<(u64, u64, Text)>,
    pub stopping: bool,
}

impl<D: Kind> LiveSession<D> {
    pub(crate) fn new(opened: OpenedConnection<D>) -> Self {
        let OpenedConnection { worker, trace, is_virtual, .. } = opened;
        LiveSession { worker, trace, running: None, is_virtual }
    }

    pub fn job_progress(&self) -> Option<JobProgress> {
        let running = self.running.as_ref()?;
        let progress = running.progress.as_ref().map(|own| (own.done, own.total, D::step_text(&own.step)));
        Some(JobProgress { title: running.title.clone(), progress, stopping: running.stopping })
    }

    /// Starts a job.
    ///
    /// # Errors
    /// Returns an error if another job is running or the session has ended.
    pub(crate) fn submit(&mut self, job: D::Job, what: Text, writes: bool, now: Zoned) -> Result<JobId, SubmitError> {
        let id = self.worker.submit(job)?;
        self.running = Some(RunningJob { id, title: what, since: now, progress: None, writes, stopping: false });
        Ok(id)
    }

    pub fn running_job(&self) -> Option<&RunningJob<D::JobStep>> {
        self.running.as_ref()
    }

    /// Returns the polling interval, or `None` if polling is off.
    pub fn polling_interval(&self) -> Option<Duration> {
        self.worker.polling_interval()
    }

    pub(crate) fn poll(&mut self, interval: Option<Duration>) {
        self.worker.poll(interval);
    }

    /// Starts reading the given values between the samples.
    pub(crate) fn watch_values(&self, watched: Vec<(D::Watch, Duration)>) {
        self.worker.watch_values(watched);
    }

    pub(crate) fn stop(&mut self) {
        self.worker.stop();
        if let Some(running) = &mut self.running {
            running.stopping = true;
        }
    }

    pub(super) fn stop_job(&mut self) {
        let pace = self.polling_interval();
        self.stop();
        self.poll(pace);
    }

    /// Returns the next event and updates the state of the running job.
    pub(crate) fn next(&mut self) -> Option<Event<D>> {
        let event = self.worker.events().try_recv().ok()?;
        match &event {
            Event::Progress(id, progress) => {
                if let Some(running) = self.running.as_mut().filter(|running| running.id == *id) {
                    running.progress = Some(progress.clone());
                }
            }
            Event::Finished(..) | Event::Failed(..) | Event::Cancelled(..) => self.running = None,
            Event::PollFailed(_) | Event::Started(_) | Event::DeviceMessage(_) | Event::Lost(_) => {}
        }
        Some(event)
    }

    /// Returns whether the thread has ended unexpectedly and all of its events have been received.
    pub(crate) fn is_dead(&self) -> bool {
        self.worker.is_finished() && self.worker.events().is_empty()
    }

    /// Returns the samples since the previous call, and the number of dropped samples.
    pub(super) fn take_samples(&mut self) -> (Vec<D::Sample>, u64) {
        self.worker.samples().drain()
    }

    /// Returns the frames since the previous call, and the number of dropped frames.
    pub(super) fn take_frames(&mut self) -> (Vec<TraceEntry>, u64) {
        self.trace.drain()
    }

    /// Returns a handle that stops the running job from any thread.
    pub(crate) fn stop_handle(&self) -> WorkerStopHandle {
        self.worker.stop_handle()
    }

    /// Returns the worker. Closing a worker can take time and should not be done on the window's thread.
    pub(crate) fn into_worker(self) -> Worker<D> {
        self.worker
    }
}
