//! Messages about writes: changes, planned operations, planning errors, results, causes of an interruption, and the
//! resulting state of the encoder.

use std::path::Path;

use super::encoder_error_text;
use super::guide::{blocker_text, mode_text, procedure_step_text, speed_range_text, task_text, temperature_range_text};
use super::plan::procedure_kind_text;
use crate::app::explain::literal_text;
use crate::app::review::{ChangeDescription, OperationDescription};
use crate::app::{Severity, Text};
use crate::bits::hex;
use crate::devices::biss::jobs::{Change, ChangeKind, Prepared, WEAR_LIMIT};
use crate::devices::biss::procedures::procedure::{Activity, Failure, LeftState, MotorRun};
use crate::devices::biss::procedures::write::{InterruptedWrite, WrittenValues};
use crate::devices::biss::profile::{Op, PresetParts, RegisterChange, RegisterRange};
use crate::devices::biss::protocol::{CalibrationStatus, Layout, PresetValue, WiegandStatus};
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::format::filter;

pub fn change_text(change: &Change) -> Text {
    match change {
        Change::Restore { profile, .. } => Text::new("change.restore").with("serial", &profile.identity.serial_number),
        Change::Write(edits) => {
            let bytes: usize = edits.iter().map(|(_, bytes)| bytes.len()).sum();
            TEXTS.text(if bytes == 1 { "change.store_one" } else { "change.store" }).with("bytes", bytes)
        }
        Change::SelectFilter(to) => TEXTS.text("biss_change.filter").with_text("filter", filter(*to)),
        Change::Preset { parts: None, .. } => TEXTS.text("biss_change.store_preset"),
        Change::Preset { .. } => TEXTS.text("biss_change.fire_preset"),
        Change::Guided { .. } => TEXTS.text("biss_change.guided"),
    }
}

pub fn operation_texts(op: &Op, layout: &Layout) -> OperationDescription {
    let bits = layout.singleturn_bits();
    match op {
        Op::StoreData { area, registers } => OperationDescription {
            item: TEXTS.text("biss_op.data").with_text("area", super::name_text(&area.name)),
            changes: register_run_texts(registers),
        },
        Op::StorePreset { from, to } => OperationDescription::single(
            TEXTS.text("biss_op.preset"),
            preset_value_text(*from, bits),
            preset_value_text(*to, bits),
        ),
        Op::FirePreset { parts, value } => {
            let new = match parts {
                PresetParts::Both => preset_value_text(*value, bits),
                PresetParts::Singleturn => preset_text("biss_op.singleturn", *value, bits),
                PresetParts::Multiturn => preset_text("biss_op.multiturn", *value, bits),
            };
            OperationDescription::single(TEXTS.text("biss_op.fire"), TEXTS.text("biss_op.place"), new)
        }
        Op::SelectFilter { from, to } => {
            OperationDescription::single(TEXTS.text("biss_op.filter"), filter(*from), filter(*to))
        }
        Op::Calibrate => OperationDescription::single(
            TEXTS.text("guide.calibration"),
            TEXTS.text("biss_op.present_table"),
            TEXTS.text("biss_op.new_table"),
        ),
        Op::WiegandTest { save } => OperationDescription::single(
            TEXTS.text("guide.wiegand"),
            TEXTS.text("biss_op.last_result"),
            TEXTS.text(if *save { "biss_op.saved_result" } else { "biss_op.fresh_result" }),
        ),
        Op::WriteRegister { address, old, new, .. } => OperationDescription::single(
            TEXTS.text("biss_op.register").with("address", address),
            old.map_or_else(|| TEXTS.text("biss_op.not_readable"), |old| literal_text(format!("{old:02X}"))),
            literal_text(format!("{new:02X}")),
        ),
    }
}

/// Returns one line for each run of consecutive registers.
fn register_run_texts(registers: &[RegisterChange]) -> Vec<ChangeDescription> {
    let words = |range: RegisterRange| {
        let own = registers.iter().filter(|own| range.contains(own.address));
        let (old, new): (Vec<u8>, Vec<u8>) = own.map(|own| (own.old, own.new)).unzip();
        ChangeDescription {
            part: Some(literal_text(range)),
            old: literal_text(hex(&old)),
            new: literal_text(hex(&new)),
        }
    };
    RegisterRange::from_addresses(registers.iter().map(|own| own.address)).into_iter().map(words).collect()
}

