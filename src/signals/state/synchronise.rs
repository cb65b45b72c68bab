//! Combination of absolute and analogue position, either typed or read from an encoder at rest. Several readings yield
//! the mean offset between them. See SICK 8010701, forming the absolute position, and section 4 of the project's
//! sine/cosine reference.

use crate::analysis::arctan::{Phase, from_voltages};
use crate::analysis::quality::{Limits, Verdict};
use crate::analysis::synchronise::{AmbiguousPeriodError, STEPS, SynchronisedPosition, Synchroniser, measure_offset};
use crate::app::number::{MAX_PERIODS, parse_in_range, parse_integer, parse_number_or_hex};
use crate::app::{SineCosineOrigin, SineCosineRange, SineCosineReading, SineCosineSource, SineCosineVolts, Text};
use crate::signals::state::TEXTS;

#[derive(Clone, Debug, PartialEq)]
pub enum SynchroniseAction {
    Edit(Box<Form>),
    /// Use the offset measured from the readings.
    UseOffset,
    /// Use the offset found in a capture, in 1/32 of a period and without the half step.
    UseCaptured(f64),
    /// Discard the readings from which the offset is measured.
    Forget,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Form {
    /// Absolute position in steps, as entered: decimal, or hexadecimal with `0x` or `h`.
    pub absolute: String,
    pub phase_input: PhaseInput,
    /// Phase of the analogue position in periods or degrees, as entered.
    pub phase: String,
    pub sine_v: String,
    pub cosine_v: String,
    pub periods: String,
    pub turns: String,
    /// Expected lead of the absolute position over the analogue position, in 1/32 of a period, as entered.
    pub offset: String,
    /// Whether the absolute position refers to the middle of its step instead of the beginning.
    pub half_step: bool,
    /// Value of the quadrature counter in quarters of a period, as entered. Empty without a counter.
    pub quarters: String,
    /// Timing uncertainty in milliseconds when positions are compared without a latch, as entered.
    pub jitter_ms: String,
}

/// The form in which the analogue position is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhaseInput {
    /// Fraction of a period, from 0 to 1.
    Periods,
    /// Electrical degrees, from 0 to 360.
    Degrees,
    /// Sine and cosine in volts, with their mean level removed.
    Volts,
}

#[derive(Debug, Default)]
pub struct SynchroniseState {
    pub form: Form,
    /// Reason why the last encoder reading failed, if it did.
    pub problem: Option<Text>,
    readings: Vec<(u64, Phase)>,
    origin: Option<SineCosineOrigin>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SynchronisationResult {
    pub absolute: u64,
    pub phase: Phase,
    pub period: u64,
    /// Step of the absolute position within its period, 0 to 31.
    pub step: u64,
    /// Lead of the absolute position over the analogue position within the period, in 1/32 of a period. The entered
    /// offset and half step are not taken into account.
    pub difference_steps: f64,
    /// Fine position, or the reason why it cannot be determined.
    pub result: Result<SynchronisedPosition, AmbiguousPeriodError>,
    pub periods: u32,
}

const MIN_READINGS: usize = 2;
const MAX_TURNS: u32 = 65_536;

impl Default for Form {
    /// Creates the example in the second row of the table in the reference.
    fn default() -> Self {
        let typed = |text: &str| text.to_owned();
        Form {
            absolute: typed("0x2A5F"),
            phase_input: PhaseInput::Periods,
            phase: typed("0.02"),
            sine_v: String::new(),
            cosine_v: String::new(),
            periods: typed("1024"),
            turns: typed("1"),
            offset: typed("0"),
            half_step: false,
            quarters: String::new(),
            jitter_ms: typed("1"),
        }
    }
}

impl Form {
    /// Combines the entered absolute and analogue positions.
    ///
    /// # Errors
    /// Returns the reason why the first invalid entry was rejected.
    pub fn compute_result(&self) -> Result<SynchronisationResult, Text> {
        let (periods, synchroniser) = self.create_synchroniser()?;
        let last = synchroniser.periods * STEPS - 1;
        let absolute = parse_number_or_hex(TEXTS.text("synchronise.absolute"), &self.absolute, last)?;
        let phase = self.phase()?;
        let step = absolute % STEPS;
        Ok(SynchronisationResult {
            absolute,
            phase,
            period: absolute / STEPS,
            step,
            difference_steps: step as f64 - STEPS as f64 * phase.to_periods(),
            result: synchroniser.combine(absolute, phase),
            periods,
        })
    }

