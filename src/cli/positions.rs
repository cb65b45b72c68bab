//! Repeated readings for the `position` command of all device kinds, with a count and an interval.

use std::time::{Duration, Instant};

use super::args::Position;
use super::runner::{CliDevice, JobFailure, Runner};
use super::{Result, Success};
use crate::worker::JobInterruption as _;

/// Runs `job` repeatedly and prints each result with `show`. The loop ends when a job fails.
pub fn print_readings<D: CliDevice>(
    runner: &mut Runner<D>,
    position: &Position,
    job: impl Fn() -> D::Job,
    mut show: impl FnMut(D::Output) -> Result<()>,
) -> Result {
    try_readings(runner, position, job, |_, came| {
        show(came.map_err(|error| JobFailure::<D>::Job(error).into_failure())?).map(|()| true)
    })
}

/// Runs `job` repeatedly and passes each result or error to `show`, which returns whether it has printed a line. Only
/// printed lines count.
pub fn try_readings<D: CliDevice>(
    runner: &mut Runner<D>,
    position: &Position,
    job: impl Fn() -> D::Job,
    mut show: impl FnMut(&mut Runner<D>, std::result::Result<D::Output, Box<D::Error>>) -> Result<bool>,
) -> Result {
    let interval = Duration::from_millis(position.interval);
    let mut next = Instant::now();
    // Ctrl-C is the normal end of a table without a fixed length, not a failure.
    let endless = position.csv && position.count.is_none();
    let count = position.count.unwrap_or(if endless { u64::MAX } else { 1 });
    let (mut lines, mut first) = (0, true);
    while lines < count {
        if !first {
            next = (next + interval).max(Instant::now());
            let paused = runner.pause(next.saturating_duration_since(Instant::now()));
            if endless && runner.is_interrupted() {
                return Ok(Success::Completed);
            }
            paused?;
        }
        first = false;
        let came = match runner.try_run(job()) {
            Ok(output) => Ok(output),
            Err(JobFailure::Job(error)) if endless && error.is_cancelled() => return Ok(Success::Completed),
            Err(JobFailure::Job(error)) => Err(error),
            Err(ended) => return Err(ended.into_failure()),
        };
        lines += match show(runner, came) {
            Err(_) if endless && runner.is_interrupted() => return Ok(Success::Completed),
            shown => u64::from(shown?),
        };
    }
    Ok(Success::Completed)
}
