//! Simulated faults of the virtual SSI encoder: active error bits, and words that report a fault in place of a
//! position. The layout defines the possible faults. See SICK SSI description, chapter 3.

use std::time::Duration;

use crate::devices::ssi::protocol::{Flags, Layout, Word};
use crate::units::Moment;

/// An error bit, or a word that reports a fault, with its timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct InjectedFault {
    shows: FaultIndication,
    /// Period of an intermittent fault, or `None` if the fault is always present.
    period: Option<Duration>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FaultIndication {
    Bit {
        index: usize,
        /// Whether a transfer clears the bit.
        cleared: bool,
    },
    /// A right-justified word that is sent in place of the frame.
    Word(u64),
}

impl InjectedFault {
    const MIN_PERIOD: f64 = 1e-6;
    const MAX_PERIOD: f64 = 86_400.0;

    /// Parses a list of faults such as `ERRSYNC:0.5,ERRSI`, or returns `None` if it is invalid.
    ///
    /// A name refers to an error bit or a pattern of the layout. It may be in upper or lower case, with hyphens instead
    /// of spaces.
    pub(super) fn read(text: &str, layout: &Layout) -> Option<Vec<Self>> {
        let items = text.split(',').map(str::trim).filter(|item| !item.is_empty());
        items
            .map(|item| {
                let (name, period) = match item.split_once(':') {
                    Some((name, seconds)) => (name, Some(period(seconds)?)),
                    None => (item, None),
                };
                Some(InjectedFault { shows: find_indication(name, layout)?, period })
            })
            .collect()
    }

    pub(super) fn setting_names(layout: &Layout) -> Vec<String> {
        let descriptor = layout.descriptor();
        let bits = descriptor.errors.iter().map(|bit| &bit.name);
        bits.chain(descriptor.patterns.iter().map(|pattern| &pattern.name)).map(|name| name.replace(' ', "-")).collect()
    }

    /// Returns whether a transfer shows the fault, given the time of the previous transfer.
    ///
    /// An intermittent fault is present in the second half of its period. If transfers clear the fault, it is shown
    /// once in each period after the initial one, by the first transfer.
    pub(super) fn occurs(&self, at: Moment, before: Option<Moment>) -> bool {
        let Some(period) = self.period else {
            return before.is_none() || !matches!(self.shows, FaultIndication::Bit { cleared: true, .. });
        };
        let period = period.as_nanos().max(1);
        let times = |moment: Moment| moment.since_start().as_nanos() / period;
        match self.shows {
            FaultIndication::Bit { cleared: true, .. } => times(at) > before.map_or(0, times),
            _ => at.since_start().as_nanos() % period >= period / 2,
        }
    }

    pub(super) const fn sent_word(&self) -> Option<u64> {
        match self.shows {
            FaultIndication::Word(word) => Some(word),
            FaultIndication::Bit { .. } => None,
        }
    }

    pub(super) const fn set_flag(&self) -> Flags {
        match self.shows {
            FaultIndication::Bit { index, .. } => Flags::error(index),
            FaultIndication::Word(_) => Flags::NONE,
        }
    }
}

fn find_indication(name: &str, layout: &Layout) -> Option<FaultIndication> {
    let descriptor = layout.descriptor();
    let is_own = |own: &str| own.replace(' ', "-").eq_ignore_ascii_case(name.trim());
    let bits = descriptor.errors.iter().enumerate();
    let mut bits = bits.filter(|(_, bit)| is_own(&bit.name));
    if let Some((index, bit)) = bits.next() {
        return Some(FaultIndication::Bit { index, cleared: bit.cleared_by_transfer });
    }
    let pattern = descriptor.patterns.iter().find(|pattern| is_own(&pattern.name))?;
    Some(FaultIndication::Word(match pattern.word {
        Word::Ones => u64::MAX >> (64 - layout.clock_count().clamp(1, 64)),
        Word::Bits(word) => word,
    }))
}

fn period(seconds: &str) -> Option<Duration> {
    let seconds = seconds.trim().parse().ok();
    seconds.filter(|s| (InjectedFault::MIN_PERIOD..=InjectedFault::MAX_PERIOD).contains(s)).map(Duration::from_secs_f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::{Families, Settings};

    fn layout(text: &str) -> Layout {
        let (key, settings) = Settings::parse(text).unwrap();
        settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
    }

    fn at(milliseconds: u64) -> Moment {
        Moment::from_elapsed(Duration::from_millis(milliseconds))
    }

    #[test]
    fn fault_names_match_layout() {
        let safe = layout("afs60s");
        assert_eq!(InjectedFault::setting_names(&safe), ["ERRDIG", "ERRSI", "ERRSYNC", "safety-fault"]);
        let read = InjectedFault::read("errsi:4, ERRSYNC , Safety-Fault", &safe).unwrap();
        let flags: Vec<Flags> = read.iter().map(InjectedFault::set_flag).collect();
        assert_eq!(flags, [Flags::error(1), Flags::error(2), Flags::NONE]);
        // The word has 21 clocks.
        assert_eq!(read[2].sent_word(), Some(0x1F_FFFF));
        assert_eq!(InjectedFault::read("overspeed-or-gap", &layout("kh53")).unwrap()[0].sent_word(), Some(0xFF_FFFE));
        assert_eq!(InjectedFault::read("", &safe), Some(Vec::new()));
        for text in ["ERRX", "ERRSI:", "ERRSI:0", "ERRSI:-1", "ERRSI:NaN", "ERRSI:1e9"] {
            assert_eq!(InjectedFault::read(text, &safe), None, "{text}");
        }
    }

    #[test]
    fn cleared_errors_depend_on_transfer_interval() {
        let safe = layout("afs60s");
        let one = |text| InjectedFault::read(text, &safe).unwrap()[0];
        let (once, often) = (one("ERRSYNC"), one("ERRSYNC:0.5"));
        assert!(once.occurs(at(0), None) && !once.occurs(at(1), Some(at(0))));
        assert!(!often.occurs(at(499), None) && often.occurs(at(500), None));
        assert!(often.occurs(at(501), Some(at(499))) && !often.occurs(at(502), Some(at(501))));
        let (stands, goes) = (one("ERRSI"), one("ERRSI:2"));
        assert!(stands.occurs(at(0), None) && stands.occurs(at(1), Some(at(0))));
        let seen = [0, 999, 1000, 1999, 2000, 3000].map(|ms| goes.occurs(at(ms), Some(at(0))));
        assert_eq!(seen, [false, false, true, true, false, true]);
    }
}
