//! Report of a finished run for saving and printing: plain text that fits a page, lengths in millimetres.

use super::{Axis, AxisStep, DriveFacts, SetupEnd, StepStatus, TestTarget, labels};
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

/// Returns the report of a completed set-up, or `None` while it is running. Values that were written back after the
/// set-up are reported as in `now`.
pub fn write_report(axis: &Axis, now: &DriveFacts, device: &Device, language: Language) -> Option<String> {
    let over = axis.run_summary()?;
    let seen = &over.seen;
    let mut page = Page { text: String::new(), language };
    page.write_text("", &TEXTS.text("hd_axis.report_title").with("when", &over.when));
    let drive = TEXTS.text("hd_axis.report_drive").with("device", &device.name).with("drive", axis.drive().get());
    let variant = device.variant.clone().unwrap_or_else(|| TEXTS.text("hd_op.unknown"));
    page.write_text("", &drive.with_text("variant", variant).with("serial", &device.serial_number));
    page.write_text("", &TEXTS.text(if over.end == SetupEnd::Done { "hd_axis.ended" } else { "hd_axis.cancelled" }));
    if let Some(pitch) = seen.pitch {
        let pitch = TEXTS.text("hd_axis.report_pitch").with_number("pitch", pitch.nanometres as f64 / 1e6, 3);
        page.write_text("", &pitch);
    }
    page.push_blank_line();
    AxisStep::ALL.into_iter().for_each(|step| report_step(&mut page, axis, step, seen));
    page.push_blank_line();
    write_outcome_lines(axis, now).iter().for_each(|line| page.write_text("", line));
    Some(page.text)
}

fn report_step(page: &mut Page, axis: &Axis, step: AxisStep, seen: &DriveFacts) {
    let reached = axis.step_status(step);
    let line = TEXTS.text("hd_axis.report_step").with("number", step.index() + 1);
    page.write_text(
        "",
        &line.with_text("step", labels::title(step)).with_text("reached", labels::step_status(reached)),
    );
    if matches!(reached, StepStatus::Done | StepStatus::Failed)
        && let Some(found) = labels::finding_text(axis, step, seen)
    {
        page.write_text(INDENT, &found);
    }
    if step == AxisStep::Test && TestTarget::ALL.into_iter().any(|place| axis.outcome_of(place).is_some()) {
        page.write_text(INDENT, &labels::speed_torque_text("hd_axis.report_effort"));
        for place in TestTarget::ALL {
            let Some(outcome) = axis.outcome_of(place) else { continue };
            let line = TEXTS.text("hd_axis.report_place").with_text("place", labels::target_text(place));
            page.write_text(INDENT, &line.with_text("outcome", labels::outcome_text(&outcome, seen)));
        }
    }
}

/// Returns what was written, whether it is saved, and which values now differ from the saved ones.
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

    /// Writes a text, wrapped to as many lines as required.
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
