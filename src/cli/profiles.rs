//! Profile commands for all device kinds: `diff`, `verify`, and the common parts of `save` and `restore`. The content
//! of the file determines the kind.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde_json::{Value as Json, json};

use super::args::{CommonArgs, DiffArgs, Restore};
use super::consent::require_consent;
use super::log::profile_path;
use super::output::{Lines, Output, write_stderr};
use super::plan::{NOTHING_TO_WRITE, PlanReport, WriteSummary, print_undo, undo_json};
use super::runner::to_failure;
use super::user_store::user_store;
use super::{Failure, Result, Success};
use crate::app::documents::new_document;
use crate::app::{KindRegistry, explain, review};
use crate::profile::{Body, Comparison, Profile, ProfileDocument, RestoreOptions};
use crate::store::{Event, read_text, write_atomically};
use crate::worker::commit::PlannedWrite;

/// Reads a profile of any device kind for display or comparison.
pub(crate) fn load(output: &Output, path: &Path) -> Result<Body> {
    let document = read_document(output, path)?;
    print_profile_note(output, path, &document)?;
    Ok(document.body)
}

/// Reads a profile that is to be written to a device. All parts of its schema must be known.
pub(crate) fn load_profile_to_write(output: &Output, path: &Path) -> Result<Body> {
    let document = read_document(output, path)?
        .check_schema()
        .map_err(|error| to_failure(&explain::profile_file_error_text(path, &error, KindRegistry::NONE)))?;
    print_profile_note(output, path, &document)?;
    Ok(document.body)
}

fn print_profile_note(output: &Output, path: &Path, document: &ProfileDocument) -> Result<()> {
    explain::profile_remarks(path, document)
        .iter()
        .for_each(|words| write_stderr(&format!("{}\n", words.terminal_text())));
    if let Some(words) = output.commands().device(document.body.kind())?.profile_note(&document.body) {
        write_stderr(&format!("{}: {}\n", path.display(), words.terminal_text()));
    }
    Ok(())
}

pub(super) fn read_document(output: &Output, path: &Path) -> Result<ProfileDocument> {
    let text = read_text(path).map_err(|error| to_failure(&explain::file_error_text(&error)))?;
    ProfileDocument::parse(&text, output.formats())
        .map_err(|error| to_failure(&explain::profile_file_error_text(path, &error, KindRegistry::NONE)))
}

/// Saves a profile that was read from the device of this command, and records this in the logbook.
pub fn save_profile(common: &CommonArgs, path: &Path, body: Body) -> Result<()> {
    write_atomically(path, new_document(body).emit().as_bytes())
        .map_err(|error| to_failure(&explain::file_error_text(&error)))?;
    let store = user_store(common)?;
    common.log.record(&store, &Event::saved_profile(path));
    Ok(())
}

pub(super) fn diff(common: &CommonArgs, output: &Output, diff: &DiffArgs) -> Result {
    if diff.right.is_some() == common.link.is_some() {
        return Err(Failure::Usage("diff takes either a second file or --link URL".to_owned()));
    }
    let left = load(output, &profile_path(common, &diff.left)?)?;
    let kind = output.commands().device(left.kind())?;
    let (right, name) = match &diff.right {
        Some(argument) => {
            let path = profile_path(common, argument)?;
            (load(output, &path)?, path)
        }
        None => (kind.read_for_comparison(common, output, None)?, PathBuf::from("the device")),
    };
    let comparison = left
        .compare(&right)
        .map_err(|error| to_failure(&explain::profile_file_error_text(&name, &error, KindRegistry::NONE)))?;
    let missing = comparison.one_sided_items();
    show_comparison(output, &comparison, comparison.differences().is_empty() && missing.is_empty())
}

