//! Messages for guided procedures: steps, operator tasks, reasons why a run cannot start, and results.

use crate::app::{Severity, Text};
use crate::devices::biss::procedures::procedure::{
    CalibrationReport, MotorRun, OperatorAdvice, OperatorPrompt, OperatorTask, Outcome, ProcedureStep, ShaftMotion,
    SpeedRange, StartBlocker, WiegandReport,
};
use crate::devices::biss::profile::{Op, PresetParts};
use crate::devices::biss::protocol::{DeviceMode, PulseVoltage, WiegandResult};
use crate::devices::biss::state::TEXTS;

pub fn procedure_text(op: &Op) -> Text {
    TEXTS.text(match op {
        Op::Calibrate => "guide.calibration",
        Op::WiegandTest { .. } => "guide.wiegand",
        Op::StorePreset { .. } => "guide.store_preset",
        Op::FirePreset { .. } => "guide.fire_preset",
        Op::SelectFilter { .. } => "guide.filter",
        Op::StoreData { .. } => "guide.data",
        Op::WriteRegister { .. } => "guide.register",
    })
}

pub fn procedure_step_text(step: ProcedureStep) -> Text {
    match step {
        ProcedureStep::Await(task) => self::task_text(task),
        ProcedureStep::Run(run) => match run {
            MotorRun::CalibrationCounterclockwise => TEXTS.text("guide.run_calibration_ccw"),
            MotorRun::CalibrationClockwise => TEXTS.text("guide.run_calibration_cw"),
            MotorRun::WiegandClockwise => add_revolutions(TEXTS.text("guide.run_wiegand_cw")),
            MotorRun::WiegandCounterclockwise => add_revolutions(TEXTS.text("guide.run_wiegand_ccw")),
        },
        ProcedureStep::Enter(mode) => TEXTS.text("guide.enter").with_text("mode", self::mode_text(mode)),
        ProcedureStep::Conditions => TEXTS.text("guide.conditions"),
        ProcedureStep::Open => TEXTS.text("guide.open"),
        ProcedureStep::Write => TEXTS.text("guide.write"),
        ProcedureStep::Results => TEXTS.text("guide.results"),
        ProcedureStep::Save => TEXTS.text("guide.save"),
        ProcedureStep::Fire => TEXTS.text("guide.fire"),
        ProcedureStep::Restart => TEXTS.text("guide.restart"),
        ProcedureStep::ReturnToOperation => TEXTS.text("guide.lead_back"),
        ProcedureStep::ReadBack => TEXTS.text("guide.read_back"),
    }
}

pub fn mode_text(mode: DeviceMode) -> Text {
    let id = match mode {
        DeviceMode::OPERATION => "biss_mode.operation",
        DeviceMode::CALIBRATION => "biss_mode.calibration",
        DeviceMode::WIEGAND_TEST => "biss_mode.wiegand_test",
        DeviceMode::DATA_WRITE => "biss_mode.data_write",
        DeviceMode::FILTER => "biss_mode.filter",
        DeviceMode::PRESET => "biss_mode.preset",
        _ => "biss_mode.unknown",
    };
    TEXTS.text(id).with("code", format!("0x{:02X}", mode.byte()))
}

pub fn task_text(task: OperatorTask) -> Text {
    match task {
        OperatorTask::Turn(run) => {
            let id = match (run.is_clockwise(), run.is_calibration()) {
                (true, true) => "guide.turn_cw_best",
                (false, true) => "guide.turn_ccw_best",
                (true, false) => "guide.turn_cw",
                (false, false) => "guide.turn_ccw",
            };
            speed_range_text(TEXTS.text(id), run.allowed_speeds()).with_number(
                "best",
                run.recommended_range().midpoint(),
                0,
            )
        }
        OperatorTask::HoldStill => TEXTS.text("guide.stand"),
        OperatorTask::HoldAtPresetAngle => TEXTS.text("guide.stand_at_place"),
    }
}

pub fn blocker_text(blocker: StartBlocker) -> Text {
    match blocker {
        StartBlocker::Measuring => TEXTS.text("guide.measuring"),
        StartBlocker::NoPosition => TEXTS.text("guide.no_position"),
        StartBlocker::NotTurning => TEXTS.text("guide.standing"),
        // With the displayed number of decimals, such a speed would be shown as zero.
        StartBlocker::Turning { rpm } if rpm.abs() < 0.05 => TEXTS.text("guide.creeping"),
        StartBlocker::Turning { rpm } => TEXTS.text("guide.turning").with_number("rpm", rpm, 1),
        StartBlocker::WrongDirection => TEXTS.text("guide.wrong_direction"),
        StartBlocker::Speed { rpm, allowed } => {
            speed_range_text(TEXTS.text("guide.speed"), allowed).with_number("rpm", rpm, 0)
        }
        StartBlocker::Unsteady { spread } => TEXTS.text("guide.unsteady").with_number("spread", spread, 1),
        StartBlocker::Temperature { celsius } => {
            temperature_range_text(TEXTS.text("guide.temperature").with("celsius", celsius))
        }
    }
}

