//! Why a job ends early where a device can be written: before anything was written, or on the way.

use std::path::PathBuf;

use super::NotBegun;
use crate::profile::{Interrupted, OperationError, WriteRecord};

/// How far a write came that ended early, as its kind of device tells it.
pub trait Interruption {
    /// What goes wrong with such a device.
    type Error;

    /// What went wrong with the device or on the way to it; `None` where it was neither.
    fn error(&self) -> Option<&Self::Error>;

    /// For the logbook: why it ended; `None` where it was the user's wish.
    fn why(&self) -> Option<String>;

    /// Operations that were carried out.
    fn done(&self) -> usize;

    /// Write cycles spent, or that may have been.
    fn write_cycles(&self) -> u64;
}

impl<Op, E: OperationError, Done: WriteRecord, Left> Interruption for Interrupted<Op, E, Done, Left> {
    type Error = E::Device;

    fn error(&self) -> Option<&E::Device> {
        self.cause.device()
    }

    fn why(&self) -> Option<String> {
        self.reason()
    }

    fn done(&self) -> usize {
        self.done.ops()
    }

    fn write_cycles(&self) -> u64 {
        self.done.write_cycles()
    }
}

/// Why a job ended early, of a device with errors `E`, errors of planning `P`, writes that are cut off as `I` tells, and
/// changes of kind `K`.
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

impl<E, P, I: Interruption<Error = E>, K> JobError<E, P, I, K> {
    /// What went wrong with the device or on the way to it, whether or not something was written before.
    pub fn device(&self) -> Option<&E> {
        match self {
            JobError::Device(error) => Some(error),
            JobError::Interrupted { interrupted, .. } => interrupted.error(),
            JobError::Plan(_) | JobError::NotBegun(_) => None,
        }
    }

    /// Operations that were carried out; `None` where nothing was begun.
    pub fn done(&self) -> Option<usize> {
        match self {
            JobError::Interrupted { interrupted, .. } => Some(interrupted.done()),
            JobError::Device(_) | JobError::Plan(_) | JobError::NotBegun(_) => None,
        }
    }
}
