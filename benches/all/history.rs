//! Measures the cost of storing hours of samples and of drawing them. Appending is compared with a pyramid of plain
//! vectors, and drawing with a scan of all samples. Also measures memory, and runs a soak test in virtual time. Prints
//! figures without a verdict.
//!
//! `cargo bench -- history`

use std::hint::black_box;
use std::time::{Duration, Instant};

use encoder_studio::analysis::history::{ColumnPart, Flags, Grid, History, Kind, RenderedHistory};
use encoder_studio::analysis::{PositionUnwrapper, SampleTime};

const SAMPLES: usize = 10_000_000;
const SIGNALS: usize = 4;
const PIXELS: usize = 1000;
const PERIOD: i64 = 1_000_000;
const ROUNDS: usize = 7;

pub(crate) fn run(parts: &[String]) {
    let is_wanted = |part: &str| parts.is_empty() || parts.iter().any(|wanted| wanted == part);
    if is_wanted("append") {
        [100, 1_000, 10_000].into_iter().for_each(append);
    }
    if is_wanted("pictures") {
        for (label, kind, flagged) in [
            ("real", Kind::Real, false),
            ("whole", Kind::Whole, false),
            ("real, flags in every block", Kind::Real, true),
        ] {
            let history = filled(kind, SIGNALS, flagged);
            println!("{SIGNALS} × 10 M samples, {label}:");
            measure_frame_times(&history);
            statistics(&history);
            memory(&history, SIGNALS);
        }
        println!("1 × 10 M samples, real, flags in every block:");
        memory(&filled(Kind::Real, 1, true), 1);
    }
    if is_wanted("soak") {
        measure_long_recording("24 h of 1 kHz position", 86_400_000, PERIOD, 1, Kind::Whole);
        measure_long_recording("1 h of 100 kHz sine and cosine", 360_000_000, PERIOD / 100, 2, Kind::Real);
    }
}

/// The naive alternative: vectors without flags that grow by one sample at a time.
#[derive(Default)]
struct Naive {
    times: Vec<i64>,
    columns: Vec<NaiveColumn>,
}

#[derive(Default)]
struct NaiveColumn {
    values: Vec<f64>,
    levels: Vec<Vec<[f32; 2]>>,
}

impl Naive {
    fn append(&mut self, times: &[SampleTime], columns: &[Vec<f64>]) {
        self.times.extend(times.iter().map(|time| time.as_nanoseconds()));
        self.columns.resize_with(columns.len(), Default::default);
        for (NaiveColumn { values, levels }, new) in self.columns.iter_mut().zip(columns) {
            for value in new {
                values.push(*value);
                let mut length = values.len();
                let mut level = 0;
                while length % 8 == 0 {
                    length /= 8;
                    if levels.len() == level {
                        levels.push(Vec::new());
                    }
                    let mut bucket = [f32::INFINITY, f32::NEG_INFINITY];
                    if level == 0 {
                        for value in &values[values.len() - 8..] {
                            bucket = [bucket[0].min(*value as f32), bucket[1].max(*value as f32)];
                        }
                    } else {
                        let lower = &levels[level - 1];
                        for other in &lower[lower.len() - 8..] {
                            bucket = [bucket[0].min(other[0]), bucket[1].max(other[1])];
                        }
                    }
                    levels[level].push(bucket);
                    level += 1;
                }
            }
        }
    }
}

/// Measures how fast both alternatives append samples, and how fast the same bytes are copied to new memory, which is
/// the lower limit. The worst stall is that of the batch that is slow in every round, so other activity of the computer
/// does not count.
fn append(batch: usize) {
    let samples = 4_000_000;
    let batches = samples / batch;
    let columns: Vec<Vec<f64>> = (0..SIGNALS).map(|signal| generate_signal(signal, batch)).collect();
    let mut totals = [Vec::new(), Vec::new()];
    let mut least = [vec![Duration::MAX; batches], vec![Duration::MAX; batches]];
    for _ in 0..ROUNDS {
        let mut naive = Naive::default();
        let mut history = History::new(&[Kind::Real; SIGNALS], samples);
        for which in 0..2 {
            let mut total = Duration::ZERO;
            for (number, least) in least[which].iter_mut().enumerate() {
                let times: Vec<SampleTime> = times(number * batch, batch);
                let parts: Vec<ColumnPart<'_>> = columns.iter().map(|values| ColumnPart::from_reals(values)).collect();
                let began = Instant::now();
                if which == 0 {
                    naive.append(&times, &columns);
                } else {
                    history.append(&times, &parts).unwrap();
                }
                let took = began.elapsed();
                *least = took.min(*least);
                total += took;
            }
            totals[which].push(total);
        }
        black_box((&naive, &history));
    }
    let each = |total: Duration| total.as_secs_f64() * 1e9 / (samples * SIGNALS) as f64;
    let [naive, ours] = totals.map(|mut totals| each(median(&mut totals)));
    let [naive_worst, worst] = least.map(|least| micros(least.into_iter().max().unwrap()));
    println!("append {SIGNALS} columns in batches of {batch}, median of {ROUNDS}, a value:");
    println!("  plain vectors {naive:6.2} ns, worst stall {naive_worst:8.1} µs");
    println!("  history       {ours:6.2} ns, worst stall {worst:8.1} µs, {:.2} × the time", ours / naive);
    let (copy, copy_worst) = measure_copies(&times(0, batch), &columns, batches);
    println!("  a bare copy   {:6.2} ns, worst stall {:8.1} µs", each(copy), micros(copy_worst));
}

