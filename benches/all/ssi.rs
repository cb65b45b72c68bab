//! Measures the speed of decoding SSI frames (goal: 100 million per second on one core for 25 bits in Gray code),
//! compared with a decoder that reads them bit by bit. Also measures the time to find the layout of 2000 frames, and
//! how often the result is correct for a thousand recordings of many kinds of encoders.
//!
//! `cargo bench -- ssi`

#[path = "../../tests/tools/ssi_recordings.rs"]
mod ssi_recordings;

use std::hint::black_box;
use std::time::Instant;

use crate::median;

use encoder_studio::devices::ssi::protocol::{Families, Flags, FrameReading, Layout, Settings, find};

const FRAMES: usize = 1 << 14;
const PASSES: usize = 64;
const ROUNDS: usize = 9;

fn layout(text: &str) -> Layout {
    let (key, settings) = Settings::parse(text).unwrap();
    settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
}

/// Returns frames of pseudo-random positions, some with an error bit.
fn frames(layout: &Layout) -> Vec<u64> {
    let mut random = fastrand::Rng::with_seed(1);
    let frame = |_| {
        let flags = if random.u8(..) == 0 { Flags::error(0) } else { Flags::NONE };
        layout.encode(random.u64(..=layout.position_code().last_position()), flags).unwrap()
    };
    (0..FRAMES).map(frame).collect()
}

/// Decodes a Gray-coded frame of 25 bits, 12 of which count turns. It uses the method of the manual, bit by bit from
/// the first clock.
fn bit_by_bit(frame: u64) -> (u32, u32) {
    let (mut turns, mut steps, mut before) = (0_u32, 0_u32, 0_u64);
    for clock in 1..=25 {
        before ^= frame >> (25 - clock) & 1;
        if clock <= 12 {
            turns = turns << 1 | before as u32;
        } else {
            steps = steps << 1 | before as u32;
        }
    }
    (turns, steps)
}

pub(crate) fn run() {
    println!("{FRAMES} frames {PASSES} times over, medians of {ROUNDS}\n");
    for text in
        ["atm60,code=gray", "atm60,code=gray,err=fix", "afm60,code=gray", "atm60,steps=3600,code=gray-excess", "ttk70"]
    {
        let layout = layout(text);
        let frames = frames(&layout);
        let mut readings = vec![FrameReading::default(); FRAMES];
        let seconds = median(ROUNDS, || {
            for _ in 0..PASSES {
                layout.decode_all(black_box(&frames), &mut readings);
                black_box(&readings);
            }
        });
        println!("{text:36} {:7.1} million frames/s", (FRAMES * PASSES) as f64 / seconds / 1e6);
    }
    let plain = layout("atm60,code=gray");
    let frames = frames(&plain);
    let mut readings = vec![(0, 0); FRAMES];
    let seconds = median(ROUNDS, || {
        for _ in 0..PASSES {
            for (reading, frame) in readings.iter_mut().zip(black_box(&frames)) {
                *reading = bit_by_bit(*frame);
            }
            black_box(&readings);
        }
    });
    println!("{:36} {:7.1} million frames/s", "bit by bit, 25 bits in Gray", (FRAMES * PASSES) as f64 / seconds / 1e6);

    let turning: Vec<u64> = (0..2000).filter_map(|at| plain.encode(4_000_000 + at * 13 / 10, Flags::NONE)).collect();
    let families = Families::built_in();
    let seconds = median(ROUNDS, || find(black_box(&turning), 25, &families));
    println!("\nthe layout of 2000 frames of 25 bits is found in {:.0} ms", seconds * 1e3);
    measure_layout_detection(&families);
}

/// Measures, for independently generated recordings, how often the top class of layouts contains the correct one, and
/// how often a result reported as certain is wrong.
fn measure_layout_detection(families: &Families) {
    let begun = Instant::now();
    let (mut first, mut ticks, mut wrong) = (0, 0, 0);
    for seed in 0..1000 {
        let recording = ssi_recordings::Recording::of(seed);
        let search = find(&recording.frames, recording.clocks, families);
        let reads = |layout: &Layout| {
            let mut frames = recording.frames.iter().zip(&recording.meant);
            frames.all(|(frame, meant)| meant.is_none_or(|meant| layout.decode(*frame).position == meant))
        };
        let members = search.classes.first().map(|class| class.members.as_slice()).unwrap_or_default();
        first += usize::from(members.iter().any(|member| reads(&member.layout)));
        let tick = search.uncertainty.is_none();
        ticks += usize::from(tick);
        if tick && !members.first().is_some_and(|member| reads(&member.layout)) {
            wrong += 1;
            println!("wrong tick: {}", recording.what);
        }
    }
    println!(
        "1000 recordings in {:.1} s: the truth in the first class {first} times, {ticks} ticks, {wrong} of them wrong",
        begun.elapsed().as_secs_f64()
    );
}
