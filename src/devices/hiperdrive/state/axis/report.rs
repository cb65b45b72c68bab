//! Report of a completed axis set-up, as plain text that can be saved and printed. Its lines fit a page, and its
//! lengths are in millimetres.

use super::{Axis, AxisStep, DriveFacts, SetupEnd, StepStatus, TestTarget, labels};
use crate::app::report::SessionResult;
use crate::app::{Language, Text};
use crate::devices::hiperdrive::state::TEXTS;

#[derive(Clone, Debug, PartialEq)]
pub struct Device {
    pub name: String,
    pub variant: Option<Text>,
    pub serial_number: String,
}

/// Width of a page in columns.
const COLUMNS: usize = 78;
const INDENT: &str = "   ";

/// Report of a completed axis set-up.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisReport {
    pub title: Text,
    /// The drive, how the set-up ended, and the pitch of the spindle.
    pub summary: Vec<Text>,
    /// Each step with its findings.
    pub steps: Vec<(Text, Vec<Text>)>,
    /// What was written, and whether it is saved.
    pub outcome: Vec<Text>,
}

impl AxisReport {
    /// Returns the report of a completed set-up, or `None` while it is running. `now` is needed to report values
    /// written back after the set-up.
    pub fn new(axis: &Axis, now: &DriveFacts, device: &Device) -> Option<Self> {
        let over = axis.run_summary()?;
        let seen = &over.seen;
        let drive = TEXTS.text("hd_axis.report_drive").with("device", &device.name).with("drive", axis.drive().get());
        let variant = device.variant.clone().unwrap_or_else(|| TEXTS.text("hd_op.unknown"));
        let drive = drive.with_text("variant", variant).with("serial", &device.serial_number);
        let end = TEXTS.text(if over.end == SetupEnd::Done { "hd_axis.ended" } else { "hd_axis.cancelled" });
        let pitch = seen
            .pitch
            .map(|pitch| TEXTS.text("hd_axis.report_pitch").with_number("pitch", pitch.nanometres as f64 / 1e6, 3));
        Some(AxisReport {
            title: TEXTS.text("hd_axis.report_title").with("when", &over.when),
            summary: [drive, end].into_iter().chain(pitch).collect(),
            steps: AxisStep::ALL.into_iter().map(|step| step_texts(axis, step, seen)).collect(),
            outcome: write_outcome_lines(axis, now),
        })
    }

    /// Returns the report as plain text.
    pub fn page(&self, language: Language) -> String {
        let mut page = Page { text: String::new(), language };
        page.write_text("", &self.title);
        self.summary.iter().for_each(|line| page.write_text("", line));
        page.push_blank_line();
        for (step, findings) in &self.steps {
            page.write_text("", step);
            findings.iter().for_each(|line| page.write_text(INDENT, line));
        }
        page.push_blank_line();
        self.outcome.iter().for_each(|line| page.write_text("", line));
        page.text
    }

    /// Converts this report into a section of the device report.
    pub fn into_session_result(self) -> SessionResult {
        let AxisReport { title, summary, steps, outcome } = self;
        let steps = steps.into_iter().flat_map(|(step, findings)| std::iter::once(step).chain(findings));
        SessionResult::Procedure { title, lines: summary.into_iter().chain(steps).chain(outcome).collect() }
    }
}

/// Returns the result of a step, and what was found.
fn step_texts(axis: &Axis, step: AxisStep, seen: &DriveFacts) -> (Text, Vec<Text>) {
    let reached = axis.step_status(step);
    let line = TEXTS.text("hd_axis.report_step").with("number", step.index() + 1);
    let line = line.with_text("step", labels::title(step)).with_text("reached", labels::step_status(reached));
    let mut findings = Vec::new();
    if matches!(reached, StepStatus::Done | StepStatus::Failed) {
        findings.extend(labels::finding_text(axis, step, seen));
    }
    let outcomes: Vec<Text> = TestTarget::ALL
        .into_iter()
        .filter_map(|place| {
            let outcome = axis.test_outcome(place)?;
            let line = TEXTS.text("hd_axis.report_place").with_text("place", labels::target_text(place));
            Some(line.with_text("outcome", labels::outcome_text(&outcome, seen)))
        })
        .collect();
    if step == AxisStep::Test && !outcomes.is_empty() {
        findings.push(labels::speed_torque_text("hd_axis.report_effort"));
        findings.extend(outcomes);
    }
    (line, findings)
}

/// Returns lines that list what was written, whether it is saved, and which current values differ from the saved ones.
pub fn write_outcome_lines(axis: &Axis, now: &DriveFacts) -> Vec<Text> {
    let mut lines = Vec::new();
    match (axis.changes().is_empty(), labels::write_back_text(axis, now)) {
        (true, None) => lines.push(TEXTS.text("hd_axis.nothing_written")),
        (true, Some(returned)) => lines.push(returned),
        (false, returned) => {
            lines.push(labels::changes_text(axis));
            lines.extend(returned);
            lines.push(TEXTS.text(if axis.is_saved() { "hd_axis.all_saved" } else { "hd_axis.not_saved" }));
        }
    }
    if axis.is_partly_written() {
        lines.push(TEXTS.text("hd_axis.partly"));
    }
    lines.extend(labels::differences(now));
    lines.extend(labels::unrestored_position_text(axis, now));
    lines.extend(labels::unexplained_change_text(axis, axis.displayed_facts(now)));
    lines
}

struct Page {
    text: String,
    language: Language,
}

impl Page {
    fn push_blank_line(&mut self) {
        self.text.push('\n');
    }

    /// Appends a text, wrapped to the width of the page.
    fn write_text(&mut self, indent: &str, text: &Text) {
        let mut line = String::new();
        for word in text.to_string_in(self.language).split_whitespace() {
            let width = indent.chars().count() + line.chars().count() + word.chars().count();
            if !line.is_empty() && width >= COLUMNS {
                self.write_line(indent, &line);
                line.clear();
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        self.write_line(indent, &line);
    }

    fn write_line(&mut self, indent: &str, line: &str) {
        self.text.push_str(indent);
        self.text.push_str(line);
        self.text.push('\n');
    }
}