/// Returns the total time of all batches, the median, and the worst one.
fn measure_copies(times: &[SampleTime], columns: &[Vec<f64>], batches: usize) -> (Duration, Duration) {
    let mut least = vec![Duration::MAX; batches];
    let mut totals: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let mut kept = Vec::with_capacity(batches);
            let mut total = Duration::ZERO;
            for least in &mut least {
                let began = Instant::now();
                kept.push((times.to_vec(), columns.to_vec()));
                let took = began.elapsed();
                *least = took.min(*least);
                total += took;
            }
            black_box(kept);
            total
        })
        .collect();
    (median(&mut totals), least.into_iter().max().unwrap())
}

/// Measures the frame times while the view moves by a tenth of a pixel column per frame.
fn measure_frame_times(history: &History) {
    let all = history.indices();
    let (first, last) = (history.time(all.start).unwrap(), history.time(all.end - 1).unwrap());
    let span = last.nanoseconds_since(first);
    println!("  pictures of {SIGNALS} columns at {PIXELS} pixel columns, median (least) of 101:");
    let zooms = [("all", 1), ("a tenth", 10), ("a hundredth", 100), ("5000 samples", 2_000), ("1000 samples", 10_000)];
    for (zoom, part) in zooms {
        let from = first.saturating_add_ns(span / 3 - span / 3 / part);
        let step = span / part / PIXELS as i64 / 10;
        let mut picture = RenderedHistory::default();
        let mut took: Vec<Duration> = (0..101)
            .map(|shift| {
                let from = from.saturating_add_ns(shift * step);
                let began = Instant::now();
                let cut = history.divide_into_pixels(&Grid::new(from, from.saturating_add_ns(span / part), PIXELS));
                for column in 0..SIGNALS {
                    history.render_column(column, &cut, &mut picture);
                    black_box(&picture);
                }
                began.elapsed()
            })
            .collect();
        let middle = micros(median(&mut took));
        println!("  {zoom:>14}: {middle:8.1} µs ({:.1})", micros(took[0]));
    }
    let mut took = scan(history);
    println!("  {:>14}: {:8.1} µs", "all, full scan", micros(median(&mut took)));
}

/// Computes the first, minimum, maximum and last value from the raw samples, as a plot without a pyramid must do.
fn scan(history: &History) -> Vec<Duration> {
    let columns: Vec<Vec<f64>> = (0..SIGNALS)
        .map(|column| history.indices().map(|index| history.sample(column, index).unwrap().value.to_f64()).collect())
        .collect();
    (0..5)
        .map(|_| {
            let began = Instant::now();
            for values in &columns {
                for pixel in values.chunks(values.len() / PIXELS) {
                    let least = pixel.iter().fold(f64::INFINITY, |least, value| least.min(*value));
                    let most = pixel.iter().fold(f64::NEG_INFINITY, |most, value| most.max(*value));
                    black_box((pixel.first(), least, most, pixel.last()));
                }
            }
            began.elapsed()
        })
        .collect()
}

fn statistics(history: &History) {
    let all = history.indices();
    let mut took: Vec<Duration> = (0..101)
        .map(|shift| {
            let began = Instant::now();
            black_box(history.statistics(0, all.start + shift..all.end - shift));
            began.elapsed()
        })
        .collect();
    println!("  statistics of 10 M samples: {:.1} µs, median of 101", micros(median(&mut took)));
}

fn memory(history: &History, columns: usize) {
    let raw = (SAMPLES * 8 * (columns + 1)) as f64;
    let ratio = history.memory() as f64 / raw;
    println!("  memory {:.1} MB, {ratio:.3} × the raw columns", history.memory() as f64 / 1e6);
}

