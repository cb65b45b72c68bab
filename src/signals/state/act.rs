//! State and actions of the Signals tab.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::reading::{self, CaptureReading};
use super::synchronise::SynchroniseState;
use super::{
    DiagnosisSettings, FailedTask, Measurement, MeasurementResult, ReadCapture, Scope, SignalsAction, Source,
    SourceAction, Table, TableSource, TaskResult, report, task_guard,
};
use crate::analysis::capture::TableHints;
use crate::analysis::diagnosis::{DiagnosisChanges, DiagnosisFinding, compare};
use crate::analysis::quality::Family;
use crate::app::number::MAX_PERIODS;
use crate::app::recorder::Recorder;
use crate::app::report::CreateReport;
use crate::app::services::Services;
use crate::app::{Payload, PayloadKindError, Severity, SineCosineSource, Text, Tool, ToolContext, explain, recorder};
use crate::link::LinkUrl;
use crate::signals::state::TEXTS;
use crate::store::ReadCaptureError;

pub struct Signals {
    family: Family,
    periods: Option<u32>,
    /// Whether the number of periods was set by the virtual encoder. Such a number does not apply to a capture from a
    /// file.
    periods_of_source: bool,
    pub(crate) source: Source,
    synchronise: SynchroniseState,
    pub(super) scope: Scope,
    measurement: Option<Arc<Measurement>>,
    comparison: Option<Arc<MeasurementResult>>,
    table: Option<Table>,
    problem: Option<Text>,
    reading: Option<CaptureReading>,
    attempts: u32,
    judgements: u32,
}

impl Default for Signals {
    fn default() -> Self {
        Signals {
            family: Family::default(),
            periods: None,
            periods_of_source: false,
            source: Source::default(),
            synchronise: SynchroniseState::default(),
            scope: Scope::live(true),
            measurement: None,
            comparison: None,
            table: None,
            problem: None,
            reading: None,
            attempts: 0,
            judgements: 0,
        }
    }
}

impl Tool for Signals {
    fn handle_action(&mut self, action: Payload, context: &mut ToolContext<'_>) -> Result<(), PayloadKindError> {
        match action.open()? {
            SignalsAction::Source(SourceAction::StartAdapter) => self.start_adapter_when_free(context),
            action => Signals::handle_action(self, action, context.services()),
        }
        Ok(())
    }

    fn handle_result(&mut self, done: Payload, services: &mut Services) -> Result<(), PayloadKindError> {
        Signals::handle_result(self, done.open()?, services);
        Ok(())
    }

    fn process_events(&mut self, services: &mut Services) {
        Signals::process_samples(self, services);
    }

    fn can_stop(&self) -> bool {
        self.reading.is_some() || self.source.is_running()
    }

    fn stop(&mut self, services: &mut Services) {
        self.source.stop(services);
        self.cancel_reading();
    }

    fn recorder(&self) -> &Recorder {
        &self.scope.recorder
    }

    fn recorder_mut(&mut self) -> &mut Recorder {
        &mut self.scope.recorder
    }

    fn adopt_reading(&mut self, source: &mut dyn SineCosineSource) {
        self.synchronise.follow_source(source);
    }

    fn release_connection(&mut self, url: &LinkUrl, services: &mut Services) {
        self.source.release_connection(url, services);
    }

    fn report(&self) -> Option<CreateReport> {
        let measurement = self.measurement.clone()?;
        Some(Box::new(move |context| {
            let name = context.localize(measurement.origin.name());
            report::report(&measurement, name, None, context)
        }))
    }

    fn can_open(&self, path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
    }

    fn open(&mut self, path: PathBuf, services: &mut Services) {
        Signals::handle_action(self, SignalsAction::Open(path), services);
    }
}

impl Signals {
    /// Creates the state from the links of previously used adapters, most recent first.
    pub(crate) fn with_links(links: &[String]) -> Self {
        Signals { source: Source::with_link(links.first()), ..Signals::default() }
    }

    /// Starts the adapter once the rest of the program has released its connection. The link is stored in the settings.
    fn start_adapter_when_free(&mut self, context: &mut ToolContext<'_>) {
        let earlier = match self.source.adapter_url() {
            Some(url) => context.release_connection(&url, TEXTS.text("session.let_go_for_signals")),
            None => Ok(None),
        };
        match earlier {
            Ok(earlier) => self.start_adapter(earlier, context.services()),
            Err(why) => self.source.show_rejection(why),
        }
        if self.source.adapter_problem().is_none() {
            context.use_link(self.source.link());
        }
    }

    pub fn family(&self) -> Family {
        self.family
    }

    /// Returns the signal periods per revolution, at least 1, or `None` if unknown. Results that depend on the number
    /// are then omitted.
    pub fn signal_periods(&self) -> Option<u32> {
        self.periods
    }

    pub fn synchronise(&self) -> &SynchroniseState {
        &self.synchronise
    }

