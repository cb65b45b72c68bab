//! Sampling with an adapter for the `analyse` command.

use std::sync::Arc;
use std::time::Duration;

use crate::analysis::capture::Capture;
use crate::buses::bridge::jobs::{Bridge, SineCosine, open_adapter};
use crate::cli::Failure;
use crate::cli::output::Output;
use crate::cli::runner::{TerminalProgressBar, to_failure};
use crate::kinds::attachable_kinds;
use crate::link::{Clock, LinkUrl, RealClock};
use crate::signals::state::{bridge_error_text, open_error_text};
use crate::worker::stream::{MAX_WAIT, Producer};

/// Samples sine and cosine for the given duration. The encoder's supply is not switched.
pub(super) fn sample(output: &Output, link: &LinkUrl, hz: u32, duration: Duration) -> Result<Capture, Failure> {
    let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
    let opened = open_adapter(link, clock.clone(), attachable_kinds());
    let (margin, open) = opened.map_err(|error| to_failure(&open_error_text(&error)))?;
    let mut bridge = Bridge::new(SineCosine { sample_hz: hz }, None, margin, open);
    let bar = TerminalProgressBar::default();
    let (mut capture, mut lost) = (Capture::default(), 0);
    let result = loop {
        match bridge.next(&*clock, MAX_WAIT) {
            Ok(None) => continue,
            Err(error) => break Err(to_failure(&bridge_error_text(&error))),
            Ok(Some(batch)) => {
                // Times count from the first sample. Lost samples leave a gap.
                lost += batch.lost;
                let period_s = batch.period_ns as f64 * 1e-9;
                let times = (batch.first..).map(|number| number as f64 * period_s);
                capture.time_s.extend(times.take(batch.samples.sine_v.len()));
                capture.sine_v.extend(batch.samples.sine_v);
                capture.cosine_v.extend(batch.samples.cosine_v);
                let whole = (duration.as_secs_f64() / period_s).ceil().max(1.0);
                bar.show(capture.sine_v.len() as u64, whole as u64, &"samples");
                if capture.sine_v.len() as f64 >= whole {
                    break Ok(());
                }
            }
        }
    };
    drop(bar);
    bridge.end(&*clock);
    result?;
    if let Some(streaming) = bridge.streaming_adapter().get() {
        let rate = 1e9 / streaming.period_ns.max(1) as f64;
        output.print_message(&format!("{}: {rate:.0} samples a second", streaming.hello.name));
    }
    if lost > 0 {
        output.print_message(&format!("{lost} samples were lost."));
    }
    Ok(capture)
}