/// Appends the samples of a day or an hour with pauses in between. The history keeps at most ten million samples.
fn measure_long_recording(label: &str, samples: usize, period: i64, columns: usize, kind: Kind) {
    const BATCH: usize = 10_000;
    const RANGE: i64 = 4096 * 32_768;
    /// Number of batches between two pauses of one second.
    const PAUSE: usize = 500;
    let began = Instant::now();
    let mut history = History::new(&vec![kind; columns], SAMPLES).with_longest_pause(period * 10);
    let reals: Vec<Vec<f64>> = (0..columns).map(|signal| generate_signal(signal, BATCH)).collect();
    let mut unwrap = PositionUnwrapper::rotary(RANGE).unwrap();
    let (mut most, mut breaks_seen, mut breaks_made, mut wrong) = (0, 0, 0, 0_u64);
    let (mut pauses, mut truth, mut wholes) = (0_i64, 0_i64, Vec::new());
    for number in 0..samples / BATCH {
        let pause = number % PAUSE == PAUSE - 1;
        pauses += i64::from(pause);
        breaks_made += u64::from(pause);
        let time =
            |at: usize| SampleTime::from_nanoseconds((number * BATCH + at) as i64 * period + pauses * 1_000_000_000);
        let times: Vec<SampleTime> = (0..BATCH).map(time).collect();
        if kind == Kind::Whole {
            wholes.clear();
            wholes.extend((0..BATCH).map(|_| {
                truth += 1_638_400 / 7;
                let next = unwrap.next(truth.rem_euclid(RANGE)).unwrap();
                wrong += u64::from(next.broken || next.steps != truth);
                next.steps
            }));
        }
        let part = |column: usize| match kind {
            Kind::Real => ColumnPart::from_reals(&reals[column]),
            Kind::Whole => ColumnPart::from_integers(&wholes),
        };
        history.append(&times, &(0..columns).map(part).collect::<Vec<_>>()).unwrap();
        let all = history.indices();
        let start = all.end - BATCH as u64;
        let found = (0..BATCH).step_by(997).all(|at| {
            history.time(start + at as u64) == Some(times[at])
                && history.nearest_index(times[at]) == Some(start + at as u64)
        });
        wrong += u64::from(!found);
        let grid = Grid::new(times[0], times[BATCH - 1].saturating_add_ns(1), 10);
        let mut picture = RenderedHistory::default();
        history.render_column(columns - 1, &history.divide_into_pixels(&grid), &mut picture);
        breaks_seen +=
            u64::from(picture.pixels.iter().any(|pixel| pixel.flags.contains(Flags::BREAK) && !pixel.joined));
        most = most.max(history.memory());
    }
    let all = history.indices();
    let grid = Grid::new(history.time(all.start).unwrap(), history.time(all.end - 1).unwrap(), PIXELS);
    let mut picture = RenderedHistory::default();
    history.render_column(0, &history.divide_into_pixels(&grid), &mut picture);
    let kept = picture.pixels.iter().filter(|pixel| pixel.flags.contains(Flags::BREAK)).count();
    println!("soak, {label}: {:.1} s", began.elapsed().as_secs_f64());
    println!("  at most {:.1} MB, {} samples kept of {}", most as f64 / 1e6, all.end - all.start, all.end);
    println!(
        "  {breaks_seen} of {breaks_made} breaks seen, {wrong} wrong times or positions, {kept} pixels with breaks at the end"
    );
}

fn filled(kind: Kind, columns: usize, flagged: bool) -> History {
    const BATCH: usize = 10_000;
    let mut history = History::new(&vec![kind; columns], SAMPLES);
    let flags: Vec<Flags> = (0..BATCH)
        .map(|at| if flagged && at % 1000 == 77 { [Flags::BAD, Flags::WARNING][at / 1000 % 2] } else { Flags::NONE })
        .collect();
    for number in 0..SAMPLES / BATCH {
        let reals: Vec<Vec<f64>> = (0..columns)
            .map(|signal| {
                let drift = (number as f64 / 97.0).sin();
                generate_signal(signal, BATCH).into_iter().map(|value| value + drift).collect()
            })
            .collect();
        let wholes: Vec<Vec<i64>> =
            reals.iter().map(|values| values.iter().map(|value| (value * 1e6) as i64 + (1 << 40)).collect()).collect();
        let part = |column: usize| match kind {
            Kind::Real => ColumnPart::from_reals(&reals[column]),
            Kind::Whole => ColumnPart::from_integers(&wholes[column]),
        };
        let parts: Vec<ColumnPart<'_>> = (0..columns).map(|column| part(column).with_flags(&flags)).collect();
        history.append(&times(number * BATCH, BATCH), &parts).unwrap();
    }
    history
}

fn times(start: usize, count: usize) -> Vec<SampleTime> {
    // The intervals are slightly uneven, as on a real line.
    (start..start + count)
        .map(|at| SampleTime::from_nanoseconds(at as i64 * PERIOD + (at * 7919 % 50_000) as i64))
        .collect()
}

fn generate_signal(signal: usize, count: usize) -> Vec<f64> {
    let mut noise = fastrand::Rng::with_seed(signal as u64);
    (0..count).map(|at| (at as f64 * 0.01 * (signal + 1) as f64).sin() + noise.f64() * 0.1).collect()
}

fn median(times: &mut [Duration]) -> Duration {
    times.sort_unstable();
    times[times.len() / 2]
}

fn micros(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e6
}
