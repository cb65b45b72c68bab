//! Commands `position` and `status` for an SSI encoder behind an adapter.

use serde_json::{Value as Json, json};

use super::args::{LayoutOption, SsiLayoutArgs};
use super::frames::{DecodedFrame, name};
use super::layout::{SelectedLayout, select_layout};
use super::run::{open_runner, words_from_output};
use crate::analysis::SampleTime;
use crate::cli::args::{CommonArgs, Position, Status};
use crate::cli::output::{Lines, Output, count, write_stderr};
use crate::cli::positions::print_readings;
use crate::cli::{Failure, Result, Success};
use crate::devices::ssi::jobs::SsiJob;
use crate::devices::ssi::protocol::{BitMeaning, FindingCounts, FrameFinding, Layout, Location};
use crate::devices::ssi::state::explain as explained;
use crate::units::Moment;

/// Returns the layout given by the user, or an error if there is none.
fn required_layout(output: &Output, command: &str, given: &LayoutOption) -> Result<SelectedLayout> {
    let Some(spec) = given.layout.clone() else {
        let why = "ssi needs --layout FILE|SPEC: an SSI encoder does not report the layout of its frame";
        return Err(Failure::Usage(format!("{command} {why}")));
    };
    select_layout(output, &SsiLayoutArgs { spec })
}

pub(super) fn position(common: &CommonArgs, output: &Output, position: &Position) -> Result {
    let chosen = required_layout(output, "position", &position.own.read()?)?;
    let mut runner = open_runner(common, output, &chosen)?;
    if position.csv {
        output.write_stdout("t_s,raw,turns,steps,degrees,millimetres,valid\n")?;
    }
    let mut tally = FindingCounts::default();
    let mut first = None;
    let job = || SsiJob::Read;
    let ended = print_readings(&mut runner, position, job, |came| {
        for (at, word) in words_from_output(came)?.iter_with_times() {
            let decoded = DecodedFrame::new(&chosen.layout, word);
            let first = *first.get_or_insert(SampleTime::from(at));
            let begun = tally.count_findings(&chosen.layout, decoded.reading, at.into());
            for finding in begun.iter().filter(|one| is_reported(one, first == at.into())) {
                write_stderr(&format!(
                    "{}: {}\n",
                    format_seconds(at.into()),
                    explained::finding_text(finding).terminal_text()
                ));
            }
            if position.csv {
                output.write_stdout(&row(at, &decoded))?;
            } else {
                show(output, at, &decoded)?;
            }
        }
        Ok(())
    });
    for noted in tally.finding_counts().iter().filter(|noted| is_reported(&noted.finding, Some(noted.first) == first)) {
        let times = count(usize::try_from(noted.count).unwrap_or(usize::MAX), "time");
        write_stderr(&format!("{}: {times}, last at {}\n", name(&noted.finding), format_seconds(noted.last)));
    }
    ended
}

/// Returns whether to report a finding. A position that looks like an idle line is reported only for the first word,
/// because a moving encoder can pass such a position.
fn is_reported(finding: &FrameFinding, is_first: bool) -> bool {
    is_first || !matches!(finding, FrameFinding::StuckHigh { sure: false } | FrameFinding::StuckLow { sure: false })
}

fn format_seconds(at: SampleTime) -> String {
    format!("{:.3} s", at.seconds_since(SampleTime::ORIGIN))
}

/// Output columns for a position: turns, steps and degrees for a shaft, or steps and millimetres for a scale.
struct Columns {
    turns: Option<u64>,
    steps: Option<u64>,
    degrees: Option<f64>,
    millimetres: Option<f64>,
}

impl Columns {
    fn from_frame(decoded: &DecodedFrame<'_>) -> Self {
        let none = Columns { turns: None, steps: None, degrees: None, millimetres: None };
        match decoded.position_location() {
            Some((_, Location::Shaft { turns, steps, degrees })) => {
                Columns { turns: Some(turns), steps: Some(steps), degrees: Some(degrees), ..none }
            }
            Some((position, Location::Length { millimetres })) => {
                Columns { steps: Some(position), millimetres: Some(millimetres), ..none }
            }
            None => none,
        }
    }
}

