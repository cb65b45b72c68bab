//! The samples of one adapter stream, in order and in local time. Each batch starts with the number of samples missing
//! before it. See reference "bridge" 3, and `drift` for the time.

use std::time::Duration;

use super::drift::ClockDrift;
use super::{Adapter, AdapterError, Failure};
use crate::analysis::SampleTime;
use crate::buses::bridge::protocol::{Continuity, Message, Packet, PacketGap, Reply, Request, StreamData};
use crate::link::line::LineError;
use crate::units::Moment;

/// The stream to start. Its clock or sampling must already be configured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StreamKind {
    /// SSI words at an interval in microseconds.
    Ssi { period_us: u32 },
    /// BiSS frames at an interval in microseconds.
    Biss { period_us: u32 },
    /// Sine and cosine at an interval in nanoseconds.
    Analog { period_ns: i64 },
}

/// Consecutive samples of a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// Index of the first sample, counted from the start of the stream. Missing samples are included in the count.
    pub first: u64,
    /// Local time of the first sample.
    pub time: SampleTime,
    pub period_ns: i64,
    /// Number of samples missing before the first sample.
    pub lost: u64,
    /// The samples. There is at least one.
    pub data: StreamData,
}

#[derive(Clone, Debug)]
pub(crate) struct SampleStream {
    streamed: StreamKind,
    period_ns: i64,
    continuity: Continuity,
    next: u64,
    /// Number of samples that are missing before the next sample.
    missing: u64,
    /// Earliest time that a sample can have.
    not_before: SampleTime,
    last_received_at: Moment,
    last: Option<SampleTime>,
    drift: ClockDrift,
}

/// Silence after which a stream is considered to have ended. Slow streams are given more time.
const SILENCE_TIMEOUT: Duration = Duration::from_secs(2);
const SILENT_SAMPLES: u32 = 256;

impl StreamKind {
    fn start(self) -> Request {
        match self {
            StreamKind::Ssi { period_us } => Request::SsiStream { period_us },
            StreamKind::Biss { period_us } => Request::BissStream { period_us },
            StreamKind::Analog { .. } => Request::AnalogStream { on: true },
        }
    }

    fn stop(self) -> Request {
        match self {
            StreamKind::Ssi { .. } => Request::SsiStream { period_us: 0 },
            StreamKind::Biss { .. } => Request::BissStream { period_us: 0 },
            StreamKind::Analog { .. } => Request::AnalogStream { on: false },
        }
    }

    const fn matches_stream(self, data: &StreamData) -> bool {
        matches!(
            (self, data),
            (StreamKind::Ssi { .. }, StreamData::Ssi(_))
                | (StreamKind::Biss { .. }, StreamData::Biss(_))
                | (StreamKind::Analog { .. }, StreamData::Analog(_))
        )
    }
}

impl SampleStream {
    /// Starts a stream. All of its samples are later than `after`.
    ///
    /// # Errors
    /// Returns a [`Failure`] if the stream cannot be started. If the adapter rejects the request as busy, the stream is
    /// already running.
    pub(crate) fn start(
        adapter: &mut Adapter<'_, '_>,
        streamed: StreamKind,
        after: Option<SampleTime>,
    ) -> Result<Self, Failure> {
        let request = streamed.start();
        let begun_at = SampleTime::from(adapter.line.now());
        let answered = match adapter.request_once(&request)? {
            Some(answered) => answered,
            // The stream may be running although the reply is lost. A second request would then be rejected as busy.
            None => {
                adapter.send_request(&streamed.stop())?;
                adapter.send_request(&request)?
            }
        };
        let period_ns = match (streamed, &answered.reply) {
            (StreamKind::Ssi { .. }, Reply::SsiStream { period_us })
            | (StreamKind::Biss { .. }, Reply::BissStream { period_us }) => i64::from(*period_us) * 1000,
            (StreamKind::Analog { period_ns }, Reply::AnalogStream { on: true }) => period_ns,
            _ => return Err(AdapterError::unexpected_reply(request.operation(), &answered.reply).into()),
        };
        Ok(SampleStream {
            streamed,
            period_ns: period_ns.max(1),
            continuity: Continuity::at_start(),
            next: 0,
            missing: 0,
            not_before: after.map_or(begun_at, |after| begun_at.max(after.saturating_add_ns(1))),
            last_received_at: adapter.line.now(),
            last: None,
            drift: ClockDrift::default(),
        })
    }

    pub(crate) const fn stream_kind(&self) -> StreamKind {
        self.streamed
    }

    pub(crate) const fn last(&self) -> Option<SampleTime> {
        self.last
    }

    pub(crate) const fn period_ns(&self) -> i64 {
        self.period_ns
    }

