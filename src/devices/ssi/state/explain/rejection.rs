//! Messages about invalid layouts in both languages. The cause is an error in a frame, a family or a format string.

use crate::app::Text;
use crate::app::explain::literal_text;
use crate::devices::ssi::profile::EntryError;
use crate::devices::ssi::protocol::{
    BurstError, ClockUse, CodeError, FormatError, FrameTextError, LayoutError, RangeError, RepeatableElement,
    SettingName, SettingsError, UnsupportedProperty, WordOperation, WordWidthError,
};
use crate::devices::ssi::state::TEXTS;
use crate::profile::Cause;

pub fn layout_error_text(error: &LayoutError) -> Text {
    rejection_text(layout_error_reason(error))
}

pub fn settings_error_text(error: &SettingsError) -> Text {
    rejection_text(settings_error_reason(error))
}

/// Returns the reason why settings are invalid, as part of a sentence.
pub(super) fn settings_error_reason(error: &SettingsError) -> Text {
    match error {
        SettingsError::None { family, field } => {
            TEXTS.text("ssi.lacks").with("family", family).with_text("field", field_name(*field))
        }
        SettingsError::Both(one, other) => {
            TEXTS.text("ssi.both").with_text("one", field_name(*one)).with_text("other", field_name(*other))
        }
        SettingsError::Limit { family, field, least, most, value } => TEXTS
            .text("ssi.limit")
            .with("family", family)
            .with_text("field", field_name(*field))
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
        SettingsError::Layout(error) => layout_error_reason(error),
        SettingsError::Range(error) => range_error_reason(error),
        SettingsError::Code(error) => code_error_reason(error),
    }
}

/// Returns the message for an invalid LinuxCNC format string, or for a frame that has no format string.
pub fn format_error_text(error: &FormatError) -> Text {
    let why = match error {
        FormatError::Cannot(what) => {
            let what = match what {
                UnsupportedProperty::GrayOver => TEXTS.text("ssi_lc.gray_over"),
                UnsupportedProperty::GrayExcess | UnsupportedProperty::Bcd => literal_text(what),
                UnsupportedProperty::Between => TEXTS.text("ssi_lc.between"),
                UnsupportedProperty::Inverted => TEXTS.text("ssi_lc.inverted"),
            };
            return TEXTS.text("ssi.lc_cannot").with_text("what", what);
        }
        FormatError::Form(text) => TEXTS.text("ssi_lc.form").with("text", text),
        FormatError::Kind(kind) => TEXTS.text("ssi_lc.kind").with("kind", kind),
        FormatError::Two(one, other) => TEXTS.text("ssi_lc.two").with("one", one).with("other", other),
        FormatError::None => TEXTS.text("ssi_lc.none"),
        FormatError::Long => TEXTS.text("ssi_lc.long"),
        FormatError::Layout(error) => layout_error_reason(error),
    };
    rejection_text(why)
}

/// Returns the message for a layout that has no decoder for 32-bit controllers.
pub fn word_width_error_text(error: WordWidthError) -> Text {
    match error {
        WordWidthError::Position { bits } => TEXTS.text("ssi.wide_position").with("bits", bits),
        WordWidthError::RoundAxis => TEXTS.text("ssi.wide_round"),
    }
}

pub fn frame_text(error: &FrameTextError) -> Text {
    match error {
        FrameTextError::Form(text) => TEXTS.text("ssi_trial.form").with("text", text),
        FrameTextError::Bits { text, bits, clocks, .. } => {
            TEXTS.text("ssi_trial.bits").with("text", text).with("bits", bits).with("clocks", clocks)
        }
    }
}

/// Returns the reason why a recording of clock and data contains no frames.
pub fn burst_error_text(error: BurstError) -> Text {
    match error {
        BurstError::NoClock => TEXTS.text("ssi_capture.no_clock"),
        BurstError::NoPause => TEXTS.text("ssi_capture.no_pause"),
        BurstError::Incomplete => TEXTS.text("ssi_capture.incomplete"),
        BurstError::Long { clocks } => TEXTS.text("ssi_capture.long").with("clocks", clocks),
    }
}

fn rejection_text(why: Text) -> Text {
    TEXTS.text("ssi.refused").with_text("why", why)
}

