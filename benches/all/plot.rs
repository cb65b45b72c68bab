//! Measures the time for one frame of the plot panel, with four lines of ten million samples: all visible, zoomed out
//! and in, paused and following. A frame consists of layout, reduction and tessellation. Compared with egui_plot on the
//! same samples. Prints figures without a verdict.
//!
//! `cargo bench -- plot`

use std::hint::black_box;
use std::time::{Duration, Instant};

use egui::{Context, RawInput, Rect, Vec2, pos2};
use encoder_studio::analysis::SampleTime;
use encoder_studio::analysis::history::{ColumnPart, Flags, Kind};
use encoder_studio::app::recorder::{self, GroupId, Recorder, Scale, Series};
use encoder_studio::app::{ColorScheme, Language, RecorderOwner, SessionId, Text, ThemeData};
use encoder_studio::ui::plot::{PlotUiState, plot_ui};
use encoder_studio::ui::{Theme, install_fonts};

const SAMPLES: usize = 10_000_000;
const SIGNALS: usize = 4;
/// Time between two samples in nanoseconds.
const PERIOD: i64 = 10_000;
const ROUNDS: usize = 101;
/// Size of the plot: a thousand pixels, plus the space for the labels.
const SIZE: Vec2 = Vec2::new(1060.0, 600.0);

pub(crate) fn run(parts: &[String]) {
    let naive = parts.iter().any(|part| part == "naive");
    let (mut recorder, group) = filled();
    println!(
        "{SIGNALS} × 10 M samples, {} MB, a plot of {} × {} points:",
        recorder.memory() / 1_000_000,
        SIZE.x,
        SIZE.y
    );
    let mut bench = Bench::new();
    let all = (SampleTime::ORIGIN, SampleTime::from_nanoseconds(SAMPLES as i64 * PERIOD));
    let span = all.1.nanoseconds_since(all.0);
    // Each frame shows another section, so that nothing of the previous one can be reused.
    let stretch = |share: f64, round: usize| {
        let length = (span as f64 * share) as i64;
        let from = (span - length).max(0) / 3 + round as i64 * length / 997;
        recorder::RecorderAction::Look(SampleTime::from_nanoseconds(from), SampleTime::from_nanoseconds(from + length))
    };
    for (label, share) in [
        ("all visible", 1.0),
        ("a tenth", 0.1),
        ("a hundredth", 1e-2),
        ("a thousandth", 1e-3),
        ("20 samples a pixel", 2e-3),
        ("3 samples a pixel", 3e-4),
        ("1 sample in 2 pixels", 5e-5),
    ] {
        let took = bench.rounds(&mut recorder, |recorder, round| recorder.handle_action(stretch(share, round)));
        println!("  {label:<26} {took}");
    }
    recorder.handle_action(recorder::RecorderAction::Look(all.0, all.1));
    println!("  {:<26} {}", "standing still", bench.rounds(&mut recorder, |_, _| {}));
    recorder.handle_action(recorder::RecorderAction::Fit);
    recorder.handle_action(recorder::RecorderAction::Follow);
    let mut next = SAMPLES;
    let took = bench.rounds(&mut recorder, |recorder, _| {
        // Two thousand samples arrive between two frames, as at 100 kHz.
        append(recorder, group, next, 2_000, false);
        next += 2_000;
    });
    println!("  {:<26} {took}", "following 100 kHz");
    let mut marked = Recorder::new(span);
    let group = lines(&mut marked);
    for at in (0..SAMPLES).step_by(100_000) {
        append(&mut marked, group, at, 100_000, true);
    }
    let took = bench.rounds(&mut marked, |recorder, round| recorder.handle_action(stretch(1.0, round)));
    println!("  {:<26} {took}", "all, a flag in each block");
    if naive {
        println!("  {:<26} {}", "egui_plot, all visible", egui_plot_frame());
    } else {
        println!("  (egui_plot on the same samples: cargo bench -- plot naive)");
    }
}

fn lines(recorder: &mut Recorder) -> GroupId {
    let group = recorder.add_group(&[Kind::Real; SIGNALS], SAMPLES + 1_000_000, Some(PERIOD * 10));
    for column in 0..SIGNALS {
        let scales = vec![Scale::new("unit.degrees", 1.0, 4)];
        recorder.add_line(Series::new(group, column, Text::new("recorder.position"), "value", scales));
    }
    group
}

fn filled() -> (Recorder, GroupId) {
    let mut recorder = Recorder::new(SAMPLES as i64 * PERIOD);
    let group = lines(&mut recorder);
    for at in (0..SAMPLES).step_by(100_000) {
        append(&mut recorder, group, at, 100_000, false);
    }
    (recorder, group)
}

