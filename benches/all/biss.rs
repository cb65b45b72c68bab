//! Measures the speed of decoding BiSS frames with their checksum (goal: 20 million per second on one core), compared
//! with a checksum calculated bit by bit. Also measures how much faster than real time, 20 000 frames per second, an
//! adapter's stream is parsed and recorded.
//!
//! `cargo bench -- biss`

use crate::median;
use std::hint::black_box;

use encoder_studio::analysis::history::{ColumnPart, History, Kind};
use encoder_studio::analysis::{PositionUnwrapper, SampleTime};
use encoder_studio::buses::bridge::protocol::{
    BissData, BissStatus, Continuity, Message, PacketGap, Receiver, StreamData,
};
use encoder_studio::devices::biss::protocol::{Crc, FrameError, Layout, PositionData};

/// Number of frames in a batch.
const FRAMES: usize = 1 << 16;
/// Number of times that the batch is decoded in one measurement.
const PASSES: usize = 16;
const ROUNDS: usize = 9;
/// Time between two frames of the stream.
const PERIOD_US: u32 = 50;
const SECONDS: u32 = 10;

/// Returns frames of pseudo-random positions. One in a thousand has an inverted bit.
fn frames(layout: &Layout) -> Vec<u64> {
    let mut random = fastrand::Rng::with_seed(1);
    (0..FRAMES)
        .map(|at| {
            let reading = PositionData {
                multiturn: random.u32(..),
                singleturn: random.u32(..),
                error: random.u8(..) == 0,
                warning: random.u8(..) == 0,
            };
            let damage = if at % 1000 == 7 { 1 << random.u8(..layout.bits()) } else { 0 };
            layout.emit(&reading) ^ damage
        })
        .collect()
}

/// Decodes the batch repeatedly and returns the rate in millions of frames per second.
fn rate<T>(frames: &[u64], decode: impl Fn(u64) -> T) -> f64 {
    let mut readings = Vec::with_capacity(FRAMES);
    let seconds = median(ROUNDS, || {
        for _ in 0..PASSES {
            readings.clear();
            readings.extend(black_box(frames).iter().map(|raw| decode(*raw)));
            black_box(&readings);
        }
    });
    (FRAMES * PASSES) as f64 / seconds / 1e6
}

/// Decodes a frame of the kit encoder as in the manual, calculating the checksum bit by bit.
fn bit_by_bit(raw: u64) -> Option<PositionData> {
    let data = raw >> 6;
    let mut sum = 0u8;
    for at in (0..35).rev() {
        let feedback = sum >> 5 ^ (data >> at & 1) as u8;
        sum = sum << 1 & 0x3F ^ if feedback == 1 { 3 } else { 0 };
    }
    let reading = PositionData {
        multiturn: (data >> 19) as u32 & 0xFFFF,
        singleturn: (data >> 2) as u32 & 0x1_FFFF,
        error: data & 2 == 0,
        warning: data & 1 == 0,
    };
    (u64::from(sum ^ 0x3F) == raw & 0x3F).then_some(reading)
}

fn decoding() {
    println!("decoding {FRAMES} frames, median of {ROUNDS}, millions a second (goal: 20)");
    let layout = Layout::default();
    let own = frames(&layout);
    let good = |frame: &&u64| bit_by_bit(**frame) == layout.parse(**frame).ok();
    assert_eq!(own.iter().filter(good).count(), FRAMES, "both ways read the same");
    println!("{:<32} {:>7.1}", "16 + 17 bits, CRC6", rate(&own, |raw| layout.parse(raw)));
    println!("{:<32} {:>7.1}", "the same, bit by bit", rate(&own, bit_by_bit));
    let wide = Layout::new(20, 26, true, true, Crc::new(0x1_1021, 0xFFFF, true).ok()).unwrap();
    let frames = frames(&wide);
    println!("{:<32} {:>7.1}", "20 + 26 bits, CRC16", rate(&frames, |raw| wide.parse(raw)));
}

/// Returns the bytes that an adapter sends in ten seconds while the shaft turns at 3000 rpm, with 56 frames per packet.
fn sent(layout: &Layout) -> Vec<u8> {
    let frame = |index: u32| {
        let steps = u64::from(index) * 131_072 * u64::from(PERIOD_US) / 20_000;
        let (multiturn, singleturn) = ((steps >> 17) as u32 & 0xFFFF, steps as u32 & 0x1_FFFF);
        (BissStatus::OK, layout.emit(&PositionData { multiturn, singleturn, error: false, warning: false }))
    };
    let count = SECONDS * 1_000_000 / PERIOD_US;
    let packet = |first_index: u32| {
        let values = (first_index..count.min(first_index + 56)).map(frame).collect();
        let t0_us = u64::from(first_index) * u64::from(PERIOD_US);
        let data = BissData { first_index, t0_us, period_us: PERIOD_US, lost: 0, width: 6, values };
        Message::Data(StreamData::Biss(data)).emit(0).emit()
    };
    (0..count).step_by(56).flat_map(packet).collect()
}

/// Records all frames of the stream in a history and returns their number.
fn receive(bytes: &[u8], layout: &Layout) -> u64 {
    let mut receiver = Receiver::default();
    let mut continuity = Continuity::at_start();
    let mut unwrap = PositionUnwrapper::rotary(1 << 33).unwrap();
    let mut history = History::new(&[Kind::Whole], 4_000_000);
    let (mut times, mut steps) = (Vec::new(), Vec::new());
    for portion in bytes.chunks(512) {
        receiver.push(portion);
        while let Some(packet) = receiver.next_packet() {
            let Ok(Message::Data(data)) = Message::parse(&packet) else { panic!("nothing else was sent") };
            assert_eq!(continuity.gap_before(&data), PacketGap::None);
            let StreamData::Biss(data) = data else { panic!("nothing else was sent") };
            times.clear();
            steps.clear();
            for (at, (_, raw)) in data.values.iter().enumerate() {
                let reading: Result<PositionData, FrameError> = layout.parse(*raw);
                let position = i64::try_from(layout.position_to_steps(&reading.unwrap())).unwrap();
                steps.push(unwrap.next(position).unwrap().steps);
                let nanoseconds = (data.t0_us as i64 + at as i64 * i64::from(data.period_us)) * 1000;
                times.push(SampleTime::from_nanoseconds(nanoseconds));
            }
            history.append(&times, &[ColumnPart::from_integers(&steps)]).unwrap();
        }
    }
    history.indices().end
}

fn stream() {
    let layout = Layout::default();
    let bytes = sent(&layout);
    assert_eq!(receive(&bytes, &layout), u64::from(SECONDS * 1_000_000 / PERIOD_US), "none is missing");
    let seconds = median(ROUNDS, || receive(&bytes, &layout));
    println!("a stream of {} frames/s: COBS, CRC16, frame CRC, history", 1_000_000 / PERIOD_US);
    println!("{:<32} {:>7.0}", "times real time", f64::from(SECONDS) / seconds);
    println!("{:<32} {:>7.2}", "millions of frames a second", f64::from(SECONDS * 20_000) / seconds / 1e6);
}

pub(crate) fn run() {
    decoding();
    stream();
}