    /// Returns the fine position in periods according to the quadrature counter, or `None` without a counter.
    ///
    /// # Errors
    /// Returns the reason why the first invalid entry was rejected.
    pub fn quadrature_position(&self) -> Result<Option<f64>, Text> {
        if self.quarters.trim().is_empty() {
            return Ok(None);
        }
        let (_, synchroniser) = self.create_synchroniser()?;
        let last = synchroniser.periods * 4 - 1;
        let quarters = parse_number_or_hex(TEXTS.text("synchronise.quarters"), &self.quarters, last)?;
        let (period, phase) = synchroniser.with_quadrature(quarters, self.phase()?);
        Ok(Some(period as f64 + phase.to_periods()))
    }

    /// Returns the highest speed at which positions can be compared without a latch, in revolutions per minute. Up to
    /// this speed, the shaft moves at most half a period within the timing uncertainty.
    ///
    /// # Errors
    /// Returns the reason why the first invalid entry was rejected.
    pub fn max_unlatched_rpm(&self) -> Result<f64, Text> {
        let (periods, _) = self.create_synchroniser()?;
        let jitter_ms = parse_in_range(TEXTS.text("synchronise.jitter"), &self.jitter_ms, 0.001, 10_000.0)?;
        Ok(0.5 * 60.0 / (f64::from(periods) * jitter_ms / 1e3))
    }

    fn create_synchroniser(&self) -> Result<(u32, Synchroniser), Text> {
        let periods = parse_integer(TEXTS.text("synchronise.periods"), &self.periods, 1, MAX_PERIODS)?;
        let turns = parse_integer(TEXTS.text("synchronise.turns"), &self.turns, 1, MAX_TURNS)?;
        let offset_steps = parse_in_range(TEXTS.text("synchronise.offset"), &self.offset, -32.0, 32.0)?;
        let half_step = self.half_step;
        let whole = Synchroniser::new(u64::from(periods) * u64::from(turns));
        Ok((periods, Synchroniser { offset_steps, half_step, ..whole }))
    }

    fn phase(&self) -> Result<Phase, Text> {
        let no_signal = || TEXTS.text("synchronise.no_signal");
        match self.phase_input {
            PhaseInput::Periods => {
                Phase::from_periods(parse_in_range(TEXTS.text("synchronise.in_periods"), &self.phase, 0.0, 1.0)?)
            }
            PhaseInput::Degrees => Phase::from_periods(
                parse_in_range(TEXTS.text("synchronise.in_degrees"), &self.phase, 0.0, 360.0)? / 360.0,
            ),
            PhaseInput::Volts => from_voltages(
                parse_in_range(TEXTS.text("synchronise.sine"), &self.sine_v, -10.0, 10.0)?,
                parse_in_range(TEXTS.text("synchronise.cosine"), &self.cosine_v, -10.0, 10.0)?,
            ),
        }
        .ok_or_else(no_signal)
    }
}

impl SynchronisationResult {
    /// Returns the fine position as a shaft angle in degrees within one revolution.
    pub fn to_degrees(&self) -> Option<f64> {
        let fine = self.result.ok()?;
        Some(fine.periods().rem_euclid(f64::from(self.periods)) / f64::from(self.periods) * 360.0)
    }

    pub fn to_text(&self) -> (Verdict, Text) {
        match self.result {
            Err(AmbiguousPeriodError) => (Verdict::Fault, TEXTS.text("synchronise.impossible")),
            Ok(fine) => {
                let id = match fine.verdict {
                    Verdict::Ok => "synchronise.good",
                    Verdict::Warn => "synchronise.doubtful",
                    Verdict::Fault => "synchronise.unsure",
                };
                let steps = fine.residual_periods * STEPS as f64;
                (fine.verdict, TEXTS.text(id).with_number("steps", steps, 2))
            }
        }
    }
}

impl SynchroniseState {
    pub(super) fn handle_action(&mut self, action: SynchroniseAction) {
        match action {
            SynchroniseAction::Edit(form) => {
                self.form = *form;
                self.problem = None;
            }
            SynchroniseAction::UseOffset => {
                if let Some(offset) = self.measured_offset() {
                    // The entry accepts a decimal point in every language.
                    self.form.offset = format!("{offset:.2}");
                }
            }
            SynchroniseAction::UseCaptured(offset) => self.form.offset = format!("{:.2}", self.add_half_step(offset)),
            SynchroniseAction::Forget => self.readings.clear(),
        }
    }

    /// Adopts the next reading from `source`, or shows why it failed. Has no effect if there is no new reading.
    pub(crate) fn follow_source(&mut self, source: &mut dyn SineCosineSource) {
        match source.take_reading() {
            Some(Ok(reading)) => self.add_reading(reading, source.origin()),
            Some(Err(why)) => self.problem = Some(why),
            None => {}
        }
    }

