//! Checks the gateway, the IN word and the encoder, with a verdict for each step. The handshake is only tested with
//! read-outs, because setting a value would use an EEPROM write cycle.

use std::time::Duration;

use super::error::ImplausibleValue;
use super::identify::read_survey;
use super::{Error, Identity, Master, Survey};
use crate::analysis::check;
use crate::devices::interbus::protocol::{ErrorWord, ReadOutNumber, Reply, StartupMode};

pub use crate::analysis::check::{CycleCount, MemoryWear, Verdict};

pub type InterbusStepResult = check::StepResult<CheckStep, CheckFinding>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStep {
    Gateway,
    /// Order of the two halves of a word.
    WordOrder,
    /// The IN word before any request: a position, cam outputs or an error.
    InputWord,
    /// Identity of the encoder, and whether its steps and turns are plausible.
    Identity,
    /// Read-outs, to show that the encoder receives OUT words and that its replies arrive.
    Handshake,
    Temperature,
    Wear,
}

#[derive(Clone, Debug, PartialEq)]
pub enum CheckFinding {
    /// The number of IN word readings and the longest reply time.
    Replies {
        requested: u32,
        /// Longest reply time in milliseconds.
        slowest_ms: u64,
    },
    /// Words are plausible in the configured order.
    OrderFits,
    /// Words are plausible only with their halves swapped.
    OrderSwapped {
        input: u32,
        swapped: u32,
    },
    Runs(u32),
    /// Bits that should be 0 are set.
    StrayBits(u32),
    Error(ErrorWord),
    /// The encoder is being parameterised or read out, presumably by another master.
    Occupied(u32),
    SerialNumber(String),
    SoftwareVersion(u32),
    Gear {
        /// Number of steps over all turns.
        steps: u32,
        turns: u32,
    },
    Implausible(ImplausibleValue),
    PresetBeyond {
        preset: u32,
        last: u32,
    },
    /// The encoder reports its number of steps minus one.
    StepsMinusOne,
    Mode(StartupMode),
    ReadOuts {
        requested: u64,
        /// Average duration of a read-out in milliseconds.
        each_ms: u64,
    },
    Failed(Error),
    /// Temperature in tenths of a degree Celsius.
    Temperature(i32),
    Wear {
        /// Minimum number of EEPROM write cycles so far.
        seen: CycleCount,
        limit: u64,
    },
}

/// Number of IN word readings used to measure the reply time of the gateway.
const READING_COUNT: u32 = 20;
/// Assumed temperature limits of the electronics in tenths of a degree Celsius. The manual states none (`U`).
const TEMPERATURE_RANGE: std::ops::RangeInclusive<i32> = -400..=850;

/// Runs the device check. `wear` is called once the encoder has been identified.
///
/// # Errors
/// Returns an error if the gateway does not reply or the check is cancelled. Errors of the handshake are reported as
/// findings.
pub fn check_encoder(
    master: &mut Master<'_>,
    wear: impl FnOnce(&Identity) -> MemoryWear,
    progress: &mut dyn FnMut(u64, u64, ReadOutNumber),
) -> Result<Vec<InterbusStepResult>, Error> {
    let (mut lines, is_free) = check_in_word(master)?;
    if !is_free {
        // A further request would disturb another master or be written in the wrong word order.
        return Ok(lines);
    }
    let begun = master.now();
    match master.run_guarded(|master| read_survey(master, progress)) {
        Ok(survey) => {
            let requested = survey.read_outs().count() as u64;
            let each_ms = master.now().duration_since(begun).as_millis() as u64 / requested.max(1);
            lines.push(InterbusStepResult::new(
                CheckStep::Handshake,
                vec![(Verdict::Good, CheckFinding::ReadOuts { requested, each_ms })],
            ));
            lines.push(identity(&survey));
            lines.push(temperature(survey.temperature_tenths));
            lines.extend(wear_result(wear(&survey.identity)));
        }
        Err(error) if error.is_lost() || error.is_cancelled() => return Err(error),
        Err(error) => {
            lines.push(InterbusStepResult::new(CheckStep::Handshake, vec![(Verdict::Bad, CheckFinding::Failed(error))]))
        }
    }
    Ok(lines)
}