pub(super) fn verify_profile(common: &CommonArgs, output: &Output, file: &Path) -> Result {
    let profile = load(output, file)?;
    let kind = output.commands().device(profile.kind())?;
    let device = kind.read_for_comparison(common, output, Some(&profile))?;
    // Two different devices may be compared, but this is reported.
    if let Some(words) = kind.device_mismatch(&profile, &device) {
        output.print_message(&words);
    }
    let comparison = profile
        .compare(&device)
        .map_err(|error| to_failure(&explain::profile_file_error_text(file, &error, KindRegistry::NONE)))?;
    // Items that only the device has do not count, because they are not part of the profile.
    let equal = comparison.differences().is_empty() && comparison.only_left().is_empty();
    show_comparison(output, &comparison, equal)
}

pub(super) fn restore(common: &CommonArgs, output: &Output, restore: &Restore) -> Result {
    let profile = load_profile_to_write(output, &restore.file)?;
    output.commands().device(profile.kind())?.restore(common, output, restore, profile)
}

/// Returns the profile to restore. Returns an error before anything is opened if consent cannot be obtained.
pub fn profile_to_restore<P: Profile>(restore: &Restore, profile: Body) -> Result<P> {
    if !restore.dry_run {
        require_consent(&restore.consent)?;
    }
    profile
        .into_profile()
        .map_err(|error| to_failure(&explain::profile_file_error_text(&restore.file, &error, KindRegistry::NONE)))
}

pub(crate) fn print_missing(output: &Output, items: &[impl Display]) {
    for item in items {
        output.print_message(&format!("{item} is not restored: the encoder does not have it"));
    }
}

/// Reports the mounting-dependent values of another device, which are not restored.
pub(crate) fn print_skipped_mounting(output: &Output, items: &[impl Display]) {
    for item in items {
        output.print_message(&format!(
            "{item} belongs to the mounting of another encoder and is not restored; use --with-mounting to restore it"
        ));
    }
}

/// Writes the plan that restores a profile, or only prints it in a dry run. An undo is rejected if values have changed
/// since the write that it undoes.
pub fn write_restore<P: PlannedWrite>(
    common: &CommonArgs,
    output: &Output,
    restore: &Restore,
    prepared: P,
    plan: &PlanReport,
    left: &UnrestoredItems,
    write: impl FnOnce(P) -> Result<WriteSummary>,
) -> Result {
    restore.check_undo(common, &prepared)?;
    left.print_warning(output);
    if restore.dry_run {
        print_undo(output, &prepared);
        show_dry_run(output, restore, plan, (left, undo_json(&prepared)))
    } else {
        print_restore_result(output, restore, plan, &write(prepared)?, left)
    }
}

/// Returns the restore options for devices without data fields.
pub fn restore_options(restore: &Restore) -> Result<RestoreOptions> {
    if !restore.copy.is_empty() || !restore.leave.is_empty() {
        return Err(Failure::Usage(
            "--copy and --leave are for data fields, which this device does not have".to_owned(),
        ));
    }
    Ok(RestoreOptions {
        allow_other_device: restore.allow_other_device,
        allow_other_type: restore.allow_other_type,
        with_mounting: restore.with_mounting,
    })
}

fn show_comparison(output: &Output, comparison: &Comparison, equal: bool) -> Result {
    let differences = comparison.differences();
    let json_differences: Vec<Json> = differences
        .iter()
        .map(|difference| json!({"item": difference.item, "left": difference.left, "right": difference.right}))
        .collect();
    let missing = comparison.one_sided_items();
    let json = json!({
        "equal": equal,
        "differences": json_differences,
        "compared": comparison.compared,
        "missing": missing,
    });
    let mut lines = Lines::default();
    for difference in &differences {
        lines.add_line(&difference.item, format!("{}  →  {}", difference.left, difference.right));
    }
    for item in &comparison.only_left() {
        lines.add_line(item, "only on the left");
    }
    for item in &comparison.only_right() {
        lines.add_line(item, "only on the right");
    }
    let compared = comparison.compared;
    let verdict =
        if equal { format!("equal ({compared} compared)\n") } else { format!("different ({compared} compared)\n") };
    output.show(&json, &(lines.text() + &verdict))?;
    Ok(if equal { Success::Completed } else { Success::ValueDifference })
}

