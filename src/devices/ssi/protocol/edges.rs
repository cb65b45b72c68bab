//! Extraction of frames from a logic analyser recording of clock and data.
//!
//! The clock idles high. The encoder outputs a bit at each rising edge, and the host samples the bit at the next
//! falling edge. The last bit remains on the line for half a period. Bursts are separated by pauses. See SICK SSI
//! description 2.2 and reference section 1.

/// Levels of both lines from a point in time onwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLevels {
    /// Time in seconds.
    pub at: f64,
    /// Whether CLOCK+ is high.
    pub clock: bool,
    /// Whether DATA+ is high.
    pub data: bool,
}

/// Frames extracted from a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExtractedFrames {
    /// Number of bits per frame, 1 to 64.
    pub clocks: u8,
    /// Right-justified frames in recording order.
    pub frames: Vec<u64>,
    /// Number of bursts that were ignored because their number of clocks differs. Such a burst was disturbed or only
    /// partly recorded.
    pub left_out: usize,
}

/// The reason why a recording contains no frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BurstError {
    /// The clock line never changes.
    #[error("the clock has no edges")]
    NoClock,
    /// The clock never pauses.
    #[error("there is no pause between bursts")]
    NoPause,
    /// No burst was recorded completely.
    #[error("no burst is complete")]
    Incomplete,
    /// Bursts are longer than the longest possible frame.
    #[error("the bursts have {clocks} clocks, but a frame has at most 64")]
    Long {
        /// Most frequent number of clocks in a burst.
        clocks: usize,
    },
}

/// Minimum monoflop time tm in seconds. The encoder considers a burst finished once the clock has stayed at one level
/// for this time.
const MIN_MONOFLOP: f64 = 15e-6;
/// Minimum pause between bursts in half clock periods, for slow clocks.
const MIN_PAUSE_HALF_PERIODS: f64 = 3.0;
/// Sampling point of the last bit as a fraction of a half period. The data line falls after the full half period.
const SAMPLING_POINT: f64 = 0.9;

/// A clock edge with its row in the recording.
#[derive(Clone, Copy)]
struct Edge {
    at: f64,
    row: usize,
    rises: bool,
}

/// Extracts the frames from a recording whose times never decrease. Swapped clock wires are recognised by the idle
/// level.
///
/// # Errors
/// Returns a [`BurstError`] if the recording contains no frames.
pub fn extract_frames(levels: &[LineLevels]) -> Result<ExtractedFrames, BurstError> {
    let edges = find_edges(levels);
    let mut halves: Vec<f64> = edges.windows(2).filter_map(|two| Some(two.last()?.at - two.first()?.at)).collect();
    halves.sort_by(f64::total_cmp);
    let half = *halves.get(halves.len() / 2).ok_or(BurstError::NoClock)?;
    let pause = MIN_MONOFLOP.max(MIN_PAUSE_HALF_PERIODS * half);
    let rests_high = is_idle_high(levels, &edges, pause).ok_or(BurstError::NoPause)?;
    let runs: Vec<&[Edge]> = edges.chunk_by(|one, next| next.at - one.at < pause).collect();
    let falls = |edge: &Edge| edge.rises != rests_high;
    // A complete burst begins with a falling edge and ends with a rising edge.
    let whole = |run: &[Edge]| run.len().is_multiple_of(2) && run.first().is_some_and(falls);
    let clocks =
        most_frequent(runs.iter().filter(|run| whole(run)).map(|run| run.len() / 2)).ok_or(BurstError::Incomplete)?;
    let bits = u8::try_from(clocks).ok().filter(|bits| *bits <= 64).ok_or(BurstError::Long { clocks })?;
    let kept = runs.iter().filter(|run| whole(run) && run.len() / 2 == clocks);
    let frames: Vec<u64> = kept.map(|run| frame_bits(levels, run, half)).collect();
    Ok(ExtractedFrames { clocks: bits, left_out: runs.len() - frames.len(), frames })
}

fn find_edges(levels: &[LineLevels]) -> Vec<Edge> {
    let pairs = levels.windows(2).zip(1..);
    let changes = pairs.filter_map(|(two, row)| {
        let (before, now) = (two.first()?, two.last()?);
        (before.clock != now.clock).then_some(Edge { at: now.at, row, rises: now.clock })
    });
    changes.collect()
}

/// Returns whether the clock line is high when idle, or `None` if the clock never pauses. The idle level is the level
/// with the longer total pause.
fn is_idle_high(levels: &[LineLevels], edges: &[Edge], pause: f64) -> Option<bool> {
    let (first, last) = (levels.first()?, levels.last()?);
    let begins = std::iter::once((first.at, first.clock)).chain(edges.iter().map(|edge| (edge.at, edge.rises)));
    let ends = edges.iter().map(|edge| edge.at).chain(std::iter::once(last.at));
    let mut rests = [0.0, 0.0];
    for ((from, high), to) in begins.zip(ends).filter(|((from, _), to)| to - from >= pause) {
        let [low_time, high_time] = &mut rests;
        *(if high { high_time } else { low_time }) += to - from;
    }
    let [low, high] = rests;
    (low + high > 0.0).then_some(high >= low)
}

