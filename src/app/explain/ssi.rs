//! SSI in words: what a frame gives cause to say, and what was set that the manual does not speak of.

use crate::app::Text;
use crate::protocol::ssi::{Advice, Finding, Meaning, Warning};

/// Something that a frame gives cause to say.
pub fn finding(finding: &Finding) -> Text {
    match finding {
        Finding::Error { name, meaning, cleared_by_transfer } => {
            let id = match (meaning, cleared_by_transfer) {
                (Meaning::Invalid, false) => "ssi.error",
                (Meaning::Invalid, true) => "ssi.error_since",
                (Meaning::Warning, _) => "ssi.warning",
            };
            Text::new(id).with("name", name)
        }
        Finding::Pattern { name, meaning: Meaning::Invalid } => Text::new("ssi.pattern").with("name", name),
        Finding::Pattern { name, meaning: Meaning::Warning } => Text::new("ssi.pattern_perhaps").with("name", name),
        Finding::StuckHigh { sure: true } => Text::new("ssi.stuck_high"),
        Finding::StuckHigh { sure: false } => Text::new("ssi.stuck_high_perhaps"),
        Finding::StuckLow { sure: true } => Text::new("ssi.stuck_low"),
        Finding::StuckLow { sure: false } => Text::new("ssi.stuck_low_perhaps"),
        Finding::Code => Text::new("ssi.code"),
        Finding::Padding => Text::new("ssi.padding"),
        Finding::Parity => Text::new("ssi.parity"),
        Finding::Repeat => Text::new("ssi.repeat"),
    }
}

/// Something that is accepted although the manual does not speak of it.
pub fn advice(advice: &Advice) -> Text {
    match advice {
        Advice::Code(code) => Text::new("ssi.other_code").with("code", code),
        Advice::Clocks { bits, clocks } => Text::new("ssi.more_clocks").with("bits", bits).with("clocks", clocks),
    }
}

/// A time of a transfer that does not fit.
pub fn timing(warning: &Warning) -> Text {
    let micros = |time: &std::time::Duration| time.as_secs_f64() * 1e6;
    let kilohertz = |hz: f64| hz / 1000.0;
    match warning {
        Warning::EncoderClock { most_hz } => {
            Text::new("ssi.clock_encoder").with_number("khz", kilohertz((*most_hz).into()), 0)
        }
        Warning::CableClock { most_hz } => {
            Text::new("ssi.clock_cable").with_number("khz", kilohertz((*most_hz).into()), 0)
        }
        Warning::CableLong => Text::new("ssi.cable_long"),
        Warning::ClockSlow { least_hz } => Text::new("ssi.clock_slow").with_number("khz", kilohertz(*least_hz), 1),
        Warning::PauseShort { least } => Text::new("ssi.pause_short").with_number("micros", micros(least), 0),
        Warning::PauseLong { most } => Text::new("ssi.pause_long").with_number("millis", micros(most) / 1000.0, 0),
        Warning::Repeats { update } => Text::new("ssi.repeats").with_number("micros", micros(update), 0),
        Warning::NoSynchronous => Text::new("ssi.no_synchronous"),
    }
}
