//! Messages for SSI: findings about a frame, settings that the manual does not mention, and reasons why no words
//! arrive.

mod check;
mod export;
mod family;
#[cfg(test)]
mod phrases;
mod rejection;

use crate::app::Text;
use crate::app::explain::link_error_text;
use crate::buses::bridge::state::adapter_error_text;
use crate::devices::ssi::jobs::JobError;
use crate::devices::ssi::protocol::{
    BitMeaning, ClassEvidence, Code, CountedFinding, FrameFinding, GrayCoverage, Layout, OpenQuestion, Range,
    SettingAdvice, UncertaintyReason, Warning,
};
use crate::devices::ssi::state::TEXTS;

pub use check::check_lines;
pub use export::export_text;
pub use family::{family_error_text, note_text};
pub use rejection::{
    burst_error_text, entry_error_text, format_error_text, frame_text, layout_error_text, settings_error_text,
    word_width_error_text,
};

/// Returns messages that explain why a job ended early. Each can be shown on a separate line.
pub fn job_error_texts(error: &JobError) -> Vec<Text> {
    vec![match error {
        JobError::Link(error) => link_error_text(error),
        JobError::Adapter(error) => adapter_error_text(error),
        JobError::Cancelled => Text::new("encoder.cancelled"),
    }]
}

/// Returns the reason why the connection was lost, or `None` if the error does not end the connection.
pub fn connection_loss_text(error: &JobError) -> Option<Text> {
    match error {
        JobError::Link(error) => Some(link_error_text(error)),
        JobError::Adapter(_) | JobError::Cancelled => None,
    }
}

pub fn finding_text(finding: &FrameFinding) -> Text {
    match finding {
        FrameFinding::Error { name, meaning, cleared_by_transfer } => {
            let id = match (meaning, cleared_by_transfer) {
                (BitMeaning::Invalid, false) => "ssi.error",
                (BitMeaning::Invalid, true) => "ssi.error_since",
                (BitMeaning::Warning, _) => "ssi.warning",
            };
            TEXTS.text(id).with("name", name)
        }
        FrameFinding::Pattern { name, meaning: BitMeaning::Invalid } => TEXTS.text("ssi.pattern").with("name", name),
        FrameFinding::Pattern { name, meaning: BitMeaning::Warning } => {
            TEXTS.text("ssi.pattern_perhaps").with("name", name)
        }
        FrameFinding::StuckHigh { sure: true } => TEXTS.text("ssi.stuck_high"),
        FrameFinding::StuckHigh { sure: false } => TEXTS.text("ssi.stuck_high_perhaps"),
        FrameFinding::StuckLow { sure: true } => TEXTS.text("ssi.stuck_low"),
        FrameFinding::StuckLow { sure: false } => TEXTS.text("ssi.stuck_low_perhaps"),
        FrameFinding::Code => TEXTS.text("ssi.code"),
        FrameFinding::Padding => TEXTS.text("ssi.padding"),
        FrameFinding::Parity => TEXTS.text("ssi.parity"),
        FrameFinding::Repeat => TEXTS.text("ssi.repeat"),
    }
}

pub fn advice_text(advice: &SettingAdvice) -> Text {
    match advice {
        SettingAdvice::Code(code) => TEXTS.text("ssi.other_code").with("code", code),
        SettingAdvice::Clocks { bits, clocks } => {
            TEXTS.text("ssi.more_clocks").with("bits", bits).with("clocks", clocks)
        }
    }
}

