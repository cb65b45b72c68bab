//! The schedule of requests to a polled device. At most one watched value is requested between two samples. The
//! schedule does not use a clock.

use std::time::{Duration, Instant};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DueRequest<W> {
    Sample,
    Watch(W),
}

/// A schedule of repeated requests, each with its own interval.
pub(super) struct PollScheduler<W> {
    sample: PollTiming,
    watches: Vec<WatchSchedule<W>>,
    /// Whether the last request was a sample. A watched value may follow only a sample.
    sample_was_last: bool,
}

struct WatchSchedule<W> {
    value: W,
    interval: Duration,
    timing: PollTiming,
}

impl<W> Default for PollScheduler<W> {
    fn default() -> Self {
        PollScheduler { sample: PollTiming::default(), watches: Vec::new(), sample_was_last: false }
    }
}

impl<W: Clone + PartialEq> PollScheduler<W> {
    /// Sets the values to watch. Values that are already watched keep their timing.
    pub(super) fn set_watched(&mut self, watched: Vec<(W, Duration)>) {
        let mut before = std::mem::take(&mut self.watches);
        for (what, interval) in watched {
            let timing =
                before.iter_mut().find(|watch| watch.value == what).map(|watch| std::mem::take(&mut watch.timing));
            self.watches.push(WatchSchedule { value: what, interval, timing: timing.unwrap_or_default() });
        }
    }

    /// Returns the request that is due first, and its time. If a sample and a watched value are due at the same time,
    /// the sample comes first. Watching pauses while sampling is off. New requests are due immediately.
    pub(super) fn next(&mut self, polling: Option<Duration>, now: Instant) -> Option<(Instant, DueRequest<W>)> {
        let sample = self.sample.next_due(polling, now);
        let mut next: Option<(Instant, DueRequest<W>)> = None;
        for WatchSchedule { value: what, interval, timing } in &mut self.watches {
            let due = timing.next_due(polling.and(Some(*interval)), now);
            if let Some(due) = due
                && self.sample_was_last
                && next.as_ref().is_none_or(|(earliest, _)| due < *earliest)
            {
                next = Some((due, DueRequest::Watch(what.clone())));
            }
        }
        let sample = sample?;
        next.filter(|(due, _)| *due < sample).or(Some((sample, DueRequest::Sample)))
    }

    /// Records that the request was made and answered at `now`.
    pub(super) fn mark_completed(&mut self, due: &DueRequest<W>, now: Instant) {
        self.sample_was_last = *due == DueRequest::Sample;
        match due {
            DueRequest::Sample => self.sample.mark_completed(now),
            DueRequest::Watch(what) => {
                if let Some(watch) = self.watches.iter_mut().find(|watch| watch.value == *what) {
                    watch.timing.mark_completed(now);
                }
            }
        }
    }
}

/// The timing of a request whose starts are equally spaced. Starts missed because of a late request are skipped.
#[derive(Default)]
struct PollTiming {
    interval: Option<Duration>,
    next: Option<Instant>,
}

impl PollTiming {
    /// Returns the time of the next request. A new request is due immediately.
    fn next_due(&mut self, interval: Option<Duration>, now: Instant) -> Option<Instant> {
        if interval != self.interval {
            self.interval = interval;
            self.next = interval.map(|_| now);
        }
        self.next
    }