fn append(recorder: &mut Recorder, group: GroupId, first: usize, count: usize, flagged: bool) {
    let times: Vec<SampleTime> =
        (first..first + count).map(|at| SampleTime::from_nanoseconds(at as i64 * PERIOD)).collect();
    let columns: Vec<Vec<f64>> =
        (0..SIGNALS).map(|signal| (first..first + count).map(|at| value(signal, at)).collect()).collect();
    let flags: Vec<Flags> =
        (first..first + count).map(|at| if at % 4000 == 7 { Flags::WARNING } else { Flags::NONE }).collect();
    let flags: &[Flags] = if flagged { &flags } else { &[] };
    let parts: Vec<ColumnPart<'_>> =
        columns.iter().map(|values| ColumnPart::from_reals(values).with_flags(flags)).collect();
    recorder.append(group, &times, &parts).unwrap();
}

/// Returns a sample of a sine with a slower sine and pseudo-noise added.
fn value(signal: usize, at: usize) -> f64 {
    let noise = (at.wrapping_mul(2_654_435_761) >> 16) % 1000;
    let time = at as f64 * 1e-5;
    (time * (3.0 + signal as f64)).sin() + 0.3 * (time * 977.0).sin() + noise as f64 * 1e-4
}

struct Bench {
    ctx: Context,
    theme: Theme,
    view: PlotUiState,
}

impl Bench {
    fn new() -> Self {
        let ctx = Context::default();
        install_fonts(&ctx);
        let theme = Theme::new(ThemeData::built_in().unwrap(), ColorScheme::Dark, Language::English);
        theme.apply_to(&ctx);
        Bench { ctx, theme, view: PlotUiState::default() }
    }

    fn rounds(&mut self, recorder: &mut Recorder, mut before: impl FnMut(&mut Recorder, usize)) -> String {
        // Parts that are laid out only once, such as letters, are ready now.
        self.frame(recorder);
        let mut took: Vec<(Duration, usize)> = (0..ROUNDS)
            .map(|round| {
                before(recorder, round);
                self.frame(recorder)
            })
            .collect();
        took.sort();
        let (median, vertices) = took[took.len() / 2];
        let worst = took[took.len() - 1].0;
        format!(
            "{:6.3} ms median, {:6.3} ms at most of {ROUNDS}, {vertices} vertices",
            median.as_secs_f64() * 1e3,
            worst.as_secs_f64() * 1e3
        )
    }

    /// Draws one frame without the graphics card.
    fn frame(&mut self, recorder: &Recorder) -> (Duration, usize) {
        frame(&self.ctx, |ui| {
            let (theme, mut actions) = (self.theme, Vec::new());
            let owner = RecorderOwner::Device(SessionId::default());
            plot_ui(ui, &theme, recorder, owner, &mut self.view, "", &mut actions);
        })
    }
}

fn frame(ctx: &Context, mut content: impl FnMut(&mut egui::Ui)) -> (Duration, usize) {
    let input = RawInput { screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), SIZE)), ..RawInput::default() };
    let began = Instant::now();
    let output = ctx.run_ui(input, |ui| content(ui));
    let primitives = ctx.tessellate(output.shapes, output.pixels_per_point);
    let took = began.elapsed();
    let vertices = |primitive: &egui::ClippedPrimitive| match &primitive.primitive {
        egui::epaint::Primitive::Mesh(mesh) => mesh.vertices.len(),
        egui::epaint::Primitive::Callback(_) => 0,
    };
    let vertices = black_box(primitives).iter().map(vertices).sum();
    (took, vertices)
}

/// Draws the same samples as lines of egui_plot, which processes all of them in every frame.
fn egui_plot_frame() -> String {
    let columns: Vec<Vec<egui_plot::PlotPoint>> = (0..SIGNALS)
        .map(|signal| {
            (0..SAMPLES)
                .map(|at| egui_plot::PlotPoint::new(at as f64 * PERIOD as f64 * 1e-9, value(signal, at)))
                .collect()
        })
        .collect();
    let ctx = Context::default();
    let draw = || {
        frame(&ctx, |ui| {
            egui_plot::Plot::new("naive").show(ui, |plot| {
                for (signal, points) in columns.iter().enumerate() {
                    plot.line(egui_plot::Line::new(signal.to_string(), egui_plot::PlotPoints::Borrowed(points)));
                }
            });
        })
        .0
    };
    draw();
    let mut took: Vec<Duration> = (0..5).map(|_| draw()).collect();
    took.sort();
    format!("{:6.0} ms median of 5", took[2].as_secs_f64() * 1e3)
}
