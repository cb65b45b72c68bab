//! Streams of frames. During a stream, the adapter does not process other requests, so any other request ends the
//! stream first.

use std::sync::Arc;
use std::time::Duration;

use super::Master;
use crate::buses::bridge::procedures::Adapter;
use crate::buses::bridge::procedures::flow::{SampleStream, StreamKind};
use crate::buses::bridge::protocol::StreamData;
use crate::devices::biss::procedures::frames::{ConsecutiveFrames, parse_frames};
use crate::devices::biss::procedures::station::Transport;
use crate::devices::biss::procedures::{Error, Station};

/// Interval at which cancellation is checked.
const CANCEL_CHECK_INTERVAL: Duration = Duration::from_millis(20);

impl Master<'_> {
    /// Returns the next frames of a stream, and starts the stream if necessary. The interval is `period_us`
    /// microseconds, or the shortest interval that the adapter supports. Returns `None` over the configuration pin,
    /// which does not support streams.
    ///
    /// # Errors
    /// Starting a stream returns the same errors as [`position`](Self::position). A running stream returns an error if
    /// the adapter fails or the job is cancelled. The stream continues after a cancellation.
    pub fn next_frames(&mut self, period_us: u32) -> Result<Option<ConsecutiveFrames>, Error> {
        if self.station.transport != Transport::Adapter {
            return Ok(None);
        }
        let streamed = StreamKind::Biss { period_us };
        if self.station.flow.as_ref().is_none_or(|flow| flow.stream_kind() != streamed) {
            // Reading the position also checks the wiring and the widths.
            self.position()?;
            let after = self.station.streamed_until;
            self.station.flow = Some(SampleStream::start(&mut self.adapter_host(), streamed, after)?);
        }
        loop {
            let until = self.now() + CANCEL_CHECK_INTERVAL;
            let Station { line: state, adapter, flow, .. } = &mut *self.station;
            let Some(flow) = flow else { return Ok(None) };
            let mut host = Adapter { line: &mut self.line, state, adapter };
            let portion = match flow.next(&mut host, until) {
                Ok(portion) => portion,
                Err(failure) => return Err(self.stream_failed(failure.into())),
            };
            if let Some(portion) = portion
                && let StreamData::Biss(data) = &portion.data
            {
                let layout = Arc::new(self.station.frame_layout());
                let clock_hz = self.station.actual_clock_hz.unwrap_or(self.station.clock_hz);
                let frames = parse_frames(&layout, data);
                let layout = (layout, self.station.is_split_known());
                return Ok(Some(ConsecutiveFrames::new(&portion, frames, layout, clock_hz, period_us)));
            }
        }
    }

    /// Ends a running stream, even after a cancellation.
    ///
    /// # Errors
    /// Returns an error if the adapter fails. In this case, the stream is ended before the next request.
    pub fn stop_frame_stream(&mut self) -> Result<(), Error> {
        let Some(flow) = self.station.flow.take() else { return Ok(()) };
        self.station.streamed_until = flow.last().or(self.station.streamed_until);
        match SampleStream::is_stopped(self.run_uncancellable(|master| flow.stop(&mut master.adapter_host()))) {
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

    /// Handles the failure of a stream, and ends the stream in the adapter if possible.
    fn stream_failed(&mut self, error: Error) -> Error {
        if !matches!(error, Error::Cancelled) && self.stop_frame_stream().is_err() {
            // Identifying the adapter again sends HELLO, which ends all streams.
            self.station.forget_adapter();
        }
        error
    }
}