pub fn advice_text(advice: OperatorAdvice) -> Text {
    match advice {
        OperatorAdvice::Speed { recommended } => {
            let run = MotorRun::CalibrationCounterclockwise;
            let text = speed_range_text(TEXTS.text("guide.recommended"), recommended);
            text.with_number("fluctuation", run.max_fluctuation().unwrap_or_default(), 0)
        }
        OperatorAdvice::TableAtRisk => TEXTS.text("guide.table_at_risk"),
        OperatorAdvice::Marked => TEXTS.text("guide.marked"),
    }
}

/// Returns the requirements on the motor and the encoder for a calibration.
pub fn calibration_requirements_text() -> Text {
    let run = MotorRun::CalibrationCounterclockwise;
    let text = speed_range_text(TEXTS.text("mounting_card.calibrate_words"), run.allowed_speeds());
    temperature_range_text(text.with_number("best", run.recommended_range().midpoint(), 0))
}

/// Returns the requirements on the motor for a Wiegand test.
pub fn wiegand_requirements_text() -> Text {
    add_revolutions(speed_range_text(
        TEXTS.text("mounting_card.wiegand_words"),
        MotorRun::WiegandClockwise.allowed_speeds(),
    ))
}

fn add_revolutions(text: Text) -> Text {
    text.with("revolutions", WiegandResult::REVOLUTIONS)
}

pub(super) fn temperature_range_text(text: Text) -> Text {
    text.with("coldest", OperatorPrompt::CELSIUS.start()).with("warmest", OperatorPrompt::CELSIUS.end())
}

pub(super) fn speed_range_text(text: Text, range: SpeedRange) -> Text {
    text.with_number("least", range.least, 0).with_number("greatest", range.greatest, 0)
}

/// Returns the result of an operation for the page and the report, one line per fact.
pub fn outcome_texts(outcome: &Outcome) -> Vec<Text> {
    match outcome {
        Outcome::Skipped { after } => vec![TEXTS.text(match after {
            None => "guide.skipped",
            Some(run) if run.is_calibration() => "guide.skipped_calibration",
            Some(_) => "guide.skipped_wiegand",
        })],
        Outcome::Stored { registers } => vec![TEXTS.text("guide.stored").with("count", registers)],
        Outcome::PresetStored { value, singleturn_bits } => {
            vec![
                TEXTS
                    .text("guide.preset_stored")
                    .with_text("value", super::preset_value_text(*value, *singleturn_bits)),
            ]
        }
        Outcome::PresetFired { parts, from, to } => {
            let id = match parts {
                PresetParts::Both => "guide.preset_both",
                PresetParts::Singleturn => "guide.preset_singleturn",
                PresetParts::Multiturn => "guide.preset_multiturn",
            };
            let text = TEXTS.text(id).with("from_turns", from.turns).with("to_turns", to.turns);
            vec![text.with_number("from", from.degrees_in_turn(), 3).with_number("to", to.degrees_in_turn(), 3)]
        }
        Outcome::FilterSelected(filter) => {
            vec![
                TEXTS
                    .text("guide.filter_selected")
                    .with_text("filter", crate::devices::biss::state::format::filter(*filter)),
            ]
        }
        Outcome::Calibrated(report) => calibration_summary(report),
        Outcome::Tested(report) => wiegand_summary(report),
    }
}

/// Returns the result of an operation, one line per fact, each with its severity. If the operation was skipped, the
/// line names it.
pub fn report_lines(op: &Op, own: &Outcome) -> Vec<(Severity, Text)> {
    let lines = outcome_texts(own);
    if let Outcome::Skipped { .. } = own {
        let named =
            |words| TEXTS.text("guide.of_operation").with_text("what", procedure_text(op)).with_text("words", words);
        return lines.into_iter().map(|words| (Severity::Note, named(words))).collect();
    }
    // The first line states the action or the verdict. The other lines add details.
    let severity = |at: usize| match own {
        Outcome::Tested(report) => match at {
            0 => pulse_severity(report.result.lowest_cw).max(pulse_severity(report.result.lowest_ccw)),
            1 => pulse_severity(report.result.lowest_cw),
            2 => pulse_severity(report.result.lowest_ccw),
            _ => Severity::Note,
        },
        _ if at == 0 => Severity::Good,
        _ => Severity::Note,
    };
    lines.into_iter().enumerate().map(|(at, text)| (severity(at), text)).collect()
}

fn pulse_severity(lowest: PulseVoltage) -> Severity {
    if lowest > PulseVoltage::LIMIT { Severity::Good } else { Severity::Warning }
}

