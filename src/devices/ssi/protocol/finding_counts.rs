//! Counts of findings in frames. Every frame must be counted, because the next transfer clears some error bits.

use super::explain::FrameFinding;
use super::layout::{Flags, FrameReading, Layout};
use crate::analysis::SampleTime;

/// Counters for the findings in consecutive frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FindingCounts {
    noted: Vec<CountedFinding>,
    /// Flags of the previous frame, and the indices of their findings in `noted`.
    before: (Flags, Vec<usize>),
}

/// A finding with the number and times of its occurrences.
#[derive(Clone, Debug, PartialEq)]
pub struct CountedFinding {
    /// Finding that was counted.
    pub finding: FrameFinding,
    /// Number of occurrences. A finding about a single transfer is counted in every frame, and any other finding each
    /// time it begins.
    pub count: u64,
    /// Time of the first frame with the finding.
    pub first: SampleTime,
    /// Time of the last frame with the finding.
    pub last: SampleTime,
    /// Whether the newest frame has the finding.
    pub is_active: bool,
}

impl FindingCounts {
    /// Counts the findings of a frame, and returns those that are new since the previous frame.
    ///
    /// `layout` must be the layout of all frames since the last [`reset`](Self::reset).
    pub fn count_findings(&mut self, layout: &Layout, reading: FrameReading, at: SampleTime) -> Vec<FrameFinding> {
        let (flags, same) = &self.before;
        if *flags == reading.flags {
            for index in same {
                if let Some(noted) = self.noted.get_mut(*index) {
                    noted.last = at;
                    noted.count += u64::from(is_single_transfer_finding(&noted.finding));
                }
            }
            return Vec::new();
        }
        let mut begun = Vec::new();
        let mut now = Vec::new();
        for finding in layout.to_findings(reading) {
            let known = self.noted.iter().position(|noted| noted.finding == finding);
            let index = known.unwrap_or_else(|| {
                self.noted.push(CountedFinding {
                    finding: finding.clone(),
                    count: 0,
                    first: at,
                    last: at,
                    is_active: false,
                });
                self.noted.len() - 1
            });
            now.push(index);
            let Some(noted) = self.noted.get_mut(index) else { continue };
            noted.last = at;
            noted.count += u64::from(!noted.is_active || is_single_transfer_finding(&finding));
            if !noted.is_active {
                begun.push(finding);
            }
        }
        for (index, noted) in self.noted.iter_mut().enumerate() {
            noted.is_active = now.contains(&index);
        }
        self.before = (reading.flags, now);
        begun
    }

    /// Returns the findings since the last [`reset`](Self::reset), ordered by their first frame.
    pub fn finding_counts(&self) -> &[CountedFinding] {
        &self.noted
    }

    /// Ends all current findings, because names in the layout have changed. Findings in the next frame count as new
    /// occurrences.
    pub fn rename(&mut self) {
        self.noted.iter_mut().for_each(|noted| noted.is_active = false);
        self.before = (Flags::NONE, Vec::new());
    }

    /// Removes all counts. Findings in the next frame count as new.
    pub fn reset(&mut self) {
        *self = FindingCounts::default();
    }
}

/// Returns whether a finding concerns only a single transfer. Such a finding is counted in every frame.
fn is_single_transfer_finding(finding: &FrameFinding) -> bool {
    matches!(
        finding,
        FrameFinding::Error { cleared_by_transfer: true, .. } | FrameFinding::Parity | FrameFinding::Repeat
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::{Families, Settings};

    fn layout(text: &str) -> Layout {
        let (key, settings) = Settings::parse(text).unwrap();
        settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
    }

    fn at(milliseconds: i64) -> SampleTime {
        SampleTime::from_nanoseconds(milliseconds * 1_000_000)
    }

    /// Returns the name, the count, the times of the first and last frame in milliseconds, and whether the newest frame
    /// has the finding.
    fn rows(tally: &FindingCounts) -> Vec<(String, u64, i64, i64, bool)> {
        let name = |finding: &FrameFinding| match finding {
            FrameFinding::Error { name, .. } | FrameFinding::Pattern { name, .. } => name.clone(),
            other => format!("{other:?}"),
        };
        let milliseconds = |time: SampleTime| time.as_nanoseconds() / 1_000_000;
        let row = |noted: &CountedFinding| {
            (name(&noted.finding), noted.count, milliseconds(noted.first), milliseconds(noted.last), noted.is_active)
        };
        tally.finding_counts().iter().map(row).collect()
    }

    /// Frames of an AFS60 from reference section 8, with 18 position bits followed by ERRDIG, ERRSI and ERRSYNC.
    #[test]
    fn counts_static_errors_once() {
        let layout = layout("afs60");
        let mut tally = FindingCounts::default();
        let good = 0x15_5E68;
        let frames = [good, good | 1, good | 1, good | 3, good | 2, good, good | 2];
        let begun: Vec<usize> = (0..)
            .zip(frames)
            .map(|(number, frame)| tally.count_findings(&layout, layout.decode(frame), at(10 * number)).len())
            .collect();
        assert_eq!(begun, [0, 1, 0, 1, 0, 0, 1]);
        let [sync, light] = ["ERRSYNC", "ERRSI"].map(str::to_owned);
        assert_eq!(rows(&tally), [(sync, 3, 10, 30, false), (light.clone(), 2, 30, 60, true)]);
        tally.reset();
        assert_eq!(tally.finding_counts(), []);
        assert_eq!(tally.count_findings(&layout, layout.decode(good | 2), at(70)).len(), 1, "it stands still");
        assert_eq!(rows(&tally), [(light, 1, 70, 70, true)]);
    }

    #[test]
    fn counts_fault_patterns_and_padding_errors() {
        let kh53 = layout("kh53");
        let mut tally = FindingCounts::default();
        for (number, frame) in (0..).zip([5, 0xFF_FFFE, 0xFF_FFFE, 5, 0xFF_FFFE]) {
            tally.count_findings(&kh53, kh53.decode(frame), at(number));
        }
        assert_eq!(rows(&tally), [("overspeed or gap".to_owned(), 2, 1, 4, true)]);
        // An ATM60 in tree format with 8 of 12 turn bits. One of the zeros before them is received as a 1.
        let tree = layout("atm60,mt=8,st=8");
        let mut tally = FindingCounts::default();
        tally.count_findings(&tree, tree.decode(0x14A_780 | 1 << 24), at(0));
        assert_eq!(rows(&tally), [("Padding".to_owned(), 1, 0, 0, true)]);
    }
}