    fn add_reading(&mut self, reading: SineCosineReading, origin: SineCosineOrigin) {
        self.problem = None;
        let range = origin.range;
        if self.origin.as_ref() != Some(&origin) {
            // The previous readings are from another encoder.
            self.readings.clear();
            self.origin = Some(origin);
        }
        let Some(SineCosineVolts { sine_v, cosine_v }) = reading.signals else {
            self.form.absolute = reading.position.to_string();
            self.problem = Some(TEXTS.text("synchronise.no_channels"));
            return;
        };
        let Some(SineCosineRange { periods, turns }) = range else {
            self.problem = Some(TEXTS.text("synchronise.no_geometry"));
            return;
        };
        let form = &mut self.form;
        form.absolute = format!("0x{:X}", reading.position);
        form.phase_input = PhaseInput::Volts;
        (form.sine_v, form.cosine_v) = (format!("{sine_v:.4}"), format!("{cosine_v:.4}"));
        (form.periods, form.turns) = (periods.max(1).to_string(), turns.max(1).to_string());
        let length = sine_v.hypot(cosine_v);
        match from_voltages(sine_v, cosine_v).filter(|_| Limits::HIPERFACE.amplitude_verdict(length) != Verdict::Fault)
        {
            Some(phase) if reading.valid => self.readings.push((reading.position.into(), phase)),
            Some(_) => self.problem = Some(Text::new("commutation.invalid")),
            None => self.problem = Some(TEXTS.text("synchronise.no_signal")),
        }
    }

    pub fn reading_count(&self) -> usize {
        self.readings.len()
    }

    /// Returns the offset measured from the readings, in the form in which it is entered. Returns `None` if it cannot
    /// be measured.
    pub fn measured_offset(&self) -> Option<f64> {
        if self.readings.len() < MIN_READINGS {
            return None;
        }
        measure_offset(self.readings.iter().copied()).map(|offset| self.add_half_step(offset))
    }