    pub fn measurement(&self) -> Option<&Arc<Measurement>> {
        self.measurement.as_ref()
    }

    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the results of the capture kept for comparison.
    pub fn comparison_result(&self) -> Option<&Arc<MeasurementResult>> {
        self.comparison.as_ref()
    }

    /// Returns the last table, even if it could not be read.
    pub fn table(&self) -> Option<&Table> {
        self.table.as_ref()
    }

    /// Returns the reason why the last table could not be read. The previous capture then remains on display.
    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }

    pub fn capture_reading(&self) -> Option<&CaptureReading> {
        self.reading.as_ref()
    }

    pub fn scope(&self) -> &Scope {
        &self.scope
    }

    /// Returns the findings, worst first.
    pub fn findings(&self) -> &[DiagnosisFinding] {
        self.measurement.as_ref().map_or(&[], |measurement| &measurement.diagnosis.findings)
    }

    /// Returns the changes from the capture kept for comparison. The same limits apply to both captures.
    pub fn changes(&self) -> Option<DiagnosisChanges> {
        let (kept, own) = (self.comparison.as_ref()?, self.measurement.as_ref()?);
        let before = kept.diagnosis.with_new_limits(
            kept.analysis.as_ref(),
            kept.levels_v,
            &own.diagnosis_settings.family.limits(),
        );
        Some(compare(&before, &own.diagnosis))
    }

    pub(super) fn set_periods(&mut self, periods: u32, of_source: bool, services: &mut Services) {
        self.periods = Some(periods.clamp(1, MAX_PERIODS));
        self.periods_of_source = of_source;
        if self.measurement.as_ref().is_some_and(|own| own.diagnosis_settings != self.diagnosis_settings()) {
            self.update_verdicts(services);
        }
    }

    /// Cancels the reading of a capture.
    pub(super) fn abort_reading(&mut self) {
        if let Some(reading) = self.reading.take() {
            self.table.clone_from(&reading.settled);
        }
    }

    fn cancel_reading(&self) {
        if let Some(reading) = &self.reading {
            reading.cancel();
        }
    }

    pub(crate) fn handle_action(&mut self, action: SignalsAction, services: &mut Services) {
        match action {
            SignalsAction::Open(path) => self.open_table_source(TableSource::File(path), services),
            SignalsAction::Example(example) => self.open_table_source(TableSource::Example(example), services),
            SignalsAction::SetDelimiter(delimiter) => {
                self.reread_with_hints(services, |hints| hints.delimiter = Some(delimiter))
            }
            SignalsAction::SetDecimalComma(comma) => {
                self.reread_with_hints(services, |hints| hints.decimal_comma = Some(comma))
            }
            SignalsAction::SetTimeUnit(unit) => self.reread_with_hints(services, |hints| hints.time_unit = Some(unit)),
            SignalsAction::SetVolts(volts) if volts.is_finite() && volts != 0.0 => {
                self.reread_with_hints(services, |hints| hints.volts_per_unit = Some(volts));
            }
            SignalsAction::SetVolts(_) => {}
            SignalsAction::Detect => self.reread_with_hints(services, |hints| *hints = TableHints::default()),
            SignalsAction::SetColumn(column, number) => {
                let settled = self.displayed_table();
                if self.table.as_mut().is_some_and(|table| table.select_column(column, number)) {
                    self.read_again(settled, services);
                }
            }
            SignalsAction::Cancel => self.cancel_reading(),
            SignalsAction::Source(action) => self.handle_source_action(action, services),
            SignalsAction::SetFamily(family) => {
                self.family = family;
                self.update_verdicts(services);
            }
            SignalsAction::Keep => {
                let shown = self.measurement.as_ref().map(|own| own.results().clone());
                self.comparison = shown.or(self.comparison.take());
            }
            SignalsAction::DropComparison => self.comparison = None,
            SignalsAction::Synchronise(action) => self.synchronise.handle_action(action),
            SignalsAction::SetPeriods(periods) => self.set_periods(periods, false, services),
        }
    }

    pub(crate) fn handle_result(&mut self, done: TaskResult, services: &mut Services) {
        match done {
            TaskResult::Read { number, read } => {
                if let Some(reading) = self.reading.take_if(|reading| reading.number == number) {
                    self.adopt_capture(*read, &reading, services);
                }
            }
            TaskResult::Rediagnosed { number, measurement } => {
                let same = |own: &Arc<Measurement>| Arc::ptr_eq(&own.capture, &measurement.capture);
                if self.judgements == number && self.measurement.as_ref().is_some_and(same) {
                    self.measurement = Some(Arc::new(*measurement));
                }
            }
            TaskResult::Measured { number, measurement } => self.handle_measurement(number, *measurement, services),
            TaskResult::Failed(failed) => self.handle_failed_task(failed, services),
            TaskResult::ValueDropped => {}
        }
    }

    fn handle_failed_task(&mut self, failed: FailedTask, services: &mut Services) {
        let what = match failed {
            FailedTask::Read(number) if self.reading.as_ref().is_some_and(|reading| reading.number == number) => {
                self.abort_reading();
                "signals.reading_failed"
            }
            FailedTask::Measure(number) if self.stop_after_failed_measurement(number, services) => {
                "signals.measuring_failed"
            }
            FailedTask::Judge => "signals.judging_failed",
            FailedTask::Read(_) | FailedTask::Measure(_) => return,
        };
        services.notify(Severity::Error, vec![TEXTS.text(what)], None);
    }

    /// Replaces the displayed samples. A running export of the previous samples is cancelled.
    pub(super) fn replace_scope(&mut self, scope: Scope, services: &Services) {
        self.scope.recorder.handle_action(recorder::RecorderAction::CancelExport);
        task_guard::drop_in_background(&services.tasks, std::mem::replace(&mut self.scope, scope));
    }

    fn show(&mut self, measurement: Measurement, services: &Services) {
        /// Number of samples above which memory is released on another thread. Below it, starting the thread would take
        /// longer than releasing the memory.
        const LARGE_CAPTURE_SAMPLES: usize = 100_000;
        if let Some(before) = self.measurement.replace(Arc::new(measurement))
            && before.capture.sine_v.len() > LARGE_CAPTURE_SAMPLES
        {
            task_guard::drop_in_background(&services.tasks, before);
        }
    }

    /// Displays a measurement of the newest samples instead of a capture.
    pub(super) fn show_live_measurement(&mut self, measurement: Measurement, services: &Services) {
        self.show(measurement, services);
        self.problem = None;
        self.table = None;
    }

    fn adopt_capture(&mut self, read: ReadCapture, reading: &CaptureReading, services: &mut Services) {
        let ReadCapture { table, result } = read;
        let path = table.place.path();
        match result {
            Ok((measurement, scope)) => {
                self.source.stop(services);
                self.replace_scope(scope, services);
                let judge = measurement.diagnosis_settings;
                self.show(measurement, services);
                if judge != self.diagnosis_settings() {
                    self.update_verdicts(services);
                }
                self.problem = None;
                self.table = Some(table);
            }
            Err(error @ ReadCaptureError::Cancelled) => {
                self.table = reading.settled.clone();
                services.log_without_display(
                    Severity::Note,
                    vec![explain::signal::read_capture_error_text(&path, &error)],
                    None,
                );
            }
            Err(error) => {
                let text = explain::signal::read_capture_error_text(&path, &error);
                services.log_without_display(Severity::Error, vec![text.clone()], None);
                self.problem = Some(text);
                self.table = Some(table);
            }
        }
    }

    /// Returns the table of the displayed capture, not one that is still being read.
    fn displayed_table(&self) -> Option<Table> {
        self.reading.as_ref().map_or_else(|| self.table.clone(), |reading| reading.settled.clone())
    }

    fn reread_with_hints(&mut self, services: &mut Services, change: impl FnOnce(&mut TableHints)) {
        let settled = self.displayed_table();
        if let Some(table) = &mut self.table {
            change(&mut table.hints);
            self.read_again(settled, services);
        }
    }

    fn read_again(&mut self, settled: Option<Table>, services: &mut Services) {
        if let Some(table) = &self.table {
            self.read(table.place.clone(), table.hints.clone(), settled, services);
        }
    }

    fn open_table_source(&mut self, place: TableSource, services: &mut Services) {
        let settled = self.displayed_table();
        if std::mem::take(&mut self.periods_of_source) {
            self.periods = None;
        }
        self.read(place, TableHints::default(), settled, services);
    }

    pub(super) fn diagnosis_settings(&self) -> DiagnosisSettings {
        DiagnosisSettings { family: self.family, periods: self.periods }
    }

    pub(super) fn update_verdicts(&mut self, services: &mut Services) {
        let Some(measurement) = self.measurement.clone() else { return };
        self.judgements = self.judgements.wrapping_add(1);
        let (number, judge) = (self.judgements, self.diagnosis_settings());
        task_guard::run(&services.tasks, "judge", TaskResult::Failed(FailedTask::Judge), move || {
            TaskResult::Rediagnosed { number, measurement: Box::new(measurement.with_settings(judge)) }
        });
    }

    /// Starts reading a table. A previous reading still in progress is cancelled.
    fn read(&mut self, place: TableSource, hints: TableHints, settled: Option<Table>, services: &mut Services) {
        self.attempts = self.attempts.wrapping_add(1);
        let number = self.attempts;
        let (reading, progress) = CaptureReading::new(number, place.clone(), settled);
        self.reading = Some(reading);
        let judge = self.diagnosis_settings();
        task_guard::run(&services.tasks, "capture", TaskResult::Failed(FailedTask::Read(number)), move || {
            TaskResult::Read { number, read: Box::new(reading::read(place, hints, judge, &progress)) }
        });
    }
}
