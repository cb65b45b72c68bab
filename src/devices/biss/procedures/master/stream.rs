//! Frames without being asked: while a stream runs, the adapter has no time for anything else, so that whatever comes next
//! ends it first.

use std::sync::Arc;
use std::time::Duration;

use super::Master;
use crate::buses::bridge::procedures::Adapter;
use crate::buses::bridge::procedures::flow::{Flow, Streamed};
use crate::buses::bridge::protocol::Data;
use crate::devices::biss::procedures::frames::{FrameRun, frames};
use crate::devices::biss::procedures::station::Way;
use crate::devices::biss::procedures::{Error, Station};

/// A wish to end is heard so often.
const SLICE: Duration = Duration::from_millis(20);

impl Master<'_> {
    /// The next frames of a stream whose frames are so many microseconds apart, or as close as the adapter can; begins it
    /// where it does not run. `None` over the configuration pin, which has no streams.
    ///
    /// # Errors
    /// As for a [`position`](Self::position) when it begins; then the adapter's, or the user's wish, with which the stream
    /// goes on.
    pub fn frames(&mut self, period_us: u32) -> Result<Option<FrameRun>, Error> {
        if self.station.way != Way::Adapter {
            return Ok(None);
        }
        let streamed = Streamed::Biss { period_us };
        if self.station.flow.as_ref().is_none_or(|flow| flow.streamed() != streamed) {
            // It also tells whether the wires and the widths are right.
            self.position()?;
            let after = self.station.streamed_until;
            self.station.flow = Some(Flow::begin(&mut self.adapter(), streamed, after)?);
        }
        loop {
            let until = self.now() + SLICE;
            let Station { line: state, adapter, flow, .. } = &mut *self.station;
            let Some(flow) = flow else { return Ok(None) };
            let mut host = Adapter { line: &mut self.line, state, adapter };
            let portion = match flow.next(&mut host, until) {
                Ok(portion) => portion,
                Err(failure) => return Err(self.stream_failed(failure.into())),
            };
            if let Some(portion) = portion
                && let Data::Biss(data) = &portion.data
            {
                let layout = Arc::new(self.station.frame());
                let clock_hz = self.station.actual_clock_hz.unwrap_or(self.station.clock_hz);
                let frames = frames(&layout, data);
                let layout = (layout, self.station.is_split_known());
                return Ok(Some(FrameRun::new(&portion, frames, layout, clock_hz, period_us)));
            }
        }
    }

    /// Ends the stream that runs, also where an end is wished.
    ///
    /// # Errors
    /// The adapter's; then it is tried again before whatever comes next.
    pub fn end_frames(&mut self) -> Result<(), Error> {
        let Some(flow) = self.station.flow.take() else { return Ok(()) };
        self.station.streamed_until = flow.last().or(self.station.streamed_until);
        match Flow::ended(self.shielded(|master| flow.end(&mut master.adapter()))) {
            Ok(true) => Ok(()),
            Ok(false) => {
                self.station.forget_settings();
                Ok(())
            }
            Err(failure) => {
                self.station.flow = Some(flow);
                Err(failure.into())
            }
        }
    }

    /// A stream that failed is over, at the adapter too where that can be told.
    fn stream_failed(&mut self, error: Error) -> Error {
        if !matches!(error, Error::Cancelled) && self.end_frames().is_err() {
            // Restarting sends HELLO, which ends all streams.
            self.station.forget_adapter();
        }
        error
    }
}
