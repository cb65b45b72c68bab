//! The reasons why a job ends early on a writable device: before the first write, or after it.

use std::path::PathBuf;

use super::NotBegun;
use crate::profile::{DeviceError, Interrupted, OperationError, WriteRecord};

/// The reason why a job ended early, for any kind of device.
pub trait EndedEarly {
    /// Returns whether the user cancelled it.
    fn is_cancelled(&self) -> bool;

    /// Returns the number of operations carried out before; `None` if no write was begun.
    fn done(&self) -> Option<usize> {
        None
    }

    /// Returns whether something was written before it ended.
    fn has_begun(&self) -> bool {
        self.done().is_some()
    }
}

/// The reason why a job ended early, for a device with errors `E`, planning errors `P`, interrupted writes `I` (an
/// [`Interrupted`]) and kinds of change `K`.
#[derive(Debug, thiserror::Error)]
pub enum JobError<E, P, I, K> {
    /// The device.
    #[error(transparent)]
    Device(E),
    /// The plan is not possible; nothing was written.
    #[error(transparent)]
    Plan(P),
    /// The device counts as worn, or its before-image cannot be kept; nothing was written.
    #[error(transparent)]
    NotBegun(#[from] NotBegun),
    /// The write was begun and not finished.
    #[error("{interrupted}; before-image: {}", backup.display())]
    Interrupted {
        /// The changes written, the cause, and the state in which the device was left.
        interrupted: Box<I>,
        /// The before-image.
        backup: PathBuf,
        /// Operations of the plan.
        planned: usize,
        /// The kind of change.
        kind: K,
    },
}

impl<P, Op, E: OperationError, Done: WriteRecord, Left, K> JobError<E::Device, P, Interrupted<Op, E, Done, Left>, K> {
    /// Returns the error of the device or its connection, whether or not something was written before.
    pub fn device(&self) -> Option<&E::Device> {
        match self {
            JobError::Device(error) => Some(error),
            JobError::Interrupted { interrupted, .. } => interrupted.cause.device(),
            JobError::Plan(_) | JobError::NotBegun(_) => None,
        }
    }
}

impl<P, Op, E, Done, Left, K> EndedEarly for JobError<E::Device, P, Interrupted<Op, E, Done, Left>, K>
where
    E: OperationError<Device: DeviceError>,
    Done: WriteRecord,
{
    fn is_cancelled(&self) -> bool {
        self.device().is_some_and(DeviceError::is_cancelled)
    }

    fn done(&self) -> Option<usize> {
        match self {
            JobError::Interrupted { interrupted, .. } => Some(interrupted.done.ops()),
            JobError::Device(_) | JobError::Plan(_) | JobError::NotBegun(_) => None,
        }
    }
}

impl<E: DeviceError, P, I, K> From<E> for JobError<E, P, I, K> {
    fn from(error: E) -> Self {
        JobError::Device(error)
    }
}