/// Reads the IN word several times without sending anything else. Also returns whether it is safe to send further
/// requests.
fn check_in_word(master: &mut Master<'_>) -> Result<(Vec<InterbusStepResult>, bool), Error> {
    let (mut slowest, mut word) = (Duration::ZERO, 0);
    for _ in 0..READING_COUNT {
        let begun = master.now();
        word = master.read_in_word()?.word;
        slowest = slowest.max(master.now().duration_since(begun));
    }
    let slowest_ms = slowest.as_millis() as u64;
    let answers = InterbusStepResult::new(
        CheckStep::Gateway,
        vec![(Verdict::Good, CheckFinding::Replies { requested: READING_COUNT, slowest_ms })],
    );
    let (order, fits) = match master.swapped_word_order(word)? {
        Some(swapped) => ((Verdict::Bad, CheckFinding::OrderSwapped { input: word, swapped }), false),
        None => ((Verdict::Good, CheckFinding::OrderFits), true),
    };
    let (input, free) = match Reply::parse(word) {
        Reply::Run { stray: 0, .. } => ((Verdict::Good, CheckFinding::Runs(word)), true),
        Reply::Run { .. } => ((Verdict::Attention, CheckFinding::StrayBits(word)), true),
        Reply::Error(error) => ((Verdict::Bad, CheckFinding::Error(error)), true),
        Reply::ReadOut(_) | Reply::UnknownReadOut(_) => ((Verdict::Attention, CheckFinding::Occupied(word)), false),
        Reply::Echo { .. } | Reply::Busy { .. } | Reply::Unknown { .. } => {
            ((Verdict::Bad, CheckFinding::Occupied(word)), false)
        }
    };
    let lines = vec![
        answers,
        InterbusStepResult::new(CheckStep::WordOrder, vec![order]),
        InterbusStepResult::new(CheckStep::InputWord, vec![input]),
    ];
    Ok((lines, fits && free))
}

fn identity(survey: &Survey) -> InterbusStepResult {
    let identity = &survey.identity;
    let mut findings = vec![
        (Verdict::Good, CheckFinding::SerialNumber(identity.serial_number.clone())),
        (Verdict::Good, CheckFinding::SoftwareVersion(identity.software_version)),
        (Verdict::Good, CheckFinding::Mode(identity.mode)),
    ];
    match identity.gear() {
        Ok(gear) => {
            findings.push((Verdict::Good, CheckFinding::Gear { steps: gear.total_steps(), turns: gear.turns() }));
            let (preset, last) = (survey.parameters.preset, gear.total_steps() - 1);
            if preset > last {
                findings.push((Verdict::Attention, CheckFinding::PresetBeyond { preset, last }));
            }
        }
        Err(why) => findings.push((Verdict::Bad, CheckFinding::Implausible(why))),
    }
    if identity.flags.steps_minus_one() {
        findings.push((Verdict::Attention, CheckFinding::StepsMinusOne));
    }
    InterbusStepResult::new(CheckStep::Identity, findings)
}

fn temperature(tenths: i32) -> InterbusStepResult {
    let verdict = if TEMPERATURE_RANGE.contains(&tenths) { Verdict::Good } else { Verdict::Attention };
    InterbusStepResult::new(CheckStep::Temperature, vec![(verdict, CheckFinding::Temperature(tenths))])
}

fn wear_result(wear: MemoryWear) -> Option<InterbusStepResult> {
    let (verdict, seen) = wear.verdict()?;
    Some(InterbusStepResult::new(CheckStep::Wear, vec![(verdict, CheckFinding::Wear { seen, limit: wear.limit })]))
}