    /// Returns the next samples, or `None` if none have arrived by `until`.
    ///
    /// # Errors
    /// Returns [`AdapterError::StreamSilent`], [`AdapterError::Restarted`] or [`AdapterError::Data`] if the stream has
    /// ended, or another error if the job is cancelled or the connection fails.
    pub(crate) fn next(&mut self, adapter: &mut Adapter<'_, '_>, until: Moment) -> Result<Option<Chunk>, Failure> {
        let mut bytes = Vec::new();
        loop {
            adapter.line.check_cancel()?;
            let broken = adapter.adapter.receiver.dropped_count();
            let packet = adapter.adapter.receiver.next_packet();
            adapter.state.damaged += adapter.adapter.receiver.dropped_count() - broken;
            let now = adapter.line.now();
            if let Some(packet) = packet {
                if let Some(portion) = self.decode_samples(&packet, now)? {
                    return Ok(Some(portion));
                }
                continue;
            }
            // The line is read at least once before an error, since this computer may have been asleep.
            bytes.clear();
            adapter.line.receive(until.max(now), &mut bytes).map_err(LineError::Link)?;
            if !bytes.is_empty() {
                adapter.adapter.receiver.push(&bytes);
            } else if adapter.line.now().duration_since(self.last_received_at) > self.max_wait() {
                return Err(AdapterError::StreamSilent.into());
            } else if adapter.line.now() >= until {
                return Ok(None);
            }
        }
    }

    /// Ends the stream. Samples still in transit are dropped.
    ///
    /// # Errors
    /// Returns an error if the adapter does not confirm the end of the stream.
    pub(crate) fn stop(&self, adapter: &mut Adapter<'_, '_>) -> Result<(), Failure> {
        adapter.send_request(&self.streamed.stop()).map(drop)
    }

    /// Evaluates the result of [`stop`](Self::stop). Returns `false` if the adapter rejects the request, which means
    /// that it was reset and must be configured again. Other errors are returned, and the caller must retry.
    pub(crate) fn is_stopped(ended: Result<(), Failure>) -> Result<bool, Failure> {
        match ended {
            Ok(()) => Ok(true),
            Err(Failure::Adapter(AdapterError::Refused { .. })) => Ok(false),
            Err(failure) => Err(failure),
        }
    }

    fn max_wait(&self) -> Duration {
        let period = Duration::from_nanos(self.period_ns.unsigned_abs());
        SILENCE_TIMEOUT + period.saturating_mul(SILENT_SAMPLES)
    }

    /// Returns the samples of a packet, or `None` if the packet contains no samples of this stream.
    fn decode_samples(&mut self, packet: &Packet, now: Moment) -> Result<Option<Chunk>, AdapterError> {
        let data = match Message::parse(packet) {
            Ok(Message::Data(data)) if self.streamed.matches_stream(&data) => data,
            // The packet is a late reply or the end of an earlier stream.
            Ok(_) => return Ok(None),
            Err(cause) => return Err(AdapterError::Data { cause }),
        };
        self.last_received_at = now;
        match self.continuity.gap_before(&data) {
            PacketGap::None => {}
            PacketGap::Missing(count) => self.missing += u64::from(count),
            PacketGap::Backwards => return Err(AdapterError::Restarted),
        }
        let (_, count, _) = data.sample_range();
        if count == 0 {
            return Ok(None);
        }
        let lost = std::mem::take(&mut self.missing);
        let first = self.next + lost;
        // The number of samples is at most 255.
        self.next = first + count as u64;
        let time = self.time(&data, count, now);
        Ok(Some(Chunk { first, time, period_ns: self.period_ns, lost, data }))
    }

    /// Returns the local time of the first sample. All samples lie between the start of the stream and the arrival of
    /// the packet.
    fn time(&mut self, data: &StreamData, count: usize, now: Moment) -> SampleTime {
        let t0_us = match data {
            StreamData::Ssi(data) => data.t0_us,
            StreamData::Biss(data) => data.t0_us,
            StreamData::Analog(data) => data.t0_us,
        };
        // The time since the start of the adapter may exceed the range of nanoseconds.
        let own = i128::from(t0_us) * 1000;
        let lasts = self.period_ns.saturating_mul(i64::try_from(count).unwrap_or(i64::MAX) - 1);
        let latest = SampleTime::from(now).saturating_add_ns(lasts.saturating_neg()).max(self.not_before);
        let estimate = self.drift.time(own, latest);
        // The time never runs backwards, even if that of the adapter does.
        let time = self.last.map_or(estimate, |last| estimate.max(last.saturating_add_ns(1)));
        self.last = Some(time.saturating_add_ns(lasts));
        time
    }
}
