//! Labels of the cells, fields and handles of a frame.

use super::{Field, Handle, Kind, Strip};
use crate::app::Text;
use crate::devices::ssi::protocol::{BitMeaning, GrayCoverage, Role};
use crate::devices::ssi::state::TEXTS;

/// Returns a sentence about the bit at a clock.
pub fn cell_text(strip: &Strip, clock: u8) -> Text {
    let index = usize::from(clock).checked_sub(1);
    let cell = index.and_then(|index| strip.cells().get(index));
    let text = TEXTS.text("ssi.strip_cell").with("clock", clock);
    let count = |id, bit: u8, kind: Kind| {
        let count: u8 = strip.fields().iter().filter(|field| field.kind == kind).map(Field::count).sum();
        TEXTS.text(id).with("bit", bit).with("count", count)
    };
    text.with_text(
        "what",
        match cell.map(|cell| cell.role) {
            Some(Role::Multiturn(bit)) => count("ssi.strip_multiturn_bit", bit, Kind::Turns),
            Some(Role::Singleturn(bit)) => count("ssi.strip_singleturn_bit", bit, Kind::Steps),
            Some(Role::Position(bit)) => count("ssi.strip_position_bit", bit, Kind::Position),
            Some(Role::Error(index)) => error(strip, index),
            Some(Role::Parity) => parity(strip),
            Some(Role::Repetition(clock)) => TEXTS.text("ssi.strip_again_bit").with("clock", clock),
            Some(Role::Zero) | None => TEXTS.text("ssi.strip_zero_bit"),
        },
    )
}

pub fn field(strip: &Strip, field: &Field) -> Text {
    let count = |id| TEXTS.text(id).with("count", field.count());
    match field.kind {
        Kind::Before => count("ssi.strip_before"),
        Kind::Between => count("ssi.strip_between"),
        Kind::Behind => count("ssi.strip_behind"),
        Kind::Gap => count("ssi.strip_gap"),
        Kind::After => count("ssi.strip_after"),
        Kind::Turns => count("ssi.strip_turns"),
        Kind::Steps => count("ssi.strip_steps"),
        Kind::Position => count("ssi.strip_position"),
        Kind::Error(index) => TEXTS.text("ssi.strip_name").with("name", error_name(strip, index)),
        Kind::Parity => TEXTS.text("ssi.strip_parity"),
        Kind::Again => count("ssi.strip_again"),
    }
}

/// Returns the label below a field. The label of zeros is only their number.
pub fn name(strip: &Strip, own: &Field) -> Text {
    if own.is_zero_field() { TEXTS.text("ssi.strip_behind").with("count", own.count()) } else { field(strip, own) }
}

/// Returns a short label for a narrow field, with the width in bits.
pub fn short_label(strip: &Strip, field: &Field) -> Text {
    let id = match field.is_zero_field() {
        true => "ssi.strip_short_zeros",
        false if field.is_single_bit() => "ssi.strip_name",
        false => "ssi.strip_short",
    };
    TEXTS.text(id).with("name", field_name(strip, field)).with("count", field.count())
}

/// Returns the short name of a field, which exports use as well.
pub fn field_name(strip: &Strip, field: &Field) -> String {
    match field.kind {
        _ if field.is_zero_field() => "0".to_owned(),
        Kind::Turns => "MT".to_owned(),
        Kind::Steps => "ST".to_owned(),
        Kind::Position => "P".to_owned(),
        Kind::Again => "=".to_owned(),
        Kind::Error(index) => error_name(strip, index),
        _ => "PAR".to_owned(),
    }
}

pub fn clocks_text(field: &Field) -> Text {
    if field.first == field.last {
        TEXTS.text("ssi.strip_on_clock").with("clock", field.first)
    } else {
        TEXTS.text("ssi.strip_clocks").with("first", field.first).with("last", field.last)
    }
}

