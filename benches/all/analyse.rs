//! Measures the time to fit and analyse a capture of ten million samples (goal: 0.5 s), and the speed of reading a 100
//! MB table (goal: 100 MB/s). Each is compared with a naive solution: solving one matrix of all samples by QR and
//! calling `atan2` for each sample, and parsing the table line by line with the standard library.

use crate::median;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use encoder_studio::analysis::capture::TableHints;
use encoder_studio::analysis::diagnosis::{Record, diagnose};
use encoder_studio::analysis::ellipse::Ellipse;
use encoder_studio::analysis::lissajous::{PlotSquare, SampleDensity};
use encoder_studio::analysis::position_error::Samples;
use encoder_studio::analysis::quality::Limits;
use encoder_studio::analysis::signal_analysis::Analysis;
use encoder_studio::store::read_capture;
use nalgebra::{DMatrix, DVector};

const SAMPLES: usize = 10_000_000;
const ROWS: usize = 3_500_000;
const ROUNDS: usize = 5;

const ELLIPSE: Ellipse =
    Ellipse { amplitude_v: 0.5, offset_cosine_v: 0.02, offset_sine_v: -0.03, gain_ratio: 1.05, phase_error_rad: 0.052 };

/// Returns times, sine and cosine with a thousand samples per period and some noise.
fn capture(count: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let mut random = fastrand::Rng::with_seed(1);
    let time: Vec<f64> = (0..count).map(|at| at as f64 * 1e-6).collect();
    let mut noisy = |value: f64| value + 1e-3 * (random.f64() - 0.5);
    let (sine, cosine) = (0..count)
        .map(|at| ELLIPSE.point_at(TAU * at as f64 / 1000.0))
        .map(|(sine, cosine)| (noisy(sine), noisy(cosine)))
        .unzip();
    (time, sine, cosine)
}

/// Solves the equations of all samples at once and calculates the angle of each sample.
fn naive_fit(sine: &[f64], cosine: &[f64]) -> f64 {
    let rows = sine.len();
    let design = DMatrix::from_fn(rows, 5, |row, column| {
        let (x, y) = (cosine[row], sine[row]);
        [x * x, y * y, x * y, x, y][column]
    });
    let ones = DVector::from_element(rows, 1.0);
    let (q, r) = design.qr().unpack();
    let solution = r.solve_upper_triangular(&(q.transpose() * ones)).unwrap();
    let errors: Vec<f64> = sine.iter().zip(cosine).map(|(y, x)| y.atan2(*x)).collect();
    solution[0] + errors.iter().sum::<f64>()
}

fn naive_read(text: &str) -> Vec<[f64; 3]> {
    let fields = |line: &str| line.split(',').map(|field| field.trim().parse().unwrap()).collect::<Vec<f64>>();
    text.lines().skip(1).map(fields).map(|row| [row[0], row[1], row[2]]).collect()
}

pub(crate) fn run() {
    let (time, sine, cosine) = capture(SAMPLES);
    println!("analysis of {SAMPLES} samples, median of {ROUNDS} in seconds (goal: 0.5)");
    let samples = Samples { time_s: &time, sine_v: &sine, cosine_v: &cosine };
    println!("{:<28} {:>8.3}", "ellipse", median(ROUNDS, || Ellipse::fit(&sine, &cosine).unwrap()));
    println!("{:<28} {:>8.3}", "ellipse and all the rest", median(ROUNDS, || Analysis::from_samples(samples).unwrap()));
    let mut sparks = sine.clone();
    sparks.iter_mut().step_by(99_991).for_each(|value| *value += 3.0);
    let samples = Samples { time_s: &time, sine_v: &sparks, cosine_v: &cosine };
    println!("{:<28} {:>8.3}", "the same with 101 spikes", median(ROUNDS, || Analysis::from_samples(samples).unwrap()));
    let samples = Samples { time_s: &time, sine_v: &sine, cosine_v: &cosine };
    let analysis = Analysis::from_samples(samples).unwrap();
    let record = Record { samples, references_v: None, periods: Some(1000) };
    println!("{:<28} {:>8.3}", "diagnosis", median(ROUNDS, || diagnose(&record, Ok(&analysis), &Limits::HIPERFACE)));
    let density = || {
        let mut density = SampleDensity::new(PlotSquare::enclosing(&sine, &cosine).unwrap(), 256).unwrap();
        density.add_samples(&sine, &cosine);
        density
    };
    println!("{:<28} {:>8.3}", "density of the Lissajous", median(ROUNDS, density));
    // Only a tenth of the samples are used, because all of them would need gigabytes of memory.
    let tenth = SAMPLES / 10;
    let naive = median(ROUNDS, || naive_fit(&sine[..tenth], &cosine[..tenth])) * 10.0;
    println!("{:<28} {naive:>8.3}  (ten times a tenth of the samples)", "QR of all, atan2 of all");
    let mut text = "time,sine,cosine\n".to_owned();
    for at in 0..ROWS {
        writeln!(text, "{:.6},{:.6},{:.6}", time[at], sine[at], cosine[at]).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("capture.csv");
    std::fs::write(&path, &text).unwrap();
    let megabytes = text.len() as f64 / 1e6;
    println!("reading a table of {megabytes:.0} MB, median of {ROUNDS} in MB/s (goal: 100)");
    let studio = median(ROUNDS, || {
        read_capture(&path, &TableHints::default(), &AtomicBool::new(false), &mut |_, _| ()).unwrap().1.sine_v.len()
    });
    println!("{:<28} {:>8.0}", "studio", megabytes / studio);
    let naive = median(ROUNDS, || naive_read(&std::fs::read_to_string(&path).unwrap()).len());
    println!("{:<28} {:>8.0}", "lines, split, parse", megabytes / naive);
}