/// Formats a preset value as angle, step and turn. The angle depends on the width of the singleturn position.
pub fn preset_value_text(value: PresetValue, singleturn_bits: u8) -> Text {
    preset_text("biss_op.preset_value", value, singleturn_bits)
}

fn preset_text(id: &'static str, value: PresetValue, singleturn_bits: u8) -> Text {
    let steps = (1_u64 << singleturn_bits) as f64;
    TEXTS
        .text(id)
        .with_number("degrees", f64::from(value.singleturn()) * 360.0 / steps, 3)
        .with("singleturn", value.singleturn())
        .with("multiturn", value.multiturn())
}

/// Returns the warning about the limited write cycles of the flash, or `None` if enough of them remain after the plan.
pub fn wear_warning(prepared: &Prepared) -> Option<Text> {
    let cycles = prepared.wear_to_report()?;
    Some(TEXTS.text("biss_review.wear").with("cycles", cycles).with("limit", WEAR_LIMIT))
}

pub fn written_text(written: &WrittenValues) -> Text {
    // Only the encoder's status confirms a calibration.
    let id = if written.verified == 0 { "biss_review.done" } else { "review.verified" };
    TEXTS.text(id).with("verified", written.verified).with("cycles", written.write_cycles)
}

/// Returns the messages for an interrupted write: the progress, the cause, the resulting state of the encoder, and the
/// location of the backup.
pub(super) fn interruption_text(
    interrupted: &InterruptedWrite,
    backup: &Path,
    planned: usize,
    kind: ChangeKind,
) -> Vec<Text> {
    let done = &interrupted.done;
    let mut texts = vec![if interrupted.cause.is_cancelled() {
        Text::new("write.cancelled").with("done", done.ops).with("planned", planned)
    } else {
        let text = Text::new("write.interrupted").with("done", done.ops).with("planned", planned);
        text.with_text("cause", failure_text(&interrupted.cause))
    }];
    texts.push(TEXTS.text("biss_left.at").with_text("step", procedure_step_text(interrupted.end_state.at)));
    texts.extend(match &interrupted.end_state.standing {
        None => vec![TEXTS.text("biss_left.operation")],
        Some(standing) => left_state_texts(standing),
    });
    let what_next = match (interrupted.uncertain_write(), kind) {
        (Some(register), _) => TEXTS.text("biss_write.unclear").with("register", register),
        // The table may be lost even without a write, and no backup contains it.
        (None, ChangeKind::Calibration) => TEXTS.text("write.backup_calibration"),
        // An operation that may have been executed counts as a write cycle if it costs one.
        _ if done.write_cycles == 0 && done.written == 0 => Text::new("write.untouched"),
        (None, ChangeKind::Restore) => Text::new("write.backup"),
        (None, ChangeKind::Bytes) => TEXTS.text("biss_write.bytes"),
        (None, ChangeKind::Guided) => TEXTS.text("biss_write.guided"),
        (None, ChangeKind::WiegandTest) => TEXTS.text("biss_write.wiegand"),
        (None, ChangeKind::Filter) => TEXTS.text("biss_write.filter"),
        (None, ChangeKind::Preset) => TEXTS.text("biss_write.preset"),
    };
    let what_next = what_next.with("backup", backup.display());
    texts.push(match &interrupted.end_state.standing {
        None => what_next,
        Some(_) => Text::new("write.after_lead_back").with_text("next", what_next),
    });
    texts
}

pub fn severity_of(text: &Text) -> Severity {
    match text.id() {
        "biss_left.operation" => Severity::Good,
        "biss_left.at"
        | "write.after_lead_back"
        | "write.backup"
        | "write.backup_calibration"
        | "write.untouched"
        | "biss_write.bytes"
        | "biss_write.guided"
        | "biss_write.wiegand"
        | "biss_write.filter"
        | "biss_write.preset" => Severity::Note,
        "write.cancelled" | "biss_write.unclear" => Severity::Warning,
        _ => Severity::Error,
    }
}