fn calibration_summary(report: &CalibrationReport) -> Vec<Text> {
    let mut texts = vec![TEXTS.text("guide.calibrated")];
    texts.extend(report.celsius.map(|celsius| TEXTS.text("guide.at_temperature").with("celsius", celsius)));
    texts.extend(motion_text("guide.motion_ccw", report.counterclockwise));
    texts.extend(motion_text("guide.motion_cw", report.clockwise));
    texts
}

fn wiegand_summary(report: &WiegandReport) -> Vec<Text> {
    let result = report.result;
    let direction = |id, average: PulseVoltage, lowest: PulseVoltage| {
        let verdict = if lowest > PulseVoltage::LIMIT { "guide.above_limit" } else { "guide.below_limit" };
        TEXTS
            .text(id)
            .with_number("average", average.volts(), 1)
            .with_number("lowest", lowest.volts(), 1)
            .with_text("verdict", TEXTS.text(verdict).with_number("limit", PulseVoltage::LIMIT.volts(), 1))
    };
    let passed = [result.lowest_cw, result.lowest_ccw].into_iter().all(|lowest| lowest > PulseVoltage::LIMIT);
    let mut texts = vec![
        TEXTS.text(if passed { "guide.wiegand_passed" } else { "guide.wiegand_not_passed" }),
        direction("guide.pulses_cw", result.average_cw, result.lowest_cw),
        direction("guide.pulses_ccw", result.average_ccw, result.lowest_ccw),
    ];
    texts.extend(motion_text("guide.motion_cw", report.clockwise));
    texts.extend(motion_text("guide.motion_ccw", report.counterclockwise));
    texts.push(TEXTS.text(if report.saved { "guide.result_saved" } else { "guide.result_not_saved" }));
    texts
}

fn motion_text(id: &'static str, motion: Option<ShaftMotion>) -> Option<Text> {
    let motion = motion?;
    Some(TEXTS.text(id).with_number("rpm", motion.rpm.abs(), 1).with_number("spread", motion.spread, 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::devices::biss::protocol::{PresetValue, WiegandResult};

    #[test]
    fn modes_have_german_names() {
        for byte in 0..=255 {
            let own = DeviceMode::new(byte);
            assert_eq!(mode_text(own).to_string_in(English), own.to_string());
            assert_ne!(mode_text(own).to_string_in(German), own.to_string());
        }
    }

    /// According to manual 6.3, the average minus four standard deviations must be above 5.3 V.
    #[test]
    fn compares_wiegand_result_with_limit() {
        let result = WiegandResult {
            average_cw: PulseVoltage::new(63),
            lowest_cw: PulseVoltage::new(54),
            average_ccw: PulseVoltage::new(62),
            lowest_ccw: PulseVoltage::new(53),
        };
        let report = WiegandReport { result, saved: false, clockwise: None, counterclockwise: None };
        let words: Vec<String> =
            outcome_texts(&Outcome::Tested(report)).iter().map(|text| text.to_string_in(English)).collect();
        assert!(words[0].contains("failed"), "{words:?}");
        assert!(words[1].contains("6.3") && words[1].contains("5.4") && words[1].contains("above"), "{words:?}");
        assert!(words[2].contains("5.3") && words[2].contains("not above"), "{words:?}");
        let report = super::report_lines(&Op::WiegandTest { save: false }, &Outcome::Tested(report));
        let weights: Vec<Severity> = report.iter().map(|(severity, _)| *severity).collect();
        assert_eq!(weights, [Severity::Warning, Severity::Good, Severity::Warning, Severity::Note]);
    }

    /// According to manual 6.7, 18000h at 17 bits is 270°.
    #[test]
    fn shows_stored_preset_as_angle() {
        let value = PresetValue::new(0x18000, 2).unwrap();
        let texts = outcome_texts(&Outcome::PresetStored { value, singleturn_bits: 17 });
        assert_eq!(texts[0].to_string_in(English), "Preset value saved: 270.000° (step 98304), turn 2.");
        assert!(texts[0].to_string_in(German).contains("270,000° (Schritt 98304), Umdrehung 2"), "{texts:?}");
    }

    /// The message never states a speed of zero for a shaft that is not at rest.
    #[test]
    fn creeping_shaft_is_not_zero_rpm() {
        let words = |rpm| blocker_text(StartBlocker::Turning { rpm }).to_string_in(German);
        assert!(words(0.06).contains("0,1 1/min") && words(-3.0).contains("-3,0 1/min"));
        for rpm in [0.049, -0.03, 0.0] {
            assert!(words(rpm).contains("ändert sich noch"), "{rpm}: {}", words(rpm));
        }
    }

    #[test]
    fn names_skipped_operations() {
        let report = report_lines(&Op::Calibrate, &Outcome::Skipped { after: None });
        let [(Severity::Note, text)] = report.as_slice() else { panic!("{report:?}") };
        assert!(
            text.to_string_in(English).contains("Calibration") && text.to_string_in(German).contains("Kalibrierung")
        );
    }
}