/// Items that a restore leaves unchanged.
pub struct UnrestoredItems {
    /// Number of items that already have the value in the profile.
    pub unchanged: u64,
    /// Items that are present only in the profile or only in the device.
    pub missing: Vec<String>,
    /// Values from another device that must be set up again.
    pub redo: Vec<String>,
}

impl UnrestoredItems {
    fn print_warning(&self, output: &Output) {
        let items = self.redo.iter().map(explain::literal_text).collect();
        if let Some(text) = review::redo(items) {
            output.print_message(&text.terminal_text());
        }
    }
}

fn show_dry_run(
    output: &Output,
    restore: &Restore,
    plan: &PlanReport,
    (left, undo): (&UnrestoredItems, Json),
) -> Result {
    let mut json = json!({
        "dry_run": true,
        "operations": plan.operations,
        "written": 0,
        "unchanged": left.unchanged,
        "verified": 0,
        "write_cycles": plan.write_cycles,
        "backup": null,
        "missing": left.missing,
        "redo": left.redo,
        "undo": undo,
    });
    if let Some(undone) = &restore.undone {
        undone.add_keys(&mut json, &plan.operations);
    }
    output.show(&json, &plan.text)?;
    Ok(Success::Completed)
}

fn print_restore_result(
    output: &Output,
    restore: &Restore,
    plan: &PlanReport,
    spent: &WriteSummary,
    left: &UnrestoredItems,
) -> Result {
    let mut json = json!({
        "written": spent.written,
        "unchanged": left.unchanged,
        "verified": spent.verified,
        "write_cycles": spent.write_cycles,
        "backup": spent.backup,
        "missing": left.missing,
        "redo": left.redo,
    });
    if let Some(undone) = &restore.undone {
        undone.add_keys(&mut json, &plan.operations);
    }
    let mut lines = Lines::default();
    lines
        .add_line("written", spent.written)
        .add_line("unchanged", left.unchanged)
        .add_line("verified", spent.verified)
        .add_line("write cycles", spent.write_cycles);
    if let Some(backup) = &spent.backup {
        lines.add_line("backup", backup.display());
    }
    output.show_write_result(&json, &lines.text())?;
    // They are also printed before the write, because they list the remaining work.
    left.print_warning(output);
    Ok(Success::Completed)
}

/// Prints the result of writing an item. `operations` are the executed operations, and `changes` contains the old and
/// new values.
pub(crate) fn show_changes(
    output: &Output,
    item: &str,
    operations: &[Json],
    changes: &str,
    spent: &WriteSummary,
) -> Result {
    print_write_result(output, item, operations, spent, &[], changes)
}

pub(crate) fn print_write_result(
    output: &Output,
    item: &str,
    operations: &[Json],
    spent: &WriteSummary,
    results: &[Json],
    changes: &str,
) -> Result {
    let mut json = json!({
        "item": item,
        "operations": operations,
        "written": spent.written,
        "verified": spent.verified,
        "write_cycles": spent.write_cycles,
        "backup": spent.backup,
    });
    if let (false, Some(object)) = (results.is_empty(), json.as_object_mut()) {
        object.insert("results".to_owned(), json!(results));
    }
    let text = match &spent.backup {
        None => NOTHING_TO_WRITE.to_owned(),
        Some(backup) => {
            let mut lines = Lines::default();
            lines.add_line("written", spent.written).add_line("verified", spent.verified);
            lines.add_line("write cycles", spent.write_cycles).add_line("backup", backup.display());
            format!("{changes}{}", lines.text())
        }
    };
    output.show_write_result(&json, &text)?;
    Ok(Success::Completed)
}
