//! Generates recordings of SSI encoders with many kinds of frames. They are built bit by bit without the program's own
//! decoding, and the same seed yields the same recording. Each frame has an expected position for checking a layout.

use fastrand::Rng;

/// The frames of one encoder and their expected positions.
pub(crate) struct Recording {
    /// Description of the parts of a frame, for messages.
    pub(crate) what: String,
    /// Number of bits in a frame.
    pub(crate) clocks: u8,
    /// Frames, right-justified.
    pub(crate) frames: Vec<u64>,
    /// Expected position of each frame, or `None` if the frame is damaged.
    pub(crate) meant: Vec<Option<u64>>,
}

/// The encoding of positions.
enum Word {
    Binary,
    Gray,
    Excess,
    Decimal,
    /// Turns and steps in separate Gray codes.
    GrayTwice {
        singleturn: u32,
    },
}

/// The bits after the position.
enum Behind {
    Constant(Vec<bool>),
    Parity {
        even: bool,
    },
    /// An error bit that is rarely 1.
    Error,
    /// An error bit that stays 1 for long periods.
    LongError,
    /// A bit that toggles with each frame.
    Alive,
    /// Check bits, of the given number, which depend on the position but are not part of it.
    Check(u32),
    /// A random bit.
    Noise,
}

fn number_to_bits(number: u64, width: u32) -> Vec<bool> {
    (0..width).rev().map(|at| number >> at & 1 == 1).collect()
}

/// Encodes a number in Gray code, most significant bit first.
fn gray(number: u64, width: u32) -> Vec<bool> {
    let bits = number_to_bits(number, width);
    let above = std::iter::once(&false).chain(&bits);
    bits.iter().zip(above).map(|(bit, above)| bit != above).collect()
}

fn position_width(positions: u64) -> u32 {
    64 - (positions - 1).leading_zeros()
}

impl Recording {
    /// Generates the recording for a seed.
    pub(crate) fn of(seed: u64) -> Self {
        let mut rng = Rng::with_seed(seed ^ 0x5851_F42D_4C95_7F2D);
        let (word, positions) = word(&mut rng);
        let front = front(&mut rng);
        let behind = behind(&mut rng);
        let whole = positions.is_power_of_two() && !matches!(word, Word::GrayTwice { .. });
        let gap = if whole && rng.u8(..12) == 0 { rng.usize(1..4) } else { 0 };
        let inverted = rng.u8(..5) == 0;
        let twice = (rng.u8(..8) == 0).then(|| rng.usize(..2));
        let count = rng.usize(300..1100);
        let angles = shaft(&mut rng, count, positions);
        let disturbed = [0.0, 0.005, 0.02, 0.04][rng.usize(..4)];
        let trouble = rng.usize(..count);
        let (mut frames, mut meant, mut clocks) = (Vec::new(), Vec::new(), 0);
        for (at, angle) in angles.into_iter().enumerate() {
            let position = angle.rem_euclid(i128::from(positions)) as u64;
            let coded = encoded(&word, position, positions);
            let split = coded.len().saturating_sub(12).max(1);
            let mut bits = front.clone();
            bits.extend(&coded[..split]);
            bits.extend(std::iter::repeat_n(false, gap));
            bits.extend(&coded[split..]);
            append(&mut bits, &behind, position, at, (trouble, count), &mut rng);
            if let Some(pause) = twice.filter(|pause| 2 * bits.len() + pause <= 64) {
                let again = bits.clone();
                bits.extend(std::iter::repeat_n(false, pause));
                bits.extend(again);
            }
            if inverted {
                bits.iter_mut().for_each(|bit| *bit = !*bit);
            }
            bits.truncate(64);
            let is_disturbed = rng.f64() < disturbed;
            if is_disturbed {
                for _ in 0..rng.usize(1..6) {
                    let at = rng.usize(..bits.len());
                    bits[at] = !bits[at];
                }
            }
            clocks = bits.len() as u8;
            frames.push(bits.iter().fold(0, |frame, bit| frame << 1 | u64::from(*bit)));
            meant.push((!is_disturbed).then_some(position));
        }
        let name = match word {
            Word::Binary => "binary",
            Word::Gray => "gray",
            Word::Excess => "excess",
            Word::Decimal => "decimal",
            Word::GrayTwice { .. } => "gray twice",
        };
        let behind = match &behind {
            Behind::Constant(bits) => format!("{bits:?}"),
            Behind::Parity { even } => format!("parity, even: {even}"),
            Behind::Error => "error".to_owned(),
            Behind::LongError => "long error".to_owned(),
            Behind::Alive => "alive".to_owned(),
            Behind::Check(bits) => format!("check of {bits}"),
            Behind::Noise => "noise".to_owned(),
        };
        let what = format!(
            "seed {seed}: {positions} positions in {name}, front {front:?}, behind {behind}, gap {gap}, inverted {inverted}, twice {twice:?}, disturbed {disturbed}, {count} frames"
        );
        Recording { what, clocks, frames, meant }
    }
}

