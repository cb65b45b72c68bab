//! Why a job ends early where a device can be written: before anything was written, or on the way.

use std::path::PathBuf;

use super::NotBegun;
use crate::profile::{DeviceError, Interrupted, OperationError, WriteRecord};

/// Why a job ended early, of whatever kind of device.
pub trait EndedEarly {
    /// The user wished it.
    fn is_cancelled(&self) -> bool;

    /// Returns the operations that were carried out before; `None` where no write was begun.
    fn done(&self) -> Option<usize> {
        None
    }

    /// Something was written before it ended.
    fn has_begun(&self) -> bool {
        self.done().is_some()
    }
}

/// Why a job ended early, of a device with errors `E`, errors of planning `P`, writes that end early as an [`Interrupted`] `I`,
/// and changes of kind `K`.
#[derive(Debug, thiserror::Error)]
pub enum JobError<E, P, I, K> {
    /// The device.
    #[error(transparent)]
    Device(E),
    /// It cannot be planned; nothing was written.
    #[error(transparent)]
    Plan(P),
    /// The device counts as worn, or its before-image cannot be kept; nothing was written.
    #[error(transparent)]
    NotBegun(#[from] NotBegun),
    /// It was begun and not finished.
    #[error("{interrupted}; before-image: {}", backup.display())]
    Interrupted {
        /// What was written, why it ended, and in which state the device was left.
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
    /// What went wrong with the device or on the way to it, whether or not something was written before.
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
