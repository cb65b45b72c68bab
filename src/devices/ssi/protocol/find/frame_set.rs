//! Detection of changing clocks, constant clocks and repeated words in recorded frames. This module does not decode
//! anything.

use std::collections::HashMap;

use crate::devices::ssi::protocol::code::low_bits_mask;
use crate::devices::ssi::protocol::descriptor::{Parity, Repeat};

/// Maximum number of consecutive frames in which a bit deviates because of a disturbance or an error.
const MAX_DISTURBED_FRAMES: usize = 2;
/// Maximum percentage of frames in which a constant bit deviates from its usual value.
const MAX_DEVIATING_PERCENT: usize = 25;
/// Maximum percentage of frames in which the repetition differs from the first word.
const MAX_REPEAT_MISMATCH_PERCENT: usize = 10;
/// Minimum width of a repeated word in bits.
const MIN_WORD_BITS: u8 = 4;

/// Recorded frames with the same number of clocks, in the order in which they were received.
pub(super) struct FrameSet {
    words: Vec<u64>,
    pub(super) clocks: u8,
    bits: Vec<Bit>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bit {
    pub(super) usual: bool,
    /// Number of frames in which the bit does not have its usual value.
    pub(super) unusual: usize,
    /// Number of times the bit changed between consecutive frames.
    pub(super) changes: usize,
    /// Whether the bit deviated from its usual value for longer than a disturbance lasts.
    pub(super) moves: bool,
}

impl FrameSet {
    pub(super) fn new(frames: &[u64], clocks: u8) -> Self {
        let clocks = clocks.clamp(1, 64);
        let words: Vec<u64> = frames.iter().map(|frame| frame & low_bits_mask(clocks)).collect();
        let bits = (1..=clocks).map(|clock| Bit::new(&words, clocks - clock)).collect();
        FrameSet { words, clocks, bits }
    }

    /// Returns the first of the two words in each frame.
    pub(super) fn first_words(&self, repeat: Repeat) -> Self {
        let words: Vec<u64> = self.words.iter().map(|word| word >> (self.clocks - repeat.word)).collect();
        FrameSet::new(&words, repeat.word)
    }

    pub(super) fn words(&self) -> &[u64] {
        &self.words
    }

    pub(super) fn bit(&self, clock: u8) -> Bit {
        usize::from(clock).checked_sub(1).and_then(|index| self.bits.get(index)).copied().unwrap_or_default()
    }

    pub(super) fn bits(&self) -> impl DoubleEndedIterator<Item = (u8, Bit)> + '_ {
        (1..=self.clocks).map(|clock| (clock, self.bit(clock)))
    }

    /// Returns the level of a line that never changes, or `None` if the frames contain both 0 and 1.
    pub(super) fn stuck_level(&self) -> Option<bool> {
        let same = |word: u64| self.words.iter().all(|own| *own == word);
        if same(0) { Some(false) } else { same(low_bits_mask(self.clocks)).then_some(true) }
    }

    pub(super) fn distinct_count(&self) -> usize {
        self.word_counts().len()
    }

    /// Returns whether the shaft stood still or only jittered, so that nearly all frames have one of a few values.
    /// Disturbed frames are tolerated.
    pub(super) fn is_at_rest(&self) -> bool {
        let mut counts: Vec<usize> = self.word_counts().into_values().collect();
        counts.sort_unstable_by(|a, b| b.cmp(a));
        let few: usize = counts.iter().take(8).sum();
        (self.words.len() - few) * 8 < self.words.len()
    }

    fn word_counts(&self) -> HashMap<u64, usize> {
        let mut counts = HashMap::new();
        self.words.iter().for_each(|word| *counts.entry(*word).or_default() += 1);
        counts
    }

    /// Returns the repetition, if the frames contain each word twice.
    pub(super) fn detect_repetition(&self) -> Option<Repeat> {
        let moving = |from: u8, to: u8| (from..=to).filter(|clock| self.bit(*clock).moves).count();
        (MIN_WORD_BITS..self.clocks).find_map(|behind| {
            let most = behind.min(self.clocks - behind);
            let word = (1..=most).take_while(|clock| self.are_equal(*clock, clock + behind)).last()?;
            let elsewhere = moving(word + 1, behind) + moving(behind + word + 1, self.clocks);
            let fits = moving(1, word) >= 4 && elsewhere == 0 && word >= MIN_WORD_BITS;
            fits.then_some(Repeat { word, gap: behind - word })
        })
    }

    /// Returns whether the second word of a frame equals the first.
    pub(super) fn is_repeated(&self, frame: u64, repeat: Repeat) -> bool {
        let first = frame >> (self.clocks - repeat.word);
        let second = frame >> (self.clocks - 2 * repeat.word - repeat.gap);
        (first ^ second) & low_bits_mask(repeat.word) == 0
    }

    pub(super) fn is_parity_valid(&self, word: u64, parity: Parity) -> bool {
        (word >> (self.clocks - parity.clock)).count_ones().is_multiple_of(2) == parity.even
    }

    /// Returns whether two clocks carry equal bits in nearly all frames.
    fn are_equal(&self, one: u8, other: u8) -> bool {
        let differs = |word: &&u64| (*word >> (self.clocks - one) ^ *word >> (self.clocks - other)) & 1 == 1;
        self.words.iter().filter(differs).count() * 100 <= MAX_REPEAT_MISMATCH_PERCENT * self.words.len()
    }
}

impl Bit {
    fn new(words: &[u64], behind: u8) -> Self {
        let bit = |word: &u64| *word >> behind & 1 == 1;
        let high = words.iter().filter(|word| bit(word)).count();
        let usual = 2 * high >= words.len();
        let unusual = if usual { words.len() - high } else { high };
        let changes = words.iter().zip(words.iter().skip(1)).filter(|(a, b)| bit(a) != bit(b)).count();
        let (mut run, mut longest) = (0, 0);
        for word in words {
            run = if bit(word) == usual { 0 } else { run + 1 };
            longest = longest.max(run);
        }
        Bit {
            usual,
            unusual,
            changes,
            moves: longest > MAX_DISTURBED_FRAMES || unusual * 100 > MAX_DEVIATING_PERCENT * words.len(),
        }
    }

    /// Returns the information content in bits of a clock whose bits nothing else explains.
    pub(super) fn information_bits(&self, frames: usize) -> f64 {
        binary_entropy(self.changes, frames)
    }
}

/// Returns the information content in bits of a choice of `some` items out of `all`.
pub(super) fn binary_entropy(some: usize, all: usize) -> f64 {
    if some == 0 || some >= all {
        return 0.0;
    }
    let share = some as f64 / all as f64;
    let log = |share: f64| -share * share.log2();
    all as f64 * (log(share) + log(1.0 - share))
}
