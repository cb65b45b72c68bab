//! SSI in words: what a frame gives cause to say, and what was set that the manual does not speak of.

use crate::app::Text;
use crate::protocol::ssi::{Advice, Finding, Meaning};

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