    fn mark_completed(&mut self, now: Instant) {
        self.next = match (self.next, self.interval) {
            (Some(due), Some(interval)) => Some((due + interval).max(now)),
            _ => None,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ms(count: u64) -> Duration {
        Duration::from_millis(count)
    }

    #[test]
    fn late_sample_causes_no_burst() {
        let (step, start) = (ms(100), Instant::now());
        let mut timing = PollTiming::default();
        assert_eq!(timing.next_due(None, start), None);
        assert_eq!(timing.next_due(Some(step), start), Some(start));
        timing.mark_completed(start + ms(25));
        assert_eq!(timing.next_due(Some(step), start + ms(25)), Some(start + ms(100)), "from start to start");
        timing.mark_completed(start + ms(500));
        assert_eq!(timing.next_due(Some(step), start + ms(500)), Some(start + ms(500)), "at once, once");
        timing.mark_completed(start + ms(525));
        assert_eq!(timing.next_due(Some(step), start + ms(525)), Some(start + ms(600)));
        assert_eq!(timing.next_due(None, start + ms(530)), None);
        timing.mark_completed(start + ms(530));
        assert_eq!(timing.next_due(None, start + ms(530)), None);
    }

    /// Returns the requests made until `end` with their start times in milliseconds. Each request takes 25 ms.
    fn course(polling: u64, watches: &[(char, u64)], end: u64) -> String {
        let start = Instant::now();
        let mut agenda = PollScheduler::default();
        agenda.set_watched(watches.iter().map(|(what, interval)| (*what, ms(*interval))).collect());
        let (mut now, mut said) = (0, Vec::new());
        loop {
            let (at, due) = agenda.next(Some(ms(polling)), start + ms(now)).unwrap();
            now = now.max(u64::try_from((at - start).as_millis()).unwrap());
            if now > end {
                return said.join(" ");
            }
            let name = if let DueRequest::Watch(what) = due { what } else { '.' };
            said.push(format!("{name}{now}"));
            now += 25;
            agenda.mark_completed(&due, start + ms(now));
        }
    }

    #[test]
    fn reads_watched_values_between_samples() {
        for (polling, watches, end, expected) in [
            (100, vec![], 250, ".0 .100 .200"),
            (100, vec![('a', 200)], 450, ".0 a25 .100 .200 a225 .300 .400 a425"),
            (100, vec![('a', 150)], 500, ".0 a25 .100 a150 .200 .300 a325 .400 a450 .500"),
            // Back to back, but never two watched values in a row.
            (0, vec![('a', 0)], 125, ".0 a25 .50 a75 .100 a125"),
            (0, vec![('a', 0), ('b', 0)], 175, ".0 a25 .50 b75 .100 a125 .150 b175"),
            (0, vec![('a', 200)], 275, ".0 a25 .50 .75 .100 .125 .150 .175 .200 a225 .250 .275"),
            // With rare samples, there are no more watched values than samples.
            (1000, vec![('a', 10)], 2100, ".0 a25 .1000 a1025 .2000 a2025"),
        ] {
            assert_eq!(course(polling, &watches, end), expected, "{polling} {watches:?}");
        }
    }

    #[test]
    fn watching_pauses_with_polling() {
        let start = Instant::now();
        let mut agenda = PollScheduler::default();
        agenda.set_watched(vec![('a', ms(200))]);
        assert_eq!(agenda.next(None, start), None);
        assert_eq!(agenda.next(Some(ms(100)), start + ms(10)), Some((start + ms(10), DueRequest::Sample)));
        agenda.mark_completed(&DueRequest::Sample, start + ms(20));
        assert_eq!(agenda.next(Some(ms(100)), start + ms(20)), Some((start + ms(10), DueRequest::Watch('a'))));
        agenda.mark_completed(&DueRequest::Watch('a'), start + ms(30));
        agenda.mark_completed(&DueRequest::Sample, start + ms(120));
        agenda.set_watched(vec![('b', ms(50)), ('a', ms(200))]);
        assert_eq!(
            agenda.next(Some(ms(100)), start + ms(120)),
            Some((start + ms(120), DueRequest::Watch('b'))),
            "b begins"
        );
        agenda.mark_completed(&DueRequest::Watch('b'), start + ms(130));
        agenda.set_watched(vec![('a', ms(200))]);
        assert_eq!(
            agenda.next(Some(ms(100)), start + ms(130)),
            Some((start + ms(210), DueRequest::Sample)),
            "110 + 100"
        );
        agenda.mark_completed(&DueRequest::Sample, start + ms(220));
        assert_eq!(
            agenda.next(Some(ms(100)), start + ms(220)),
            Some((start + ms(210), DueRequest::Watch('a'))),
            "10 + 200"
        );
        assert_eq!(agenda.next(None, start + ms(230)), None);
    }
}