    /// Returns an offset in the form in which it is entered, including the half step if selected.
    pub fn add_half_step(&self, offset: f64) -> f64 {
        offset + if self.form.half_step { 0.5 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::SessionId;

    fn form(absolute: &str, phase: &str, periods: &str, turns: &str) -> Form {
        let typed = |text: &str| text.to_owned();
        let (absolute, phase) = (typed(absolute), typed(phase));
        Form { absolute, phase, periods: typed(periods), turns: typed(turns), ..Form::default() }
    }

    /// Typed values yield the rows of section 4: P, a5, d, k, fine position, residual.
    #[test]
    fn typed_rows_match_section_4() {
        let rows = [
            (form("0x000E0531", "0,5375", "128", "4096"), 28_713, 17, -0.20, 0, 28_713.537_5, -0.0062, "good"),
            (form("2A5Fh", "0.02", "1024", "1"), 338, 31, 30.36, 1, 339.02, -0.0512, "good"),
            (form("10816", "0.97", "1024", "1"), 338, 0, -31.04, -1, 337.97, 0.03, "good"),
            (form("0x2A47", "0.47", "1024", "1"), 338, 7, -8.04, 0, 338.47, -0.2513, "doubtful"),
            (form("0", "0.51", "16", "1"), 0, 0, -16.32, -1, 15.51, 0.49, "unsure"),
        ];
        for (form, period, step, difference, k, fine, residual, verdict) in rows {
            let told = form.compute_result().unwrap();
            assert_eq!((told.period, told.step), (period, step), "{form:?}");
            assert!((told.difference_steps - difference).abs() < 1e-9, "{told:?}");
            let result = told.result.unwrap();
            assert_eq!(result.correction, k, "{told:?}");
            assert!((result.periods() - fine).abs() < 1e-9, "{told:?}");
            assert!((result.residual_periods - residual).abs() < 6e-5, "{told:?}");
            assert_eq!(told.to_text().1.id().strip_prefix("synchronise."), Some(verdict));
        }
        // 339.02 of 1024 periods, regardless of the number of turns.
        for turns in ["1", "4096"] {
            let degrees = form("0x2A5F", "0.02", "1024", turns).compute_result().unwrap().to_degrees().unwrap();
            assert!((degrees - 119.186_718_75).abs() < 1e-9, "{degrees}");
        }
        let told = form("0", "0.5", "16", "1").compute_result().unwrap();
        assert_eq!((told.result, told.to_degrees()), (Err(AmbiguousPeriodError), None));
        assert_eq!(told.to_text().1.id(), "synchronise.impossible");
    }

    #[test]
    fn parses_phase_in_three_units() {
        let degrees = Form { phase_input: PhaseInput::Degrees, ..form("0x2A5F", "7.2", "1024", "1") };
        assert!((degrees.compute_result().unwrap().phase.to_periods() - 0.02).abs() < 1e-12);
        let typed = |text: &str| text.to_owned();
        let (sine_v, cosine_v) = (typed("-0.5"), typed("0"));
        let volts = Form { phase_input: PhaseInput::Volts, sine_v, cosine_v, ..Form::default() };
        assert_eq!(volts.compute_result().unwrap().phase.to_periods(), 0.75);
        let nothing = Form { sine_v: typed("0"), ..volts };
        assert_eq!(nothing.compute_result().unwrap_err().id(), "synchronise.no_signal");
    }

    /// Positions from quadrature counters match section 4, and so does the speed limit of 29 rpm for 1 ms with 1024
    /// periods.
    #[test]
    fn computes_counters_and_check_speed() {
        for (quarters, phase, fine) in [("43", "0.76", 10.76), ("44", "0.98", 10.98), ("43", "0.02", 11.02)] {
            let form = Form { quarters: quarters.to_owned(), ..form("0", phase, "1024", "1") };
            assert!((form.quadrature_position().unwrap().unwrap() - fine).abs() < 1e-12, "{quarters}");
        }
        assert_eq!(Form::default().quadrature_position(), Ok(None));
        let beyond = Form { quarters: "4096".to_owned(), ..Form::default() };
        assert_eq!(beyond.quadrature_position().unwrap_err().id(), "entry.position_range");
        assert!((Form::default().max_unlatched_rpm().unwrap() - 29.296_875).abs() < 1e-9);
        let jitter = Form { jitter_ms: "0".to_owned(), ..Form::default() };
        assert_eq!(jitter.max_unlatched_rpm().unwrap_err().id(), "entry.number");
    }

    #[test]
    fn invalid_input_names_its_entry() {
        for (form, id) in [
            (form("", "0.02", "1024", "1"), "entry.missing"),
            (form("x", "0.02", "1024", "1"), "entry.position_range"),
            (form("-1", "0.02", "1024", "1"), "entry.position_range"),
            (form("32768", "0.02", "1024", "1"), "entry.position_range"),
            (form("99999999999999999999999", "0.02", "1024", "1"), "entry.position_range"),
            (form("0", "NaN", "1024", "1"), "entry.number"),
            (form("0", "1.01", "1024", "1"), "entry.number"),
            (form("0", "0", "0", "1"), "entry.whole"),
            (form("0", "0", "1024", "0"), "entry.whole"),
            (Form { offset: "33".to_owned(), ..Form::default() }, "entry.number"),
        ] {
            assert_eq!(form.compute_result().unwrap_err().id(), id, "{form:?}");
        }
    }

    /// Readings that lead by 2 and by 3 steps yield a mean lead of 2.5 steps.
    #[test]
    fn readings_measure_offset() {
        let mut page = SynchroniseState::default();
        let range = Some(SineCosineRange { periods: 128, turns: 4096 });
        let at = |position, degrees: f64| {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            SineCosineReading {
                position,
                valid: true,
                signals: Some(SineCosineVolts { sine_v: 0.5 * sine, cosine_v: 0.5 * cosine }),
            }
        };
        assert_eq!(page.measured_offset(), None);
        // Step 10 at a phase of 8 steps (90°), and step 31 at a phase of 28 steps (315°).
        let whose = |number, serial: &str| SineCosineOrigin {
            session: SessionId(number),
            serial_number: Some(serial.to_owned()),
            range,
        };
        page.add_reading(at(10, 90.0), whose(1, "A"));
        assert_eq!((page.reading_count(), page.measured_offset()), (1, None));
        page.add_reading(at(95, 315.0), whose(1, "A"));
        assert!((page.measured_offset().unwrap() - 2.5).abs() < 1e-9);
        page.handle_action(SynchroniseAction::UseOffset);
        assert_eq!((page.form.offset.as_str(), page.form.periods.as_str()), ("2.50", "128"));
        // d = 31 − 28 = 3 steps. After the offset of 2.5 steps is subtracted, half a step remains.
        let told = page.form.compute_result().unwrap();
        assert!((told.difference_steps - 3.0).abs() < 0.01);
        assert!((told.result.unwrap().residual_periods * 32.0 - 0.5).abs() < 0.01);
        page.add_reading(SineCosineReading { signals: None, ..at(10, 0.0) }, whose(1, "A"));
        assert_eq!(page.problem.as_ref().unwrap().id(), "synchronise.no_channels");
        assert_eq!(page.reading_count(), 2);
        let small = SineCosineOrigin { range: Some(SineCosineRange { periods: 16, turns: 1 }), ..whose(1, "A") };
        for other in [small, whose(1, "A"), whose(1, "B"), whose(2, "B")] {
            page.add_reading(at(10, 90.0), other);
            assert_eq!(page.reading_count(), 1, "another encoder begins anew");
        }
        page.handle_action(SynchroniseAction::Forget);
        assert_eq!(page.reading_count(), 0);
    }
}