pub fn timing_warning_text(warning: &Warning) -> Text {
    let micros = |time: &std::time::Duration| time.as_secs_f64() * 1e6;
    let kilohertz = |hz: f64| hz / 1000.0;
    match warning {
        Warning::EncoderClock { most_hz } => {
            TEXTS.text("ssi.clock_encoder").with_number("khz", kilohertz((*most_hz).into()), 0)
        }
        Warning::CableClock { most_hz } => {
            TEXTS.text("ssi.clock_cable").with_number("khz", kilohertz((*most_hz).into()), 0)
        }
        Warning::CableLong => TEXTS.text("ssi.cable_long"),
        Warning::ClockSlow { least_hz } => TEXTS.text("ssi.clock_slow").with_number("khz", kilohertz(*least_hz), 1),
        Warning::PauseShort { least } => TEXTS.text("ssi.pause_short").with_number("micros", micros(least), 0),
        Warning::PauseLong { most } => TEXTS.text("ssi.pause_long").with_number("millis", micros(most) / 1000.0, 0),
        Warning::Repeats { update } => TEXTS.text("ssi.repeats").with_number("micros", micros(update), 0),
        Warning::NoSynchronous => TEXTS.text("ssi.no_synchronous"),
        Warning::SynchronousUnknown => TEXTS.text("ssi.synchronous_unknown"),
    }
}

/// Returns a one-line description of a frame with its clocks, positions, code and error bits.
pub fn layout_summary(layout: &Layout) -> Text {
    let descriptor = layout.descriptor();
    let range = match descriptor.range {
        Range::Bits { multiturn: 0, singleturn } => TEXTS.text("ssi_range.single").with("singleturn", singleturn),
        Range::Bits { multiturn, singleturn } => {
            TEXTS.text("ssi_range.multi").with("multiturn", multiturn).with("singleturn", singleturn)
        }
        Range::Steps { per_turn, turns } => TEXTS.text("ssi_range.steps").with("steps", per_turn).with("turns", turns),
        Range::RoundAxis { steps, revolutions } => TEXTS
            .text("ssi_range.round")
            .with("steps", steps)
            .with("above", revolutions.numerator)
            .with("below", revolutions.denominator),
        Range::Length { bits, step_nanometres } => {
            TEXTS.text("ssi_range.length").with("bits", bits).with("nanometres", step_nanometres)
        }
    };
    // If a name ends with the clock number, the number is not repeated.
    let named = |name: &str, clock: u8| match name.ends_with(&clock.to_string()) {
        true => name.to_owned(),
        false => format!("{name} {clock}"),
    };
    let errors = descriptor.errors.iter().map(|bit| named(&bit.name, bit.clock)).collect::<Vec<_>>();
    let errors = if errors.is_empty() { "–".to_owned() } else { errors.join(", ") };
    let line = TEXTS
        .text("ssi.frame_line")
        .with("clocks", layout.clock_count())
        .with_text("range", range)
        .with_text("code", code_text(descriptor.code))
        .with("lead", descriptor.lead)
        .with("errors", errors);
    unusual_step_cost(layout)
        .into_iter()
        .fold(line, |line, more| TEXTS.text("ssi.frame_and").with_text("line", line).with_text("more", more))
}

fn unusual_step_cost(layout: &Layout) -> Vec<Text> {
    let descriptor = layout.descriptor();
    let between = (descriptor.between > 0).then(|| TEXTS.text("ssi.frame_between").with("zeros", descriptor.between));
    let over = (descriptor.coded != GrayCoverage::Position).then(|| TEXTS.text("ssi.frame_over"));
    let parity = descriptor.parity.map(|parity| {
        TEXTS.text(if parity.even { "ssi.frame_even" } else { "ssi.frame_odd" }).with("clock", parity.clock)
    });
    let repeat = descriptor.repeat.map(|repeat| TEXTS.text("ssi.frame_twice").with("bits", repeat.word));
    let inverted = descriptor.inverted.then(|| TEXTS.text("ssi.frame_inverted"));
    [between, over, parity, repeat, inverted].into_iter().flatten().collect()
}

pub fn code_text(code: Code) -> Text {
    TEXTS.text(match code {
        Code::Binary => "ssi_form.binary",
        Code::Gray => "ssi_form.gray",
        Code::GrayExcess => "ssi_form.gray_excess",
        Code::Bcd => "ssi_form.bcd",
    })
}

