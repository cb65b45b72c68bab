//! Device check of the adapter, the encoder supply and a series of words. The words are compared with the layout.
//! Nothing is written, because the encoder has no memory.

use std::collections::BTreeSet;

use super::{Error, Identity, Master};
use crate::analysis::check;
use crate::devices::ssi::protocol::{BitMeaning, Flags, FrameFinding, Layout};

pub use crate::analysis::check::Verdict;

pub const WORD_COUNT: u64 = 50;
/// Maximum jitter of the position at standstill, in steps. One or two steps are normal.
const MAX_JITTER_STEPS: u64 = 4;

pub type SsiStepResult = check::StepResult<CheckStep, CheckFinding>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStep {
    Adapter,
    Supply,
    Line,
    Layout,
    Errors,
    Motion,
}

#[derive(Clone, Debug, PartialEq)]
pub enum CheckFinding {
    Adapter(String, String),
    /// Requested and actual clock frequency in hertz.
    Clock {
        asked: u32,
        got: u32,
    },
    /// Requested and measured supply voltage in millivolts, and supply current in milliamperes.
    Supply {
        requested: u16,
        measured: u16,
        milliampere: u16,
    },
    SuppliedElsewhere,
    Words {
        taken: u64,
        different: usize,
    },
    /// A finding about `count` of the words.
    FindingInWords {
        finding: FrameFinding,
        count: u64,
    },
    Fits,
    /// No error bit is active.
    Silent,
    Stands {
        position: u64,
        /// Largest distance between the first position and any other one, in steps.
        steps: u64,
    },
    Turns {
        /// Largest distance between consecutive positions in steps, measured in the shorter direction.
        most: u64,
    },
}