/// Returns the messages for an encoder that could not be returned to operation mode.
fn left_state_texts(standing: &LeftState) -> Vec<Text> {
    let mut texts = vec![match standing.mode.as_slice() {
        [certain] => TEXTS.text("biss_left.mode").with_text("mode", mode_text(*certain)),
        several => TEXTS.text("biss_left.modes").with_list("modes", several.iter().map(|own| mode_text(*own))),
    }];
    if standing.password.may_equal(true) {
        texts.push(TEXTS.text("biss_left.password"));
    }
    texts.extend(match standing.activity {
        Activity::Nothing => None,
        Activity::Running(MotorRun::CalibrationCounterclockwise) => Some(TEXTS.text("biss_left.calibrating_ccw")),
        Activity::Running(MotorRun::CalibrationClockwise) => Some(TEXTS.text("biss_left.calibrating_cw")),
        Activity::Running(_) => Some(TEXTS.text("biss_left.testing")),
        Activity::Entered => Some(TEXTS.text("biss_left.entered")),
        Activity::Saving => Some(TEXTS.text("biss_left.saving")),
        Activity::Restarting => Some(TEXTS.text("biss_left.restarting")),
    });
    texts.push(TEXTS.text("biss_left.lead_back"));
    texts
}

pub fn failure_text(failure: &Failure) -> Text {
    match failure {
        Failure::Device(error) => encoder_error_text(error),
        Failure::Calibration { run, status } => calibration_text(*run, *status),
        Failure::Wiegand { status, code, .. } => wiegand_text(*status, *code),
        Failure::NotBalanced { .. } => TEXTS.text("biss_plan.not_balanced"),
        Failure::Mode { wanted, found } => TEXTS
            .text("biss_failure.mode")
            .with_text("wanted", mode_text(*wanted))
            .with_text("found", mode_text(*found)),
        Failure::Status { kind, expected, found } => TEXTS
            .text("biss_failure.status")
            .with_text("what", procedure_kind_text(*kind))
            .with("expected", format!("0x{expected:02X}"))
            .with("found", format!("0x{found:02X}")),
        Failure::TooLong { seconds, .. } => TEXTS.text("biss_failure.too_long").with("seconds", seconds),
        Failure::NotReady { task: requested, blockers } => {
            let both =
                |first, second| TEXTS.text("biss_failure.both").with_text("first", first).with_text("second", second);
            let why = blockers.iter().map(|own| blocker_text(*own)).reduce(both);
            let text = TEXTS.text("biss_failure.not_ready").with_text("task", task_text(*requested));
            text.with_text("why", why.unwrap_or_else(|| literal_text("")))
        }
        Failure::NotVerified { item, expected, got } => {
            TEXTS.text("biss_failure.not_verified").with("item", item).with("expected", expected).with("got", got)
        }
        Failure::NotDescribed { kind } => {
            TEXTS.text("biss_failure.not_described").with_text("what", procedure_kind_text(*kind))
        }
    }
}

fn calibration_text(run: MotorRun, status: CalibrationStatus) -> Text {
    let why = match status {
        CalibrationStatus::WrongDirection => TEXTS.text("biss_failure.direction"),
        CalibrationStatus::Temperature => temperature_range_text(TEXTS.text("biss_failure.temperature")),
        CalibrationStatus::Speed => speed_range_text(TEXTS.text("biss_failure.speed"), run.allowed_speeds()),
        CalibrationStatus::Failed => TEXTS.text("biss_failure.calibration"),
        other => return unknown_status_text(other.byte()),
    };
    let id = if run.is_clockwise() { "biss_failure.table_lost" } else { "biss_failure.table_kept" };
    TEXTS.text(id).with_text("why", why)
}

fn wiegand_text(status: WiegandStatus, code: u8) -> Text {
    match status {
        WiegandStatus::WrongDirection => TEXTS.text("biss_failure.wiegand_direction"),
        WiegandStatus::Failed => TEXTS.text("biss_failure.wiegand").with("code", format!("0x{code:02X}")),
        other => unknown_status_text(other.byte()),
    }
}

