//! Reasons for aborting a job on a writable device, before or after its first write.

use std::path::PathBuf;

use super::NotStarted;
use crate::profile::{DeviceError, InterruptedWrite, OperationError, WriteRecord};

/// The reason why a job was aborted, for any kind of device.
pub trait JobInterruption {
    /// Returns whether the user cancelled the job.
    fn is_cancelled(&self) -> bool;

    /// Returns the number of operations executed before the job was aborted. Returns `None` if no write had begun.
    fn operations_done(&self) -> Option<usize> {
        None
    }

    /// Returns whether anything had been written to the device before the job was aborted.
    fn has_begun(&self) -> bool {
        self.operations_done().is_some()
    }
}

/// The reason why a job was aborted. `E` is the error type of the device and `P` that of planning. `I` is an
/// [`InterruptedWrite`], and `K` the kind of change.
#[derive(Debug, thiserror::Error)]
pub enum JobError<E, P, I, K> {
    /// The device or its connection failed.
    #[error(transparent)]
    Device(E),
    /// The plan could not be made. Nothing was written.
    #[error(transparent)]
    Plan(P),
    /// The write did not begin, because the device has reached its limit of write cycles or its backup cannot be saved.
    #[error(transparent)]
    NotStarted(#[from] NotStarted),
    /// The write began but was not completed.
    #[error("{interrupted}; before-image: {}", backup.display())]
    Interrupted {
        /// Changes already written, the cause, and the state of the device.
        interrupted: Box<I>,
        /// Path of the backup.
        backup: PathBuf,
        /// Number of operations in the plan.
        planned: usize,
        /// Kind of change.
        kind: K,
    },
}

impl<P, Op, E: OperationError, Done: WriteRecord, Left, K>
    JobError<E::Device, P, InterruptedWrite<Op, E, Done, Left>, K>
{
    /// Returns the error from the device or its connection, whether or not anything had been written.
    pub fn device(&self) -> Option<&E::Device> {
        match self {
            JobError::Device(error) => Some(error),
            JobError::Interrupted { interrupted, .. } => interrupted.cause.device(),
            JobError::Plan(_) | JobError::NotStarted(_) => None,
        }
    }
}

impl<P, Op, E, Done, Left, K> JobInterruption for JobError<E::Device, P, InterruptedWrite<Op, E, Done, Left>, K>
where
    E: OperationError<Device: DeviceError>,
    Done: WriteRecord,
{
    fn is_cancelled(&self) -> bool {
        self.device().is_some_and(DeviceError::is_cancelled)
    }

    fn operations_done(&self) -> Option<usize> {
        match self {
            JobError::Interrupted { interrupted, .. } => Some(interrupted.done.operation_count()),
            JobError::Device(_) | JobError::Plan(_) | JobError::NotStarted(_) => None,
        }
    }
}

impl<E: DeviceError, P, I, K> From<E> for JobError<E, P, I, K> {
    fn from(error: E) -> Self {
        JobError::Device(error)
    }
}