/// Reads a series of SSI words and checks them.
///
/// # Errors
/// Returns an error from the adapter if no words arrive.
pub fn check_encoder(
    master: &mut Master<'_>,
    layout: &Layout,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Vec<SsiStepResult>, Error> {
    let identity = master.identify()?;
    let mut words = Vec::new();
    for done in 0..WORD_COUNT {
        progress(done, WORD_COUNT);
        words.extend(master.next_word()?.words);
    }
    Ok(check_words(&identity, layout, &words))
}

fn check_words(identity: &Identity, layout: &Layout, words: &[u64]) -> Vec<SsiStepResult> {
    let mut counted: Vec<(FrameFinding, u64)> = Vec::new();
    let mut positions = Vec::new();
    for word in words {
        let reading = layout.decode(*word);
        if !reading.flags.contains(Flags::CODE) {
            positions.push(reading.position);
        }
        for finding in layout.to_findings(reading) {
            match counted.iter_mut().find(|(own, _)| *own == finding) {
                Some((_, count)) => *count += 1,
                None => counted.push((finding, 1)),
            }
        }
    }
    let different = words.iter().collect::<BTreeSet<_>>().len();
    let taken = CheckFinding::Words { taken: words.len() as u64, different };
    let among = |wanted: fn(&FrameFinding) -> bool| {
        let wanted = counted.iter().filter(move |(what, _)| wanted(what));
        wanted.map(|(what, count)| CheckFinding::FindingInWords { finding: what.clone(), count: *count })
    };
    let verdict = |wanted: fn(&FrameFinding) -> bool| {
        let worst = counted.iter().filter(|(what, _)| wanted(what)).map(|(what, _)| match what.meaning() {
            BitMeaning::Invalid => Verdict::Bad,
            BitMeaning::Warning => Verdict::Attention,
        });
        worst.max().unwrap_or(Verdict::Good)
    };
    let is_stuck = |what: &FrameFinding| matches!(what, FrameFinding::StuckHigh { .. } | FrameFinding::StuckLow { .. });
    let is_of_the_form = |what: &FrameFinding| {
        matches!(what, FrameFinding::Code | FrameFinding::Padding | FrameFinding::Parity | FrameFinding::Repeat)
    };
    let is_error = |what: &FrameFinding| matches!(what, FrameFinding::Error { .. } | FrameFinding::Pattern { .. });
    let or = |findings: Vec<CheckFinding>, none: CheckFinding| if findings.is_empty() { vec![none] } else { findings };
    // A wrong layout is a fault, even if its findings are only warnings.
    let form = verdict(is_of_the_form);
    let form = if form == Verdict::Good { Verdict::Good } else { Verdict::Bad };
    vec![
        check_adapter(identity),
        check_supply(identity),
        SsiStepResult {
            step: CheckStep::Line,
            verdict: verdict(is_stuck),
            findings: std::iter::once(taken).chain(among(is_stuck)).collect(),
        },
        SsiStepResult {
            step: CheckStep::Layout,
            verdict: form,
            findings: or(among(is_of_the_form).collect(), CheckFinding::Fits),
        },
        SsiStepResult {
            step: CheckStep::Errors,
            verdict: verdict(is_error),
            findings: or(among(is_error).collect(), CheckFinding::Silent),
        },
        motion(layout, &positions),
    ]
}

fn check_adapter(identity: &Identity) -> SsiStepResult {
    let Identity { hello, clock_settings, clock_hz, .. } = identity;
    let verdict = if *clock_hz == clock_settings.clock_hz { Verdict::Good } else { Verdict::Attention };
    let who = CheckFinding::Adapter(hello.name.clone(), hello.firmware.clone());
    SsiStepResult {
        step: CheckStep::Adapter,
        verdict,
        findings: vec![who, CheckFinding::Clock { asked: clock_settings.clock_hz, got: *clock_hz }],
    }
}

fn check_supply(identity: &Identity) -> SsiStepResult {
    let supplied = identity.supply.and_then(|supply| Some((supply.millivolt, supply.measured?)));
    let (verdict, finding) = match supplied {
        Some((requested, (measured, milliampere))) => {
            // Encoders for 5 V have a tolerance of 10 %.
            let is_near = measured.abs_diff(requested) <= requested / 10;
            let verdict = if is_near && milliampere > 0 { Verdict::Good } else { Verdict::Attention };
            (verdict, CheckFinding::Supply { requested, measured, milliampere })
        }
        None => (Verdict::Good, CheckFinding::SuppliedElsewhere),
    };
    SsiStepResult { step: CheckStep::Supply, verdict, findings: vec![finding] }
}

/// Evaluates the motion of the shaft from the distances between positions. Each distance is measured in the shorter
/// direction.
fn motion(layout: &Layout, positions: &[u64]) -> SsiStepResult {
    let all = u128::from(layout.position_code().last_position()) + 1;
    let apart = |one: u64, other: u64| {
        let apart = u128::from(one.abs_diff(other));
        u64::try_from(apart.min(all - apart)).unwrap_or(u64::MAX)
    };
    let steps = positions.iter().zip(positions.iter().skip(1)).map(|(one, other)| apart(*one, *other));
    let most = steps.max().unwrap_or(0);
    let spread = positions
        .first()
        .map_or(0, |first| positions.iter().map(|position| apart(*first, *position)).max().unwrap_or(0));
    let (verdict, finding) = match positions.last() {
        None => return SsiStepResult { step: CheckStep::Motion, verdict: Verdict::Bad, findings: Vec::new() },
        Some(position) if spread <= MAX_JITTER_STEPS => {
            (Verdict::Good, CheckFinding::Stands { position: *position, steps: spread })
        }
        // No shaft turns by more than a quarter of the range from one word to the next.
        Some(_) if u128::from(most) * 4 > all => (Verdict::Attention, CheckFinding::Turns { most }),
        Some(_) => (Verdict::Good, CheckFinding::Turns { most }),
    };
    SsiStepResult { step: CheckStep::Motion, verdict, findings: vec![finding] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buses::bridge::protocol::{Capabilities, Hello};
    use crate::devices::ssi::procedures::{ClockSettings, Supply};
    use crate::devices::ssi::protocol::{Families, Settings};

    fn layout(text: &str) -> Layout {
        let (key, settings) = Settings::parse(text).unwrap();
        settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
    }

    fn identity(clock_hz: u32, supply: Option<Supply>) -> Identity {
        let hello = Hello {
            firmware: "1.0".to_owned(),
            capabilities: Capabilities::SSI,
            max_clock_hz: 1_000_000,
            max_sample_hz: 0,
            name: "bench".to_owned(),
            serial: "7".to_owned(),
        };
        Identity { hello, clock_settings: ClockSettings::default(), clock_hz, supply }
    }

    fn verdicts(lines: &[SsiStepResult]) -> Vec<Verdict> {
        lines.iter().map(|line| line.verdict).collect()
    }

    use Verdict::{Attention, Bad, Good};

    /// Frames of an AFS60 from reference section 8: 18 binary bits, with ERRDIG, ERRSI and ERRSYNC on the last clocks.
    #[test]
    fn judges_words_step_by_step() {
        let layout = layout("afs60");
        let good = 0x15_5E68;
        let judged = |words: &[u64]| verdicts(&check_words(&identity(400_000, None), &layout, words));
        assert_eq!(judged(&[good, good + 8, good]), [Good; 6]);
        assert_eq!(judged(&[good, good | 1]), [Good, Good, Good, Good, Bad, Good]);
        assert_eq!(judged(&[0x1F_FFFF; 3]), [Good, Good, Bad, Good, Bad, Good], "every bit is 1");
        assert_eq!(judged(&[0x10 << 3, 0x2_0010 << 3]), [Good, Good, Good, Good, Good, Attention], "half a turn");
        let lines = check_words(&identity(400_000, None), &layout, &[good, good + 8]);
        assert_eq!(lines[5].findings, [CheckFinding::Stands { position: 0x2_ABCE, steps: 1 }]);
        assert_eq!(lines[2].findings, [CheckFinding::Words { taken: 2, different: 2 }]);
    }

    #[test]
    fn reports_wrong_layout_as_bad() {
        // The layout expects zeros after 12 bits, but the AHS36 sends 14 position bits.
        let words = [0x2A5B << 1, 0x2A5C << 1, 0x2A5F << 1];
        let lines = check_words(&identity(400_000, None), &layout("ahs36,st=12"), &words);
        assert_eq!(lines[3].verdict, Bad);
        assert_eq!(lines[3].findings, [CheckFinding::FindingInWords { finding: FrameFinding::Padding, count: 2 }]);
        assert_eq!(check_words(&identity(400_000, None), &layout("ahs36"), &words)[3].findings, [CheckFinding::Fits]);
    }

    #[test]
    fn judges_adapter_and_supply() {
        let judged = |clock_hz, measured: Option<(u16, u16)>| {
            let supply = Some(Supply { millivolt: 5_000, measured });
            verdicts(&check_words(&identity(clock_hz, supply), &layout("afs60"), &[0x15_5E68]))[..2].to_vec()
        };
        assert_eq!(judged(400_000, Some((4_950, 60))), [Good, Good]);
        assert_eq!(judged(333_333, Some((4_300, 60))), [Attention, Attention]);
        assert_eq!(judged(400_000, Some((5_000, 0))), [Good, Attention], "nothing draws current");
        assert_eq!(judged(400_000, None), [Good, Good]);
    }
}