fn show(output: &Output, at: Moment, decoded: &DecodedFrame<'_>) -> Result<()> {
    let t = at.since_start().as_secs_f64();
    let Columns { turns, steps, degrees, millimetres } = Columns::from_frame(decoded);
    let mut json = json!({
        "t_s": t,
        "raw": decoded.frame,
        "turns": turns,
        "steps": steps,
        "degrees": degrees,
        "valid": decoded.is_valid(),
        "errors": decoded.finding_names(BitMeaning::Invalid),
        "warnings": decoded.finding_names(BitMeaning::Warning),
    });
    if let (Some(millimetres), Some(keys)) = (millimetres, json.as_object_mut()) {
        keys.insert("millimetres".to_owned(), json!(millimetres));
    }
    let digits = usize::from(decoded.layout.clock_count()).div_ceil(4);
    let valid = if decoded.is_valid() { "" } else { "  not valid" };
    output.show(&json, &format!("{t:10.3} s  0x{:0digits$X}  {}{valid}\n", decoded.frame, describe_position(decoded)))
}

fn describe_position(decoded: &DecodedFrame<'_>) -> String {
    match decoded.position_location() {
        Some((_, Location::Shaft { turns, steps, degrees })) => format!("turn {turns}, step {steps}, {degrees:.6}°"),
        Some((position, Location::Length { millimetres })) => format!("step {position}, {millimetres:.6} mm"),
        None => "no position".to_owned(),
    }
}

fn row(at: Moment, decoded: &DecodedFrame<'_>) -> String {
    fn format_cell<T: ToString>(value: Option<T>) -> String {
        value.map_or_else(String::new, |value| value.to_string())
    }
    let Columns { turns, steps, degrees, millimetres } = Columns::from_frame(decoded);
    format!(
        "{:.6},{},{},{},{},{},{}\n",
        at.since_start().as_secs_f64(),
        decoded.frame,
        format_cell(turns),
        format_cell(steps),
        format_cell(degrees),
        format_cell(millimetres),
        decoded.is_valid(),
    )
}

pub(super) fn status(common: &CommonArgs, output: &Output, status: &Status) -> Result {
    let chosen = required_layout(output, "status", &status.own.read()?)?;
    let mut runner = open_runner(common, output, &chosen)?;
    let words = words_from_output(runner.run(SsiJob::Read)?)?;
    let Some((_, word)) = words.iter_with_times().next() else {
        return Err(Failure::Failed(vec!["The adapter returned no word. Try again.".to_owned()]));
    };
    let decoded = DecodedFrame::new(&chosen.layout, word);
    let findings = chosen.layout.to_findings(decoded.reading);
    let of = |meaning| findings.iter().filter(move |finding| finding.meaning() == meaning);
    let list = |meaning| of(meaning).map(|finding| finding_json(&chosen.layout, finding)).collect::<Vec<_>>();
    let (errors, warnings) = (list(BitMeaning::Invalid), list(BitMeaning::Warning));
    let json = json!({"ok": errors.is_empty(), "errors": errors, "warnings": warnings});
    let named = |meaning| {
        let names = of(meaning).map(name).collect::<Vec<_>>();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    let mut lines = Lines::default();
    lines.add_line("errors", named(BitMeaning::Invalid)).add_line("warnings", named(BitMeaning::Warning));
    if chosen.layout.descriptor().errors.is_empty() {
        lines.add_line("", "This frame has no error bits.");
    }
    lines.add_line("position", describe_position(&decoded));
    let finding_lines =
        findings.iter().map(|finding| format!("{}\n", explained::finding_text(finding).terminal_text()));
    output.show(&json, &(lines.text() + &finding_lines.collect::<String>()))?;
    Ok(Success::Completed)
}

/// Converts a finding to JSON. The result includes the clock number if the finding concerns a single clock.
fn finding_json(layout: &Layout, finding: &FrameFinding) -> Json {
    let clock = match finding {
        FrameFinding::Error { name, .. } => layout.descriptor().errors.iter().find(|bit| bit.name == *name),
        _ => None,
    };
    json!({"code": clock.map(|bit| bit.clock), "text": name(finding)})
}