/// Returns a random encoding and its number of positions.
fn word(rng: &mut Rng) -> (Word, u64) {
    let widths = [9, 10, 11, 12, 13, 14, 16, 17, 18, 20, 24, 25, 26, 30];
    let whole = 1 << widths[rng.usize(..widths.len())];
    let usual = [360, 720, 1000, 1440, 1800, 2000, 2500, 3600, 5000, 7200, 10_000, 36_000];
    let steps = if rng.u8(..4) == 0 { rng.u64(50..5000) * 2 } else { usual[rng.usize(..usual.len())] };
    match rng.u8(..16) {
        0..4 => (Word::Binary, whole),
        4..10 => (Word::Gray, whole),
        10..13 => (Word::Excess, steps),
        13 => (Word::Decimal, [360, 1000, 3600, 10_000][rng.usize(..4)]),
        14 => (if rng.bool() { Word::Binary } else { Word::Gray }, steps),
        _ => (Word::GrayTwice { singleturn: 10 }, 1 << 16),
    }
}

fn front(rng: &mut Rng) -> Vec<bool> {
    match rng.u8(..8) {
        0..4 => Vec::new(),
        4 => vec![true],
        5 => vec![false; rng.usize(1..6)],
        6 => vec![true, false],
        _ => (0..rng.usize(1..4)).map(|_| rng.bool()).collect(),
    }
}

fn behind(rng: &mut Rng) -> Behind {
    match rng.u8(..18) {
        0..6 => Behind::Constant(Vec::new()),
        6..8 => Behind::Constant(vec![false; rng.usize(1..5)]),
        8..10 => Behind::Constant(vec![true]),
        10 => Behind::Constant((0..rng.usize(1..4)).map(|_| rng.bool()).collect()),
        11..13 => Behind::Parity { even: rng.bool() },
        13 => Behind::Error,
        14 => Behind::LongError,
        15 => Behind::Alive,
        16 => Behind::Check(rng.u32(1..7)),
        _ => Behind::Noise,
    }
}

/// Returns unwrapped shaft positions for various motions: slow or fast, even or uneven, steady, oscillating or
/// reversing.
fn shaft(rng: &mut Rng, count: usize, positions: u64) -> Vec<i128> {
    let most = positions as f64 / 3.0;
    let fastest = if rng.u8(..3) == 0 { most } else { most.min(40.0) };
    let mut speed = 0.3 * (fastest / 0.3).powf(rng.f64());
    let exact = rng.u8(..8) == 0;
    if exact {
        speed = speed.round().max(1.0);
    }
    let direction = if rng.bool() { 1.0 } else { -1.0 };
    let swing = if exact { 0.0 } else { [0.0, 0.1, 0.4, 1.3][rng.usize(..4)] };
    let noise = if exact { 0.0 } else { [0.2, 0.6, 2.0][rng.usize(..3)] };
    let near_end = rng.u8(..3) == 0;
    let start = if near_end { 5.0 * speed } else { rng.f64() * positions as f64 };
    let phase = rng.f64() * 6.3;
    let mut angle = if near_end && direction > 0.0 { positions as f64 - start } else { start };
    let angles = (0..count).map(|at| {
        angle += direction * speed * (1.0 + swing * (phase + at as f64 / 70.0).sin());
        let trembling = noise * (rng.f64() + rng.f64() - 1.0);
        (angle + trembling).round() as i128
    });
    angles.collect()
}

fn encoded(word: &Word, position: u64, positions: u64) -> Vec<bool> {
    let width = position_width(positions);
    match word {
        Word::Binary => number_to_bits(position, width),
        Word::Gray => gray(position, width),
        Word::Excess => gray(position + ((1 << width) - positions) / 2, width),
        Word::Decimal => {
            let digits = (positions - 1).to_string().len();
            let text = format!("{position:0digits$}");
            text.bytes().flat_map(|digit| number_to_bits(u64::from(digit - b'0'), 4)).collect()
        }
        Word::GrayTwice { singleturn } => {
            let (turns, steps) = (position >> singleturn, position & ((1 << singleturn) - 1));
            [gray(turns, width - singleturn), gray(steps, *singleturn)].concat()
        }
    }
}

fn append(
    bits: &mut Vec<bool>,
    behind: &Behind,
    position: u64,
    at: usize,
    (trouble, count): (usize, usize),
    rng: &mut Rng,
) {
    let ones = bits.iter().filter(|bit| **bit).count();
    match behind {
        Behind::Constant(more) => bits.extend(more),
        Behind::Parity { even } => bits.push((ones % 2 == 1) == *even),
        Behind::Error => bits.push(rng.u8(..30) == 0),
        Behind::LongError => bits.push((trouble..trouble + count / 5).contains(&at)),
        Behind::Alive => bits.push(at.is_multiple_of(2)),
        Behind::Check(width) => {
            let mixed = (position ^ 0x2D).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            bits.extend(number_to_bits(mixed >> 40, *width));
        }
        Behind::Noise => bits.push(rng.bool()),
    }
}