fn field_name(field: SettingName) -> Text {
    TEXTS.text(match field {
        SettingName::Frame => "ssi_field.frame",
        SettingName::ShiftRight => "ssi_field.shift",
        SettingName::AnySteps => "ssi_field.any_steps",
        SettingName::Mt => "ssi_field.multiturn",
        SettingName::Multiturn => "ssi_field.multiturn",
        SettingName::MultiturnBits => "ssi_field.multiturn_bits",
        SettingName::St => "ssi_field.singleturn",
        SettingName::SingleturnBits => "ssi_field.singleturn_bits",
        SettingName::Bits => "ssi_field.bits",
        SettingName::Steps => "ssi_field.steps",
        SettingName::StepsPerTurn => "ssi_field.steps_per_turn",
        SettingName::StepsAltogether => "ssi_field.steps_altogether",
        SettingName::StepsAround => "ssi_field.steps_around",
        SettingName::Turns => "ssi_field.turns",
        SettingName::TurnsWithoutSteps => "ssi_field.turns",
        SettingName::Revolutions => "ssi_field.revolutions",
        SettingName::RevolutionsAbove => "ssi_field.revolutions_above",
        SettingName::RevolutionsBelow => "ssi_field.revolutions_below",
        SettingName::RoundAxis => "ssi_field.round_axis",
        SettingName::Step => "ssi_field.step",
        SettingName::StepLength => "ssi_field.step",
        SettingName::Preset => "ssi_field.preset",
    })
}

/// Returns the reason why a frame is invalid, as part of a sentence.
pub(super) fn layout_error_reason(error: &LayoutError) -> Text {
    match error {
        LayoutError::Clocks(clocks) => TEXTS.text("ssi_reason.clocks").with("clocks", clocks),
        LayoutError::Range(error) => range_error_reason(error),
        LayoutError::Code(error) => code_error_reason(error),
        LayoutError::Area { area, clocks } => TEXTS.text("ssi_reason.area").with("area", area).with("clocks", clocks),
        LayoutError::Wide { bits, lead, needed, area } => TEXTS
            .text("ssi_reason.wide")
            .with("bits", bits)
            .with("lead", lead)
            .with("needed", needed)
            .with("area", area),
        LayoutError::Between => TEXTS.text("ssi_reason.between"),
        LayoutError::Overlap { clock, first, second } => TEXTS
            .text("ssi_reason.overlap")
            .with("clock", clock)
            .with_text("first", clock_use_text(first))
            .with_text("second", clock_use_text(second)),
        LayoutError::Behind { name, clock, clocks } => TEXTS
            .text("ssi_reason.behind")
            .with_text("name", clock_use_text(name))
            .with("clock", clock)
            .with("clocks", clocks),
        LayoutError::Many { what, limit, count } => {
            let what = TEXTS.text(match what {
                RepeatableElement::ErrorBits => "ssi_reason.error_bits",
                RepeatableElement::Patterns => "ssi_reason.patterns",
            });
            TEXTS.text("ssi_reason.many").with("limit", limit).with_text("what", what).with("count", count)
        }
        LayoutError::NotGray => TEXTS.text("ssi_reason.not_gray"),
        LayoutError::Inside { name, clock, area, done } => {
            let id = match done {
                WordOperation::Coded => "ssi_reason.inside_coded",
                WordOperation::Shifted => "ssi_reason.inside_shifted",
            };
            TEXTS.text(id).with_text("name", clock_use_text(name)).with("clock", clock).with("area", area)
        }
        LayoutError::Lost => TEXTS.text("ssi_reason.lost"),
        LayoutError::Repeat { needed, clocks } => {
            TEXTS.text("ssi_reason.repeat").with("needed", needed).with("clocks", clocks)
        }
        LayoutError::Pattern { word, clocks } => {
            TEXTS.text("ssi_reason.pattern_bits").with("word", format!("{word:X}")).with("clocks", clocks)
        }
    }
}

fn range_error_reason(error: &RangeError) -> Text {
    match error {
        RangeError::Wide { field, bits, limit } => {
            TEXTS.text("ssi_reason.field_bits").with("field", field).with("limit", limit).with("bits", bits)
        }
        RangeError::Empty => TEXTS.text("ssi_reason.single"),
        RangeError::Fraction(above, below) => {
            TEXTS.text("ssi_reason.revolutions").with("above", above).with("below", below)
        }
    }
}

fn code_error_reason(error: &CodeError) -> Text {
    match error {
        CodeError::Odd(steps) => TEXTS.text("ssi_reason.odd").with("steps", steps),
        CodeError::Digits(digits) => TEXTS.text("ssi_reason.digits").with("digits", digits),
    }
}

fn clock_use_text(taker: &ClockUse) -> Text {
    match taker {
        ClockUse::Position => TEXTS.text("ssi_reason.position"),
        ClockUse::Parity => TEXTS.text("ssi_reason.parity"),
        ClockUse::Error(name) => literal_text(name),
    }
}

pub fn entry_error_text(cause: &Cause) -> Option<Text> {
    Some(match cause.get()? {
        EntryError::Layout(error) => layout_error_reason(error),
        EntryError::Preset { preset, last } => TEXTS.text("ssi_entry.preset").with("preset", preset).with("last", last),
        EntryError::NotWith(other) => TEXTS.text("ssi_entry.not_with").with("other", other),
        EntryError::NoPositions => TEXTS.text("ssi_entry.no_positions"),
    })
}
