//! State of a register table: selection, folding, and the value being edited.

use std::collections::BTreeSet;

use egui::Event;

use super::RegisterLocation;
use crate::app::Text;
use crate::ui::Theme;

#[derive(Clone, Debug, Default)]
pub struct RegisterView {
    pub(super) selected: Option<SelectedRow>,
    /// Collapsed groups, which show only their heading.
    pub(super) folded: BTreeSet<usize>,
    /// Registers whose bit fields are visible.
    pub(super) open: BTreeSet<RegisterLocation>,
    pub(super) edit: Option<Edit>,
    pub(super) wanted: Option<RegisterLocation>,
    /// Reason why the last edit was rejected.
    pub(super) refused: Option<String>,
    /// Whether the selection has moved and has to be scrolled into view.
    pub(super) reveal: bool,
    pub(super) page: usize,
    /// Width of the table at which a name did not fit. At this width, all names use the small font.
    pub(super) small_names_at: Option<f32>,
    /// Events typed in the previous frame after a key that moves the focus to or from the editor. The table or the
    /// editor receives them in the next frame.
    pub(super) late: Vec<Event>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SelectedRow {
    Group(usize),
    Row(RegisterLocation),
}

#[derive(Clone, Debug)]
pub(super) struct Edit {
    pub(super) place: RegisterLocation,
    pub(super) text: String,
    pub(super) problem: Option<Text>,
    /// Whether the edit has just begun and the editor must receive the keyboard focus.
    pub(super) begins: bool,
    /// Whether the edit began with a typed character instead of the existing value.
    pub(super) typed: bool,
}

impl RegisterView {
    pub fn selected(&self) -> Option<RegisterLocation> {
        match self.selected {
            Some(SelectedRow::Row(place)) => Some(place),
            Some(SelectedRow::Group(_)) | None => None,
        }
    }

    pub fn selected_group(&self) -> Option<usize> {
        match self.selected? {
            SelectedRow::Row(place) => Some(place.group),
            SelectedRow::Group(group) => Some(group),
        }
    }

    /// Returns the reason why the typed value was rejected or the value cannot be edited.
    pub fn problem(&self, theme: &Theme) -> Option<String> {
        let typed = self.edit.as_ref().and_then(|edit| edit.problem.as_ref()).map(|problem| theme.format_text(problem));
        typed.or_else(|| self.refused.clone())
    }

    /// Returns the register whose value is being entered or was rejected.
    pub fn edited_location(&self) -> Option<RegisterLocation> {
        self.edit.as_ref().map(|edit| edit.place)
    }

    /// Returns whether the edited value was rejected and its editor is still open.
    pub fn is_refused(&self) -> bool {
        self.edit.as_ref().is_some_and(|edit| edit.problem.is_some())
    }

    /// Selects a register, unfolds its group and scrolls to the register.
    pub fn select(&mut self, place: RegisterLocation) {
        self.folded.remove(&place.group);
        self.select_row(SelectedRow::Row(place));
    }

    pub fn set_folded(&mut self, group: usize, folded: bool) {
        if folded {
            self.folded.insert(group);
        } else {
            self.folded.remove(&group);
        }
    }

    pub fn is_folded(&self, group: usize) -> bool {
        self.folded.contains(&group)
    }

    /// Adapts to a changed set of registers. The selection and the edit stay with their register, or end if it no
    /// longer exists.
    pub fn follow_registers(&mut self, now: impl Fn(RegisterLocation) -> Option<RegisterLocation>) {
        self.selected = match self.selected {
            Some(SelectedRow::Row(place)) => now(place).map(SelectedRow::Row),
            group => group,
        };
        self.edit = self.edit.take().and_then(|edit| Some(Edit { place: now(edit.place)?, ..edit }));
        self.open = self.open.iter().filter_map(|place| now(*place)).collect();
        self.refused = None;
    }

    pub(super) fn select_row(&mut self, to: SelectedRow) {
        self.selected = Some(to);
        self.reveal = true;
    }

    pub(super) fn set_expanded(&mut self, place: RegisterLocation, shown: bool) {
        if shown {
            self.open.insert(place);
        } else {
            self.open.remove(&place);
        }
    }
}
