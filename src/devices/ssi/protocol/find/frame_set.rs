//! Recorded frames as bits over time: which clocks change, which do not, and where a word is repeated. Nothing is
//! decoded here.

use std::collections::HashMap;

use crate::devices::ssi::protocol::code::ones;
use crate::devices::ssi::protocol::descriptor::{Parity, Repeat};

/// A bit that differs from its usual value in no more frames in a row than this was disturbed, or is an error bit.
const SHORT: usize = 2;
/// Of a hundred frames, those in which a bit may differ from its usual value and still count as constant.
const RARE_PERCENT: usize = 25;
/// Of a hundred frames, those in which a second word may differ from the first.
const REPEAT_PERCENT: usize = 10;
/// A shorter word is not looked for twice.
const LEAST_WORD: u8 = 4;

/// Frames of the same number of clocks, in the order of reading.
pub(super) struct FrameSet {
    words: Vec<u64>,
    pub(super) clocks: u8,
    bits: Vec<Bit>,
}

/// The behaviour of the bit on a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bit {
    pub(super) usual: bool,
    /// Number of frames in which the bit has the opposite value.
    pub(super) unusual: usize,
    /// From a frame to the next, how often it changed.
    pub(super) changes: usize,
    /// It took the other value for longer than a disturbance lasts.
    pub(super) moves: bool,
}

impl FrameSet {
    pub(super) fn new(frames: &[u64], clocks: u8) -> Self {
        let clocks = clocks.clamp(1, 64);
        let words: Vec<u64> = frames.iter().map(|frame| frame & ones(clocks)).collect();
        let bits = (1..=clocks).map(|clock| Bit::new(&words, clocks - clock)).collect();
        FrameSet { words, clocks, bits }
    }

    /// The first words of frames that carry each word twice.
    pub(super) fn first_words(&self, repeat: Repeat) -> Self {
        let words: Vec<u64> = self.words.iter().map(|word| word >> (self.clocks - repeat.word)).collect();
        FrameSet::new(&words, repeat.word)
    }

    pub(super) fn words(&self) -> &[u64] {
        &self.words
    }

    /// Returns the behaviour of the bit on this clock, counted from 1.
    pub(super) fn bit(&self, clock: u8) -> Bit {
        usize::from(clock).checked_sub(1).and_then(|index| self.bits.get(index)).copied().unwrap_or_default()
    }

    /// Clocks with what their bits did.
    pub(super) fn bits(&self) -> impl DoubleEndedIterator<Item = (u8, Bit)> + '_ {
        (1..=self.clocks).map(|clock| (clock, self.bit(clock)))
    }

    /// The line stays high or low.
    pub(super) fn stuck(&self) -> Option<bool> {
        let same = |word: u64| self.words.iter().all(|own| *own == word);
        if same(0) { Some(false) } else { same(ones(self.clocks)).then_some(true) }
    }

    pub(super) fn different(&self) -> usize {
        self.counts().len()
    }

    /// Nearly all frames are among a few: the shaft stood or trembled, whatever else disturbances made of it.
    pub(super) fn is_standing(&self) -> bool {
        let mut counts: Vec<usize> = self.counts().into_values().collect();
        counts.sort_unstable_by(|a, b| b.cmp(a));
        let few: usize = counts.iter().take(8).sum();
        (self.words.len() - few) * 8 < self.words.len()
    }

    fn counts(&self) -> HashMap<u64, usize> {
        let mut counts = HashMap::new();
        self.words.iter().for_each(|word| *counts.entry(*word).or_default() += 1);
        counts
    }

    /// The first words are followed by the same bits once more.
    pub(super) fn repeat(&self) -> Option<Repeat> {
        let moving = |from: u8, to: u8| (from..=to).filter(|clock| self.bit(*clock).moves).count();
        (LEAST_WORD..self.clocks).find_map(|behind| {
            let most = behind.min(self.clocks - behind);
            let word = (1..=most).take_while(|clock| self.same(*clock, clock + behind)).last()?;
            let elsewhere = moving(word + 1, behind) + moving(behind + word + 1, self.clocks);
            let fits = moving(1, word) >= 4 && elsewhere == 0 && word >= LEAST_WORD;
            fits.then_some(Repeat { word, gap: behind - word })
        })
    }

    /// The second word of a frame is as the first.
    pub(super) fn is_repeated(&self, frame: u64, repeat: Repeat) -> bool {
        let first = frame >> (self.clocks - repeat.word);
        let second = frame >> (self.clocks - 2 * repeat.word - repeat.gap);
        (first ^ second) & ones(repeat.word) == 0
    }

    pub(super) fn is_right(&self, word: u64, parity: Parity) -> bool {
        (word >> (self.clocks - parity.clock)).count_ones().is_multiple_of(2) == parity.even
    }

    /// Returns whether two clocks carry the same in nearly all frames.
    fn same(&self, one: u8, other: u8) -> bool {
        let differs = |word: &&u64| (*word >> (self.clocks - one) ^ *word >> (self.clocks - other)) & 1 == 1;
        self.words.iter().filter(differs).count() * 100 <= REPEAT_PERCENT * self.words.len()
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
        Bit { usual, unusual, changes, moves: longest > SHORT || unusual * 100 > RARE_PERCENT * words.len() }
    }

    /// Bits that it takes to say what it did, where nothing else says so.
    pub(super) fn cost(&self, frames: usize) -> f64 {
        entropy(self.changes, frames)
    }
}

/// Bits that it takes to say which `some` of `all` were meant.
pub(super) fn entropy(some: usize, all: usize) -> f64 {
    if some == 0 || some >= all {
        return 0.0;
    }
    let share = some as f64 / all as f64;
    let log = |share: f64| -share * share.log2();
    all as f64 * (log(share) + log(1.0 - share))
}
