//! Imports cam tables from a file or pasted text, and exports them.

use std::path::PathBuf;

use super::TaskResult;
use super::encoder::Encoder;
use super::staged::Edit;
use crate::app::Text;
use crate::app::action::{Action as StudioAction, TaskResult as StudioDone};
use crate::app::services::Services;
use crate::devices::interbus::profile::{CamTable, TableOptions, emit_table};
use crate::devices::interbus::protocol::ProgramNumber;
use crate::store::{read_file, write_atomically};

/// A cam table that has been read but not applied yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    pub origin: Text,
    /// Content of the table. Positions are in the unit of the scale that is currently selected.
    pub table: CamTable,
    text: String,
    /// Program for rows that do not name one.
    program: ProgramNumber,
}

impl Encoder {
    pub(super) fn open_table(&mut self, path: PathBuf, services: &Services) {
        let session = self.session.id;
        services.tasks.run("table", move || {
            let result = read_file(&path);
            StudioAction::Done(StudioDone::device(session, TaskResult::Read(path, result)))
        });
    }

    pub(super) fn read_table(&mut self, origin: Text, text: String, program: ProgramNumber) {
        self.refusal = None;
        let table = self.options(program).read(&text);
        self.import = Some(Import { origin, table, text, program });
    }

    fn options(&self, program: ProgramNumber) -> TableOptions {
        TableOptions { scale: self.scale, range: self.step_count(), program }
    }

    /// Parses the table again after the scale or the measuring range has changed.
    pub(super) fn reparse_import(&mut self) {
        let Some(program) = self.import.as_ref().map(|import| import.program) else { return };
        let options = self.options(program);
        if let Some(import) = &mut self.import {
            import.table = options.read(&import.text);
        }
    }

    /// Adds the imported table to the edits, or discards it. A table with problems is never added, because a cam on an
    /// omitted line would be switched off.
    pub(super) fn finish_import(&mut self, take: bool) {
        let Some(import) = &self.import else { return };
        if take && !import.table.problems.is_empty() {
            return;
        }
        if take {
            let edit = Edit::Table(import.table.to_programs());
            self.apply_edit(&edit);
        }
        if !take || self.refusal.is_none() {
            self.import = None;
        }
    }

    pub(super) fn save_table(&mut self, path: PathBuf, decimal_comma: bool, services: &Services) {
        let Some(wanted) = self.staged.edited_values() else { return };
        let text = emit_table(&wanted.image, &wanted.names, &self.scale, decimal_comma);
        let session = self.session.id;
        services.tasks.run("export", move || {
            let result = write_atomically(&path, text.as_bytes());
            StudioAction::Done(StudioDone::device(session, TaskResult::Written(path, result)))
        });
    }
}
