//! Device check: runs the start-up sequence of the manual (figures 8 and 9), and rates each step.

use super::fields::separate_value_error;
use super::{
    Error, Identity, LineQuality, Master, UnreadableField, identify, read_analogue, read_position, read_status, reset,
    try_read_field,
};
use crate::devices::hiperface::protocol::{DataFieldStatus, EncoderTypes, Position, StatusCode};

pub use crate::analysis::check::Verdict;

pub type HiperfaceStepResult = crate::analysis::check::StepResult<CheckStep, CheckFinding>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckStep {
    /// Restart (53h), including the waiting times in the manual.
    Restart,
    /// Status codes, read with command 50h until the queue is empty.
    Status,
    /// Type label (52h) and serial number (56h).
    Identity,
    /// Position (42h).
    Position,
    /// Analogue channels (44h) for which the extended label contains a limit.
    Limits,
    /// Status and content (commands 4Ch and 4Ah) of every data field.
    DataFields,
    /// Line errors since the start of the session: repeated requests, and damaged or late replies.
    Line,
}

#[derive(Clone, Debug, PartialEq)]
pub enum CheckFinding {
    Code(StatusCode),
    Position(Position),
    /// Position word, if periods and turns are unknown.
    RawPosition(u32),
    Name(String),
    SerialNumber(String),
    Limit {
        channel: u8,
        value: i16,
        limit: i16,
    },
    Field {
        number: u8,
        status: DataFieldStatus,
    },
    /// Data field whose access code is unknown. Its status contains the number of the code.
    FieldLocked {
        number: u8,
        status: DataFieldStatus,
    },
    FieldRefused {
        number: u8,
        codes: Vec<StatusCode>,
    },
    FieldUnreadable {
        number: u8,
        why: Error,
    },
    Unreadable(Error),
    Line(LineQuality),
}

/// Checks the encoder. The check ends early only if the encoder stops replying. If `restart` is set, the encoder is
/// restarted first (53h), so that its state after power-on is checked.
///
/// # Errors
/// Returns an error if the exchange fails or the job is cancelled.
pub fn check_encoder(
    master: &mut Master<'_>,
    types: &EncoderTypes,
    restart: bool,
) -> Result<Vec<HiperfaceStepResult>, Error> {
    let mut lines = Vec::new();
    let codes = if restart {
        let codes = reset(master)?;
        lines.push(HiperfaceStepResult { step: CheckStep::Restart, verdict: Verdict::Good, findings: Vec::new() });
        codes
    } else {
        read_status(master)?
    };
    lines.push(HiperfaceStepResult {
        step: CheckStep::Status,
        verdict: codes_verdict(&codes),
        findings: code_findings(&codes),
    });
    let identity = identify(master, types)?;
    let known = if identity.geometry.is_some() { Verdict::Good } else { Verdict::Attention };
    let findings = vec![
        CheckFinding::Name(identity.name.clone()),
        CheckFinding::SerialNumber(identity.serial.serial_number.clone()),
    ];
    lines.push(HiperfaceStepResult { step: CheckStep::Identity, verdict: known, findings });
    lines.push(check_position(master, &identity)?);
    lines.extend(check_limits(master, &identity)?);
    lines.push(check_fields(master, &identity)?);
    lines.push(check_line(master));
    Ok(lines)
}

fn check_position(master: &mut Master<'_>, identity: &Identity) -> Result<HiperfaceStepResult, Error> {
    let step = CheckStep::Position;
    let reading = read_position(master, identity.geometry);
    match separate_value_error(master, reading)? {
        Ok(reading) => {
            let mut findings = vec![match reading.position {
                Some(position) => CheckFinding::Position(position),
                None => CheckFinding::RawPosition(reading.raw),
            }];
            findings.extend(code_findings(&reading.codes));
            let verdict = if reading.valid { codes_verdict(&reading.codes) } else { Verdict::Bad };
            Ok(HiperfaceStepResult { step, verdict, findings })
        }
        Err(Error::Rejected { codes, .. }) => {
            Ok(HiperfaceStepResult { step, verdict: Verdict::Bad, findings: code_findings(&codes) })
        }
        Err(why) => {
            Ok(HiperfaceStepResult { step, verdict: Verdict::Bad, findings: vec![CheckFinding::Unreadable(why)] })
        }
    }
}

/// Compares the analogue channels with their limits on the extended label. Channels that the encoder rejects are
/// omitted.
fn check_limits(master: &mut Master<'_>, identity: &Identity) -> Result<Option<HiperfaceStepResult>, Error> {
    let Some(label) = identity.extended_label() else { return Ok(None) };
    let mut findings = Vec::new();
    let mut worst = Verdict::Good;
    for (channel, limit) in label.limits() {
        let value = read_analogue(master, channel);
        match separate_value_error(master, value)? {
            Ok(value) => {
                if value > limit {
                    worst = worst.max(Verdict::Attention);
                }
                findings.push(CheckFinding::Limit { channel, value, limit });
            }
            // The encoder does not have the channel.
            Err(Error::Rejected { .. }) => {}
            Err(why) => {
                worst = Verdict::Bad;
                findings.push(CheckFinding::Unreadable(why));
            }
        }
    }
    Ok((!findings.is_empty()).then_some(HiperfaceStepResult { step: CheckStep::Limits, verdict: worst, findings }))
}

fn check_fields(master: &mut Master<'_>, identity: &Identity) -> Result<HiperfaceStepResult, Error> {
    let mut findings = Vec::new();
    let mut verdict = Verdict::Good;
    for number in 0..identity.memory.map_or(0, |memory| memory.fields) {
        match try_read_field(master, number)? {
            Ok(field) if field.bytes.is_some() => findings.push(CheckFinding::Field { number, status: field.status }),
            Ok(field) => {
                findings.push(CheckFinding::FieldLocked { number, status: field.status });
                verdict = verdict.max(Verdict::Attention);
            }
            Err(UnreadableField { why: Error::Rejected { codes, .. }, .. }) => {
                findings.push(CheckFinding::FieldRefused { number, codes });
                verdict = Verdict::Bad;
            }
            Err(UnreadableField { why, .. }) => {
                findings.push(CheckFinding::FieldUnreadable { number, why });
                verdict = Verdict::Bad;
            }
        }
    }
    Ok(HiperfaceStepResult { step: CheckStep::DataFields, verdict, findings })
}

/// Rates the line. Repeated requests mean that the line works, but that its wiring needs attention.
fn check_line(master: &mut Master<'_>) -> HiperfaceStepResult {
    let quality = master.station().line.quality.clone();
    let verdict = if quality.has_errors() { Verdict::Attention } else { Verdict::Good };
    HiperfaceStepResult { step: CheckStep::Line, verdict, findings: vec![CheckFinding::Line(quality)] }
}

fn codes_verdict(codes: &[StatusCode]) -> Verdict {
    if codes.is_empty() {
        Verdict::Good
    } else if codes.iter().all(|code| code.is_warning()) {
        Verdict::Attention
    } else {
        Verdict::Bad
    }
}

fn code_findings(codes: &[StatusCode]) -> Vec<CheckFinding> {
    codes.iter().copied().map(CheckFinding::Code).collect()
}
