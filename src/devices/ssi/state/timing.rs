//! Timing diagram of a burst to scale: the lines, the times, and breaks in the time axis where nothing happens. Times
//! are in seconds from the first falling edge. See SICK SSI description 2.2 and reference sections 1 and 5.

#[cfg(test)]
mod tests;

use super::strip::{Field, Strip, cell_text};
use crate::app::Text;
use crate::devices::ssi::protocol::{Layout, ReadConditions, SamplingMoment, Times, Timing};
use crate::devices::ssi::state::TEXTS;

/// Timing diagram from one burst to the start of the next.
#[derive(Clone, Debug, PartialEq)]
pub struct BurstDiagram {
    strip: Strip,
    timing: Timing,
    pieces: Vec<AxisSection>,
    spans: Vec<TimingSpan>,
    marks: Vec<TimingMark>,
}

/// A section of the time axis that is drawn. The axis is broken between two sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSection {
    /// Start of the section in seconds.
    pub from: f64,
    /// End of the section in seconds.
    pub to: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingSpan {
    pub activity: TimingSpanKind,
    /// Start of the span in seconds.
    pub from: f64,
    /// Latest end of the span in seconds.
    pub to: f64,
    /// Earliest end of the span in seconds.
    pub least: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TimingSpanKind {
    Period,
    Burst,
    Pause,
    /// Monoflop time, during which the data line stays low.
    Monoflop,
    LeastPause,
    Making,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingMark {
    pub event: TimingEvent,
    /// Time of the event in seconds.
    pub at: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TimingEvent {
    Latched,
    /// The encoder samples the position that it sends in the next burst.
    Taken,
    Started,
    Ready,
    Next,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bit {
    /// Number of the clock that transmits the bit, starting at 1.
    pub clock: u8,
    /// Start of the bit in seconds.
    pub from: f64,
    /// End of the bit in seconds.
    pub to: f64,
}

/// Minimum time without events that is replaced by a break, in burst durations.
const MIN_BREAK_BURSTS: f64 = 1.5;
/// Time that is drawn on either side of a break, in burst durations.
const BREAK_MARGIN_BURSTS: f64 = 0.4;
/// Number of clocks of the next burst that are drawn.
const NEXT_BURST_CLOCKS: f64 = 2.5;

impl BurstDiagram {
    pub fn new(layout: &Layout, times: &Times, reads: &ReadConditions) -> Self {
        let reads = ReadConditions { clocks: layout.clock_count(), ..*reads };
        let timing = times.calculate_timing(&reads);
        let (period, burst) = (timing.period.as_secs_f64(), timing.burst.as_secs_f64());
        let (pause, cycle) = (reads.pause.as_secs_f64(), timing.cycle.as_secs_f64());
        let (least, most) = timing.monoflop;
        let span = |what, from, to| TimingSpan { activity: what, from, to, least: to };
        let mut spans = vec![
            span(TimingSpanKind::Period, 0.0, period),
            span(TimingSpanKind::Burst, 0.0, burst),
            span(TimingSpanKind::Pause, burst, burst + pause),
            TimingSpan {
                least: burst + least.as_secs_f64(),
                ..span(TimingSpanKind::Monoflop, burst, burst + most.as_secs_f64())
            },
            span(TimingSpanKind::LeastPause, burst, burst + timing.least_pause.as_secs_f64()),
        ];
        let mode = times.synchronous.filter(|_| reads.synchronous);
        let first = if matches!(mode.map(|mode| mode.taken), Some(SamplingMoment::FirstEdge)) {
            TimingEvent::Taken
        } else {
            TimingEvent::Latched
        };
        let mut marks = vec![TimingMark { event: first, at: 0.0 }];
        if let Some(SamplingMoment::Behind { starts, ready }) = mode.map(|mode| mode.taken) {
            let (starts, ready) = (burst + starts * 1e-6, burst + (starts + ready) * 1e-6);
            spans.push(span(TimingSpanKind::Making, starts, ready));
            marks.extend([
                TimingMark { event: TimingEvent::Started, at: starts },
                TimingMark { event: TimingEvent::Ready, at: ready },
            ]);
        }
        marks.push(TimingMark { event: TimingEvent::Next, at: cycle });
        marks.sort_by(|a, b| a.at.total_cmp(&b.at));
        let pieces = axis_sections(burst, cycle + NEXT_BURST_CLOCKS * period, &spans, &marks);
        BurstDiagram { strip: Strip::from_layout(layout), timing, pieces, spans, marks }
    }

    pub const fn strip(&self) -> &Strip {
        &self.strip
    }

    pub fn sections(&self) -> &[AxisSection] {
        &self.pieces
    }

    /// Returns the duration in seconds that is omitted after a section. It is 0 after the last section.
    pub fn gap_after_piece(&self, piece: usize) -> f64 {
        let ends = self.pieces.get(piece).zip(self.pieces.get(piece + 1));
        ends.map_or(0.0, |(own, next)| next.from - own.to)
    }

    pub fn spans(&self) -> &[TimingSpan] {
        &self.spans
    }

    pub fn marks(&self) -> &[TimingMark] {
        &self.marks
    }

    /// Returns the times of the clock edges in seconds. The clock idles high, so the first edge falls.
    pub fn clock_edges(&self) -> Vec<f64> {
        let (half, cycle) = (self.timing.period.as_secs_f64() / 2.0, self.timing.cycle.as_secs_f64());
        let own = (0..2 * u32::from(self.clock_count())).map(|edge| f64::from(edge) * half);
        let next = (0..6).map(|edge| cycle + f64::from(edge) * half).filter(|at| *at < self.end_time());
        own.chain(next).collect()
    }

    /// Returns the bits on the data line. Each bit starts at a rising edge of the clock.
    pub fn bits(&self) -> Vec<Bit> {
        let period = self.timing.period.as_secs_f64();
        let comes = |clock: u8| (f64::from(clock) - 0.5) * period;
        let burst = self.timing.burst.as_secs_f64();
        (1..=self.clock_count())
            .map(|clock| Bit { clock, from: comes(clock), to: comes(clock + 1).min(burst) })
            .collect()
    }

    /// Returns the start and the end of a field on the data line in seconds.
    pub fn field(&self, field: &Field) -> (f64, f64) {
        let period = self.timing.period.as_secs_f64();
        let comes = |clock: u8| (f64::from(clock) - 0.5) * period;
        (comes(field.first), comes(field.last + 1).min(self.timing.burst.as_secs_f64()))
    }

    /// Returns the time in seconds at which the data line goes low after the bits, and the earliest and latest time at
    /// which it returns high. The next burst ends the low level in any case.
    pub fn low_level_times(&self) -> (f64, f64, f64) {
        let (burst, cycle) = (self.timing.burst.as_secs_f64(), self.timing.cycle.as_secs_f64());
        let (least, most) = self.timing.monoflop;
        (burst, (burst + least.as_secs_f64()).min(cycle), (burst + most.as_secs_f64()).min(cycle))
    }

    /// Returns the time at which the bits of the next burst begin, in seconds.
    pub fn next(&self) -> f64 {
        self.timing.cycle.as_secs_f64() + self.timing.period.as_secs_f64() / 2.0
    }

    pub fn end_time(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.to)
    }

    /// Returns texts for a point in time: the time itself, and either the bit being sent or the reason why the lines
    /// are idle.
    pub fn describe_moment(&self, at: f64) -> Vec<Text> {
        let mut texts = vec![TEXTS.text("ssi.timing_at").with_text("time", time(at))];
        if let Some(bit) = self.bits().into_iter().find(|bit| (bit.from..bit.to).contains(&at)) {
            texts.push(cell_text(&self.strip, bit.clock));
        } else {
            let waits = [TimingSpanKind::Monoflop, TimingSpanKind::Making, TimingSpanKind::Pause];
            let is_in = |span: &&TimingSpan| waits.contains(&span.activity) && (span.from..span.to).contains(&at);
            texts.extend(self.spans.iter().filter(is_in).map(|span| self.span_text(span)));
        }
        texts
    }

    pub fn span_text(&self, span: &TimingSpan) -> Text {
        let long = time(span.to - span.from);
        let text = match span.activity {
            TimingSpanKind::Period => TEXTS.text("ssi.timing_period"),
            TimingSpanKind::Burst => TEXTS.text("ssi.timing_burst").with("clocks", self.clock_count()),
            TimingSpanKind::Pause => TEXTS.text("ssi.timing_pause"),
            TimingSpanKind::Monoflop if span.least < span.to => {
                TEXTS.text("ssi.timing_monoflop_between").with_text("least", time(span.least - span.from))
            }
            TimingSpanKind::Monoflop => TEXTS.text("ssi.timing_monoflop"),
            TimingSpanKind::LeastPause => TEXTS.text("ssi.timing_least_pause"),
            TimingSpanKind::Making => TEXTS.text("ssi.timing_making"),
        };
        text.with_text("time", long)
    }

    fn clock_count(&self) -> u8 {
        self.strip.layout().clock_count()
    }
}

impl TimingEvent {
    pub fn to_text(self) -> Text {
        TEXTS.text(match self {
            TimingEvent::Latched => "ssi.timing_latched",
            TimingEvent::Taken => "ssi.timing_taken",
            TimingEvent::Started => "ssi.timing_started",
            TimingEvent::Ready => "ssi.timing_ready",
            TimingEvent::Next => "ssi.timing_next",
        })
    }
}

pub fn skipped_operations(seconds: f64) -> Text {
    TEXTS.text("ssi.timing_break").with_text("time", time(seconds))
}

/// Formats a time in a suitable unit with up to four significant figures.
pub fn time(seconds: f64) -> Text {
    const UNITS: [(&str, f64); 4] =
        [("ssi.time_ns", 1e-9), ("ssi.time_us", 1e-6), ("ssi.time_ms", 1e-3), ("ssi.time_s", 1.0)];
    // A value that would be rounded to 1000 is shown in the next unit.
    let fits = UNITS.into_iter().rfind(|(_, unit)| seconds.abs() >= unit * 0.99995);
    let (id, unit) = fits.unwrap_or(if seconds == 0.0 { ("ssi.time_us", 1e-6) } else { ("ssi.time_ns", 1e-9) });
    let value = seconds / unit;
    let whole = value.abs().max(1.0).log10().floor() as usize;
    let most = 3_usize.saturating_sub(whole);
    let figures = format!("{value:.most$}");
    let decimals = figures.split_once('.').map_or(0, |(_, behind)| behind.trim_end_matches('0').len());
    TEXTS.text(id).with_number("value", value, decimals)
}

/// Formats a frequency in a suitable unit with up to three decimals, such as 2 MHz or 10.811 kHz.
pub fn frequency(hertz: f64) -> Text {
    const UNITS: [(&str, f64); 3] = [("ssi.hertz", 1.0), ("ssi.kilohertz", 1e3), ("ssi.megahertz", 1e6)];
    // A value that would be rounded to 1000 is shown in the next unit.
    let fits = UNITS.into_iter().rfind(|(_, unit)| hertz.abs() >= unit * 0.999_999_5);
    let (id, unit) = fits.unwrap_or(("ssi.hertz", 1.0));
    let value = hertz / unit;
    let figures = format!("{value:.3}");
    let decimals = figures.split_once('.').map_or(0, |(_, behind)| behind.trim_end_matches('0').len());
    TEXTS.text(id).with_number("value", value, decimals)
}

/// Parses a frequency such as 400000, 400 kHz or 1.5 MHz. A decimal comma is accepted as well.
///
/// # Errors
/// Returns an error with the reason if the text is not a frequency.
pub fn read_frequency(text: &str) -> Result<u32, Text> {
    let wrong = || TEXTS.text("ssi_form.frequency").with("text", text.trim());
    let plain: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_lowercase();
    let (number, unit) = match plain.strip_suffix("hz").unwrap_or(&plain) {
        own if own.ends_with('k') => (own.trim_end_matches('k'), 1e3),
        own if own.ends_with('m') => (own.trim_end_matches('m'), 1e6),
        own => (own, 1.0),
    };
    let is_digits = number.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | ','));
    let value: f64 = number.replace(',', ".").parse().ok().filter(|_| is_digits).ok_or_else(wrong)?;
    let hertz = (value * unit).round();
    if (0.0..=f64::from(u32::MAX)).contains(&hertz) { Ok(hertz as u32) } else { Err(wrong()) }
}

/// Returns the sections of the time axis to draw: the complete burst, and the time around each event after it.
fn axis_sections(burst: f64, end: f64, spans: &[TimingSpan], marks: &[TimingMark]) -> Vec<AxisSection> {
    let ends = spans.iter().flat_map(|span| [span.from, span.least, span.to]);
    let mut moments: Vec<f64> = ends.chain(marks.iter().map(|mark| mark.at)).filter(|at| *at > burst).collect();
    let end = moments.iter().copied().fold(end, f64::max);
    moments.push(end);
    moments.sort_by(f64::total_cmp);
    let mut pieces = Vec::new();
    let (mut from, mut last) = (0.0, burst);
    for at in moments {
        if at - last > MIN_BREAK_BURSTS * burst {
            pieces.push(AxisSection { from, to: last + BREAK_MARGIN_BURSTS * burst });
            from = at - BREAK_MARGIN_BURSTS * burst;
        }
        last = at;
    }
    pieces.push(AxisSection { from, to: end });
    pieces
}