pub fn handle_text(strip: &Strip, handle: Handle) -> Text {
    TEXTS.text(match handle {
        Handle::LeadEnd => "ssi.strip_lead_end",
        Handle::Split => "ssi.strip_split",
        Handle::TurnsEnd => "ssi.strip_turns_end",
        Handle::BetweenEnd => "ssi.strip_between_end",
        Handle::StepsEnd => "ssi.strip_steps_end",
        Handle::AreaEnd if strip.layout().descriptor().coded == GrayCoverage::Position => "ssi.strip_shifted_end",
        Handle::AreaEnd => "ssi.strip_coded_end",
        Handle::WordEnd => "ssi.strip_word_end",
        Handle::GapEnd => "ssi.strip_gap_end",
        Handle::FrameEnd => "ssi.strip_frame_end",
        Handle::Position => "ssi.strip_whole",
        Handle::Error(index) => return TEXTS.text("ssi.strip_error_bit").with("name", error_name(strip, index)),
        Handle::Parity => "ssi.strip_parity_bit",
    })
}

pub fn value(strip: &Strip, handle: Handle) -> Text {
    let clock = strip.clock(handle).unwrap_or(0);
    let at = |id| TEXTS.text(id).with("clock", clock);
    match handle {
        Handle::Error(index) => at("ssi.strip_bit_at").with_text("what", meaning_text(strip, index)),
        Handle::Parity => at("ssi.strip_on_clock"),
        Handle::Position => at("ssi.strip_from_clock"),
        _ if clock == 0 => TEXTS.text("ssi.strip_at_beginning"),
        _ => at("ssi.strip_behind_clock"),
    }
}

pub fn reach_text(strip: &Strip, handle: Handle, following: bool) -> Text {
    let (first, last) = strip.limits(handle, following);
    if first == last {
        TEXTS.text("ssi.strip_stuck")
    } else {
        TEXTS.text("ssi.strip_reach").with("first", first).with("last", last)
    }
}

pub fn handle_hint(handle: Handle) -> Text {
    TEXTS.text(match handle {
        Handle::LeadEnd => "ssi.strip_move_lead_end",
        Handle::Split => "ssi.strip_move_split",
        Handle::TurnsEnd => "ssi.strip_move_turns_end",
        Handle::BetweenEnd => "ssi.strip_move_between_end",
        Handle::StepsEnd => "ssi.strip_move_steps_end",
        Handle::AreaEnd => "ssi.strip_move_area_end",
        Handle::WordEnd => "ssi.strip_move_word_end",
        Handle::GapEnd => "ssi.strip_move_gap_end",
        Handle::FrameEnd => "ssi.strip_move_frame_end",
        Handle::Position => "ssi.strip_move_position",
        Handle::Error(_) | Handle::Parity => "ssi.strip_move_bit",
    })
}

fn error_name(strip: &Strip, index: usize) -> String {
    strip.layout().role_name(Role::Error(index))
}

fn meaning_text(strip: &Strip, index: usize) -> Text {
    let bit = strip.layout().descriptor().errors.get(index);
    TEXTS.text(match bit.map(|bit| (bit.meaning, bit.cleared_by_transfer)) {
        Some((BitMeaning::Warning, _)) => "ssi.strip_means_warning",
        Some((BitMeaning::Invalid, true)) => "ssi.strip_means_was_invalid",
        Some((BitMeaning::Invalid, false)) | None => "ssi.strip_means_invalid",
    })
}

fn error(strip: &Strip, index: usize) -> Text {
    let low = strip.layout().descriptor().errors.get(index).is_some_and(|bit| bit.active_low);
    let id = if low { "ssi.strip_error_low" } else { "ssi.strip_error" };
    TEXTS.text(id).with("name", error_name(strip, index)).with_text("what", meaning_text(strip, index))
}

fn parity(strip: &Strip) -> Text {
    let parity = strip.layout().descriptor().parity;
    let before = parity.map_or(0, |parity| parity.clock.saturating_sub(1));
    let even = parity.is_some_and(|parity| parity.even);
    TEXTS.text(if even { "ssi.strip_even" } else { "ssi.strip_odd" }).with("clock", before)
}