/// Returns the message for an unexpected status code.
fn unknown_status_text(status: u8) -> Text {
    TEXTS.text("biss_failure.unknown").with("status", format!("0x{status:02X}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::devices::biss::procedures::Error;
    use crate::devices::biss::procedures::procedure::{OperatorTask, PossibleValues, ProcedureStep, StartBlocker};
    use crate::devices::biss::procedures::write::EndState;
    use crate::devices::biss::protocol::{DeviceMode, ProcedureKind, RegisterAddress};

    fn cut_off(write_cycles: u64, cause: Failure, standing: Option<LeftState>) -> InterruptedWrite {
        let done = WrittenValues { ops: 1, write_cycles, ..WrittenValues::default() };
        let left = EndState { at: ProcedureStep::Run(MotorRun::CalibrationClockwise), standing };
        InterruptedWrite { done, unfinished: None, cause, end_state: left }
    }

    fn interruption_texts(cause: Failure, left: Option<LeftState>) -> (Vec<String>, Vec<String>) {
        let texts = interruption_text(&cut_off(1, cause, left), Path::new("b.ron"), 3, ChangeKind::Guided);
        let words = |language| texts.iter().map(|text| text.to_string_in(language)).collect();
        (words(English), words(German))
    }

    /// The suggested remedy depends on the kind of change, on the terminal as well. Data that may have changed is never
    /// reported as unchanged.
    #[test]
    fn interrupted_write_remedy_matches_kind() {
        let last = |interrupted: &InterruptedWrite, kind| {
            let text = interruption_text(interrupted, Path::new("b.ron"), 3, kind).pop().unwrap();
            assert!(text.terminal_text().contains("b.ron") && text.to_string_in(German).contains("b.ron"), "{text:?}");
            text.terminal_text()
        };
        let lost = || Failure::Device(Error::NeverSilent);
        let cases = [
            (ChangeKind::Restore, "restore the profile again"),
            (ChangeKind::Bytes, "Other registers keep the new value"),
            (ChangeKind::Guided, "completed steps do not have to be repeated"),
            (ChangeKind::WiegandTest, "changes only its saved result"),
            (ChangeKind::Filter, "status biss"),
            (ChangeKind::Preset, "position biss"),
        ];
        for (kind, part) in cases {
            let words = last(&cut_off(1, lost(), None), kind);
            assert!(words.contains(part), "{words}");
            assert!(last(&cut_off(0, lost(), None), kind).contains("Nothing was changed"));
        }
        let mut interrupted = cut_off(0, lost(), None);
        let address = RegisterAddress::direct_register(0x6A).unwrap();
        interrupted.unfinished = Some(Op::WriteRegister { address, old: None, new: 1, cycles: 0 });
        let words = last(&interrupted, ChangeKind::Bytes);
        assert!(words.contains("is unclear") && words.contains("read biss 0x6A"), "{words}");
    }

    #[test]
    fn failed_calibration_names_limits_of_run() {
        let cases = [(CalibrationStatus::Speed, "300…700"), (CalibrationStatus::Temperature, "25…40 °C")];
        for (status, limits) in cases {
            let text = failure_text(&Failure::Calibration { run: MotorRun::CalibrationClockwise, status });
            assert!(
                text.to_string_in(English).contains(limits) && text.to_string_in(German).contains(limits),
                "{text:?}"
            );
        }
    }

    fn left_state(modes: &[DeviceMode], password: bool, activity: Activity) -> Option<LeftState> {
        let mut mode = PossibleValues::new(modes[0]);
        modes[1..].iter().for_each(|own| mode.add_possible_value(*own));
        Some(LeftState { mode, password: PossibleValues::new(password), activity })
    }

    /// The write can only be completed after the encoder has returned to operation mode (issue 22.5).
    #[test]
    fn advises_return_to_operation_before_completion() {
        for kind in [ChangeKind::Restore, ChangeKind::Bytes, ChangeKind::Guided, ChangeKind::Filter] {
            let last = |left| {
                let interrupted = cut_off(1, Failure::Device(Error::NeverSilent), left);
                interruption_text(&interrupted, Path::new("b.ron"), 3, kind).pop().unwrap()
            };
            let found = last(None);
            let unknown = last(left_state(&[DeviceMode::CALIBRATION], true, Activity::Nothing));
            assert_eq!(
                unknown.terminal_text(),
                format!("First return the encoder to operation. {}", found.terminal_text())
            );
            assert!(
                unknown.to_string_in(German).starts_with("Zuerst den Geber in den Betrieb zurückführen. "),
                "{unknown:?}"
            );
            assert_eq!(severity_of(&unknown), severity_of(&found));
        }
    }

    #[test]
    fn interrupted_write_names_step_cause_and_state() {
        let mode = DeviceMode::CALIBRATION;
        let activity = Activity::Running(MotorRun::CalibrationClockwise);
        let left = left_state(&[mode, DeviceMode::OPERATION], true, activity);
        let (english, german) = interruption_texts(Failure::Device(Error::NeverSilent), left);
        let expected = [
            ["1 of 3", "1 von 3"],
            ["Second run (clockwise)", "Zweiter Lauf (im Uhrzeigersinn)"],
            ["0x01 calibration, 0x00 operation", "0x01 Kalibrierung, 0x00 Betrieb"],
            ["password", "Passwort"],
            ["table", "Tabelle"],
            ["Return the encoder to operation", "zurückführen"],
            ["b.ron", "b.ron"],
        ];
        assert_eq!((english.len(), german.len()), (expected.len(), expected.len()), "{english:?}");
        for (words, [own, deutsch]) in english.iter().zip(&german).zip(expected) {
            assert!(words.0.contains(own) && words.1.contains(deutsch), "{words:?}");
        }
        let (english, _) = interruption_texts(Failure::Device(Error::Cancelled), None);
        assert!(english[0].contains("1 of 3") && english[2].contains("in operation again"), "{english:?}");
    }

    #[test]
    fn explains_every_activity() {
        let activities = [
            Activity::Running(MotorRun::CalibrationCounterclockwise),
            Activity::Running(MotorRun::CalibrationClockwise),
            Activity::Running(MotorRun::WiegandClockwise),
            Activity::Entered,
            Activity::Saving,
            Activity::Restarting,
        ];
        let mut seen = Vec::new();
        for activity in activities {
            let left = left_state(&[DeviceMode::PRESET], false, activity);
            let (english, german) = interruption_texts(Failure::Device(Error::NeverSilent), left);
            assert!(!seen.contains(&english[3]) && english[3] != german[3], "{english:?}");
            seen.push(english[3].clone());
        }
        let (idle, _) = interruption_texts(
            Failure::Device(Error::NeverSilent),
            left_state(&[DeviceMode::PRESET], false, Activity::Nothing),
        );
        assert!(idle[3].contains("Return the encoder to operation"), "{idle:?}");
    }

    /// Every failure code in manual 6.3 and 6.4 has a message with a cause and a remedy.
    #[test]
    fn failures_show_cause_and_remedy() {
        let (first, second) = (MotorRun::CalibrationCounterclockwise, MotorRun::CalibrationClockwise);
        let calibration = |run, byte| Failure::Calibration { run, status: CalibrationStatus::from_byte(byte) };
        let wiegand = |byte, code| Failure::Wiegand {
            run: MotorRun::WiegandClockwise,
            status: WiegandStatus::from_byte(byte),
            code,
        };
        let cases = [
            (calibration(first, 0x30), "wrong direction"),
            (calibration(first, 0x31), "25…40 °C"),
            (calibration(first, 0x32), "300…700 rpm"),
            (calibration(first, 0x33), "did not report a reason"),
            (calibration(second, 0x32), "lost"),
            (calibration(second, 0x77), "0x77"),
            (wiegand(0x30, 0), "wrong direction"),
            (wiegand(0x07, 0x2A), "0x2A"),
            (wiegand(0x99, 0), "0x99"),
            (Failure::NotBalanced { code: 4 }, "balanced"),
            (Failure::Mode { wanted: DeviceMode::PRESET, found: DeviceMode::OPERATION }, "0x07 preset"),
            (Failure::Status { kind: ProcedureKind::DataWrite, expected: 1, found: 0 }, "0x00"),
            (Failure::TooLong { run: first, seconds: 20 }, "20 s"),
            (
                Failure::NotReady { task: OperatorTask::Turn(first), blockers: vec![StartBlocker::NotTurning] },
                "at rest",
            ),
            (
                Failure::NotReady {
                    task: OperatorTask::HoldStill,
                    blockers: vec![StartBlocker::NotTurning, StartBlocker::Temperature { celsius: 20 }],
                },
                "is at rest. The encoder temperature is 20 °C",
            ),
            (Failure::NotVerified { item: "0x6E".to_owned(), expected: "04".to_owned(), got: "03".to_owned() }, "0x6E"),
            (Failure::NotDescribed { kind: ProcedureKind::Preset }, "Preset"),
        ];
        for (cause, fact) in cases {
            let (english, german) =
                (failure_text(&cause).to_string_in(English), failure_text(&cause).to_string_in(German));
            assert!(english.contains(fact), "{english}");
            for words in [&english, &german] {
                assert!(words.trim_end_matches('.').contains(['.', ';', ':']), "what to do: {words}");
                assert!(words.ends_with('.') && !words.starts_with(char::is_lowercase), "{words}");
            }
            assert_ne!(english, german);
        }
    }
}
