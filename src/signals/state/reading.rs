//! Reading of captures in a task, with progress and cancellation, and the example captures.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use super::{DiagnosisSettings, Measurement, Origin, ReadCapture, Scope, Table, TableSource};
use crate::analysis::capture::{Capture, CaptureError, HEAD_BYTES, TableHints, TableImport};
use crate::store::{ReadCaptureError, capture_head, read_capture};

/// An example capture that ships with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExampleCapture {
    Healthy,
    /// Capture with offsets, unequal amplitudes and a phase error.
    WithErrors,
}

impl ExampleCapture {
    pub const ALL: [ExampleCapture; 2] = [ExampleCapture::Healthy, ExampleCapture::WithErrors];

    pub fn keyword(self) -> &'static str {
        match self {
            ExampleCapture::Healthy => "signals.example_healthy",
            ExampleCapture::WithErrors => "signals.example_errors",
        }
    }

    pub(super) fn file_name(self) -> &'static str {
        match self {
            ExampleCapture::Healthy => "healthy.csv",
            ExampleCapture::WithErrors => "offset-gain-phase.csv",
        }
    }

    fn bytes(self) -> &'static [u8] {
        match self {
            ExampleCapture::Healthy => include_bytes!("../../../profiles/signals/healthy.csv"),
            ExampleCapture::WithErrors => include_bytes!("../../../profiles/signals/offset-gain-phase.csv"),
        }
    }
}

#[derive(Debug)]
pub struct CaptureReading {
    pub(super) number: u32,
    pub place: TableSource,
    /// Table to restore if the reading is cancelled.
    pub(super) settled: Option<Table>,
    progress: Arc<ReadingProgress>,
}

/// Progress of a capture being read, shared between the task and the window.
#[derive(Debug, Default)]
pub(super) struct ReadingProgress {
    done: AtomicU64,
    total: AtomicU64,
    cancel: AtomicBool,
}

impl CaptureReading {
    pub(super) fn new(number: u32, place: TableSource, settled: Option<Table>) -> (Self, Arc<ReadingProgress>) {
        let progress = Arc::<ReadingProgress>::default();
        (CaptureReading { number, place, settled, progress: progress.clone() }, progress)
    }

    /// Returns the fraction that has been read, from 0 to 1, or `None` if the total is unknown.
    pub fn fraction_read(&self) -> Option<f64> {
        let (done, total) = (self.progress.done.load(Ordering::Relaxed), self.progress.total.load(Ordering::Relaxed));
        (total > 0).then(|| (done as f64 / total as f64).min(1.0))
    }

    pub fn is_cancelled(&self) -> bool {
        self.progress.cancel.load(Ordering::Relaxed)
    }

    pub(super) fn cancel(&self) {
        self.progress.cancel.store(true, Ordering::Relaxed);
    }
}

impl Drop for CaptureReading {
    fn drop(&mut self) {
        self.cancel();
    }
}

/// Reads and analyses a capture. This may take a long time for a large file.
pub(super) fn read(
    place: TableSource,
    hints: TableHints,
    diagnosis_settings: DiagnosisSettings,
    progress: &ReadingProgress,
) -> ReadCapture {
    let (head, result) = match &place {
        TableSource::Example(example) => {
            let bytes = example.bytes();
            (bytes.get(..HEAD_BYTES.min(bytes.len())).unwrap_or_default().to_vec(), import_capture(bytes, &hints))
        }
        TableSource::File(path) => match capture_head(path) {
            Ok(head) => (head, read_file(path, &hints, progress)),
            Err(error) => (Vec::new(), Err(error.into())),
        },
    };
    let table = Table::from_head(place, &head, hints);
    let result = result.map(|capture| {
        let scope = Scope::from_capture(&capture);
        (Measurement::from_capture(Origin::Table(table.place.clone()), Arc::new(capture), diagnosis_settings), scope)
    });
    ReadCapture { table, result }
}

fn read_file(path: &Path, hints: &TableHints, progress: &ReadingProgress) -> Result<Capture, ReadCaptureError> {
    let mut tell = |done, total| {
        progress.done.store(done, Ordering::Relaxed);
        progress.total.store(total, Ordering::Relaxed);
    };
    read_capture(path, hints, &progress.cancel, &mut tell).map(|(_, capture)| capture)
}

fn import_capture(bytes: &[u8], hints: &TableHints) -> Result<Capture, ReadCaptureError> {
    let read = || -> Result<Capture, CaptureError> {
        let mut import = TableImport::from_head(bytes.get(..HEAD_BYTES.min(bytes.len())).unwrap_or_default(), hints)?;
        import.process(bytes)?;
        Ok(import.finish()?.1)
    };
    Ok(read()?)
}
