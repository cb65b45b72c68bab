//! Why a layout cannot be: what the frame, its family or a format string says, in both languages.

use crate::app::Text;
use crate::app::explain::{phrase, phrase_with, plain};
use crate::devices::ssi::protocol::{FormatError, FrameTextError, LayoutError, SettingsError};
use crate::devices::ssi::state::TEXTS;

/// A frame that cannot work.
pub fn layout(error: &LayoutError) -> Text {
    refused(phrase_with(&error.to_string(), &error.phrases()))
}

/// Settings that a family does not have.
pub fn settings(error: &SettingsError) -> Text {
    let why = match error {
        SettingsError::None { family, field } => {
            TEXTS.text("ssi.lacks").with("family", family).with_text("field", field_name(field))
        }
        SettingsError::Both(one, other) => {
            TEXTS.text("ssi.both").with_text("one", field_name(one)).with_text("other", field_name(other))
        }
        SettingsError::Limit { family, field, least, most, value } => TEXTS
            .text("ssi.limit")
            .with("family", family)
            .with_text("field", field_name(field))
            .with("least", least)
            .with("most", most)
            .with("value", value),
        SettingsError::Align { family, bits, align, possible } => TEXTS
            .text("ssi.align_refused")
            .with("family", family)
            .with("bits", bits)
            .with("align", align)
            .with("possible", possible),
        SettingsError::Errors { family, place, possible } => {
            TEXTS.text("ssi.errors_refused").with("family", family).with("place", place).with("possible", possible)
        }
        SettingsError::Clocks { family, most, clocks } => {
            TEXTS.text("ssi.clocks_refused").with("family", family).with("most", most).with("clocks", clocks)
        }
        SettingsError::Layout(error) => return layout(error),
        other => phrase(&other.to_string()),
    };
    refused(why)
}

/// A format string of LinuxCNC that is no frame, or a frame that has none.
pub fn format(error: &FormatError) -> Text {
    match error {
        FormatError::Cannot(what) => TEXTS.text("ssi.lc_cannot").with_text("what", phrase(what)),
        FormatError::Layout(error) => layout(error),
        other => refused(phrase(&other.to_string())),
    }
}

/// Why a text is no frame.
pub fn frame_text(error: &FrameTextError) -> Text {
    match error {
        FrameTextError::Form(text) => TEXTS.text("ssi_trial.form").with("text", text),
        FrameTextError::Bits { text, bits, clocks, .. } => {
            TEXTS.text("ssi_trial.bits").with("text", text).with("bits", bits).with("clocks", clocks)
        }
    }
}

fn refused(why: Text) -> Text {
    TEXTS.text("ssi.refused").with_text("why", why)
}

/// What a family's description calls a setting.
fn field_name(field: &str) -> Text {
    let id = match field {
        "mt" | "multiturn" => "ssi_field.multiturn",
        "multiturn bits" => "ssi_field.multiturn_bits",
        "st" => "ssi_field.singleturn",
        "singleturn bits" => "ssi_field.singleturn_bits",
        "bits" => "ssi_field.bits",
        "steps" => "ssi_field.steps",
        "steps per turn" => "ssi_field.steps_per_turn",
        "steps altogether" => "ssi_field.steps_altogether",
        "steps over so many revolutions" => "ssi_field.steps_around",
        "turns" | "number of turns without steps" => "ssi_field.turns",
        "revolutions" => "ssi_field.revolutions",
        "revolutions above the line" => "ssi_field.revolutions_above",
        "revolutions below the line" => "ssi_field.revolutions_below",
        "round axis" => "ssi_field.round_axis",
        "number of steps that is not a power of two" => "ssi_field.any_steps",
        "shifting to the right" => "ssi_field.shift",
        "step" | "length of a step" => "ssi_field.step",
        "preset" => "ssi_field.preset",
        "frame" => "ssi_field.frame",
        other => return plain(other),
    };
    TEXTS.text(id)
}