/// Returns the most frequent number. If several are equally frequent, the greatest is returned.
fn most_frequent(numbers: impl Iterator<Item = usize>) -> Option<usize> {
    let mut sorted: Vec<usize> = numbers.collect();
    sorted.sort_unstable();
    let runs = sorted.chunk_by(|one, other| one == other);
    runs.max_by_key(|run| run.len()).and_then(|run| run.first().copied())
}

fn frame_bits(levels: &[LineLevels], run: &[Edge], half: f64) -> u64 {
    let sampled = run.chunks(2).skip(1).filter_map(|clock| levels.get(clock.first()?.row - 1));
    let bits = sampled.fold(0, |bits, before| bits << 1 | u64::from(before.data));
    // The last bit stays on the line for a half period of this burst.
    let high = run.windows(2).skip(1).step_by(2).filter_map(|two| Some(two.last()?.at - two.first()?.at));
    let half = high.reduce(f64::min).unwrap_or(half);
    let last = run.last().and_then(|edge| {
        let until = edge.at + SAMPLING_POINT * half;
        levels.get(edge.row..)?.iter().take_while(|row| row.at <= until).last()
    });
    bits << 1 | last.map_or(0, |row| u64::from(row.data))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Appends the levels of both lines during a transfer of the given bits, as in reference section 1, and returns the
    /// end of the transfer. `half` is half a clock period in µs.
    fn transfer(levels: &mut Vec<LineLevels>, begins: f64, bits: &str, half: f64) -> f64 {
        let mut put = |at: f64, clock, data| levels.push(LineLevels { at: at * 1e-6, clock, data });
        let mut data = true;
        let mut at = begins;
        for bit in bits.chars() {
            put(at, false, data);
            at += half;
            put(at, true, data);
            // The delay of the line is less than half a period.
            data = bit == '1';
            put(at + 0.3 * half, true, data);
            at += half;
        }
        put(at, true, false);
        put(at + 20.0, true, true);
        at + 20.0
    }

    fn recording(frames: &[&str], half: f64, pause: f64) -> Vec<LineLevels> {
        let mut levels = vec![LineLevels { at: 0.0, clock: true, data: true }];
        let mut at = 50.0;
        for frame in frames {
            at = transfer(&mut levels, at, frame, half) + pause;
        }
        levels
    }

    /// Frame of an AHM36 in Gray code with MT 123h and ST 2A5Bh (reference section 8).
    const GRAY: &str = "000110110010011111011101100";
    const INVERTED_GRAY: &str = "111001001101100000100010011";

    #[test]
    fn samples_bits_like_host() {
        // The clock frequencies are 400 kHz, 2 MHz and 25 kHz. At 25 kHz, half a period is longer than tm.
        for (half, pause) in [(1.25, 30.0), (0.25, 30.0), (20.0, 200.0)] {
            let found = extract_frames(&recording(&[GRAY, INVERTED_GRAY, GRAY], half, pause)).unwrap();
            assert_eq!(
                found,
                ExtractedFrames { clocks: 27, frames: vec![0x0D9_3EEC, 0x726_C113, 0x0D9_3EEC], left_out: 0 }
            );
        }
        // Each burst has a single clock. After the last bit, which is 1, the data line falls half a period later.
        assert_eq!(extract_frames(&recording(&["1", "0", "1"], 1.0, 30.0)).unwrap().frames, [1, 0, 1]);
    }

    #[test]
    fn skips_and_counts_incomplete_bursts() {
        let mut levels = recording(&[GRAY, GRAY, "1010", GRAY], 1.25, 30.0);
        // The recording begins and ends in the middle of a burst.
        levels.drain(..20);
        levels.truncate(levels.len() - 9);
        let found = extract_frames(&levels).unwrap();
        assert_eq!((found.clocks, found.frames, found.left_out), (27, vec![0x0D9_3EEC], 3));
    }

    #[test]
    fn idle_level_reveals_swapped_clock() {
        let mut levels = recording(&[GRAY, INVERTED_GRAY], 1.25, 60.0);
        levels.iter_mut().for_each(|own| own.clock = !own.clock);
        assert_eq!(extract_frames(&levels).unwrap().frames, [0x0D9_3EEC, 0x726_C113]);
    }

    #[test]
    fn rejects_invalid_recordings() {
        let row = |at: f64, clock| LineLevels { at: at * 1e-6, clock, data: false };
        assert_eq!(extract_frames(&[]), Err(BurstError::NoClock));
        assert_eq!(extract_frames(&[row(0.0, true), row(9.0, true)]), Err(BurstError::NoClock));
        let runs: Vec<LineLevels> = (0..200).map(|at| row(f64::from(at), at % 2 == 0)).collect();
        assert_eq!(extract_frames(&runs), Err(BurstError::NoPause));
        let late = runs.iter().map(|own| LineLevels { at: own.at + 50e-6, ..*own });
        let long: Vec<LineLevels> = std::iter::once(row(0.0, true)).chain(late).collect();
        let whole = &long[..=200];
        assert_eq!(extract_frames(whole), Err(BurstError::Incomplete), "it ends low");
        assert_eq!(extract_frames(&[whole, &[row(250.0, true)]].concat()), Err(BurstError::Long { clocks: 100 }));
    }
}