pub fn open_question_text(open: OpenQuestion) -> Text {
    match open {
        OpenQuestion::TurnOnce => TEXTS.text("ssi_find.turn_once"),
        OpenQuestion::TurnFarther { from, to } if from == to => {
            TEXTS.text("ssi_find.turn_farther_one").with("clock", from)
        }
        OpenQuestion::TurnFarther { from, to } => TEXTS.text("ssi_find.turn_farther").with("from", from).with("to", to),
        OpenQuestion::ReachRangeEnd => TEXTS.text("ssi_find.pass_the_end"),
        OpenQuestion::Direction => TEXTS.text("ssi_find.direction"),
        OpenQuestion::OtherSpeed => TEXTS.text("ssi_find.other_speed"),
        OpenQuestion::CrossRangeEnd { least, most } => {
            TEXTS.text("ssi_find.steps").with("least", least).with("most", most)
        }
        OpenQuestion::Unexplained { clock } => TEXTS.text("ssi_find.unexplained").with("clock", clock),
        OpenQuestion::SeeAnError => TEXTS.text("ssi_find.see_an_error"),
        OpenQuestion::TypeLabel => TEXTS.text("ssi_find.type_label"),
    }
}

/// Returns a message that the best layout is certain, or the reason why it is not.
pub fn uncertainty_text(uncertainty: Option<UncertaintyReason>) -> Text {
    TEXTS.text(match uncertainty {
        None => "ssi_find.sure",
        Some(UncertaintyReason::Standing) => "ssi_find.standing",
        Some(UncertaintyReason::Stuck { high: true }) => "ssi.stuck_high",
        Some(UncertaintyReason::Stuck { high: false }) => "ssi.stuck_low",
        Some(UncertaintyReason::Nothing) => "ssi_find.nothing_fits",
        Some(UncertaintyReason::Close) => "ssi_find.close",
        Some(UncertaintyReason::Open) => "ssi_find.open",
    })
}

pub fn evidence_for(evidence: &ClassEvidence) -> Text {
    TEXTS
        .text("ssi_find.evidence")
        .with("steps", evidence.steps_per_frame)
        .with("jumps", evidence.jumps)
        .with("misfits", evidence.misfits)
        .with("bits", evidence.bits_seen)
}

/// Returns a message that states how often and when a finding occurred.
pub fn finding_counts(noted: &CountedFinding) -> Text {
    let seconds = |time: crate::analysis::SampleTime| time.as_nanoseconds() as f64 / 1e9;
    let id = if noted.count == 1 { "ssi_tally.once" } else { "ssi_tally.often" };
    TEXTS.text(id).with("count", noted.count).with_number("first", seconds(noted.first), 3).with_number(
        "last",
        seconds(noted.last),
        3,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::buses::bridge::procedures::AdapterError;
    use crate::link::{LinkError, LinkErrorKind};

    #[test]
    fn errors_name_cause_and_remedy() {
        let name = || "bench adapter".to_owned();
        let cases = [
            (JobError::Link(LinkError::new("COM3", LinkErrorKind::Lost)), "COM3"),
            (JobError::Adapter(AdapterError::Silent), "."),
            (JobError::Adapter(AdapterError::NoSsi { name: name() }), "bench adapter"),
            (JobError::Adapter(AdapterError::Version { expected: 1, got: 2 }), "2"),
        ];
        for (error, fact) in cases {
            for language in [English, German] {
                let words: Vec<String> =
                    job_error_texts(&error).iter().map(|text| text.to_string_in(language)).collect();
                let words = words.join(" ");
                assert!(words.contains(fact) && !words.contains('{') && words.ends_with('.'), "{words}");
                assert!(words.trim_end_matches('.').contains(['.', ';', ':']), "{words}");
            }
        }
    }

    #[test]
    fn only_lost_link_ends_connection() {
        let gone = JobError::Link(LinkError::new("COM3", LinkErrorKind::Lost));
        assert_eq!(connection_loss_text(&gone).unwrap().id(), "link.lost");
        assert_eq!(connection_loss_text(&JobError::Adapter(AdapterError::Silent)), None);
        assert_eq!(job_error_texts(&JobError::Cancelled)[0].id(), "encoder.cancelled");
    }
}
