//! Asks for a file in the system's file dialog, which runs on a separate thread. If the system has no file dialog, the
//! user types the path.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use crate::app::{Action, ActionMailbox, FileQuestion, Text};
use crate::store::BaseFolders;
use crate::ui::controls::{labelled_button, modal, primary_button, right_aligned, text_entry};
use crate::ui::{Theme, icons};

pub(in crate::ui) struct FileView {
    question: FileQuestion,
    path: String,
    /// Folder that relative paths are based on.
    working: Option<PathBuf>,
    fresh: bool,
}

/// Minimum time that a user needs to close a dialog. If a dialog closes sooner without an answer, it is assumed never
/// to have opened.
const TOO_FAST: Duration = Duration::from_millis(250);

/// Asks the user for a file. The answer arrives as an action. If the system has no file dialogs, [`file_ui`] is shown
/// instead.
pub(in crate::ui) fn ask_for_file(question: FileQuestion, theme: &Theme, mailbox: ActionMailbox) {
    let filter = theme.format_text(&kind(&question));
    if !has_dialogs() {
        mailbox.send(Action::TypePath(question));
        return;
    }
    let fallback = (question.clone(), mailbox.clone());
    let spawned = thread::Builder::new().name("dialog".to_owned()).spawn(move || {
        let began = Instant::now();
        let dialog = rfd::FileDialog::new().add_filter(filter, question.file_extensions());
        // Offer all files. Loggers use many extensions for their tables, and users name traces freely.
        let any = matches!(question, FileQuestion::OpenCapture | FileQuestion::Recording);
        let dialog = if any { dialog.add_filter("*", &["*"]) } else { dialog };
        let chosen = match question.suggested_path() {
            None => dialog.pick_file(),
            Some(suggested) => {
                let dialog = match suggested.file_name() {
                    Some(name) => dialog.set_file_name(name.to_string_lossy()),
                    None => dialog,
                };
                match suggested.parent().filter(|folder| folder.is_dir()) {
                    Some(folder) => dialog.set_directory(folder),
                    None => dialog,
                }
                .save_file()
            }
        };
        mailbox.send(match chosen {
            Some(path) => Action::Chosen(question, path),
            None if began.elapsed() < TOO_FAST => Action::TypePath(question),
            None => Action::FileNotChosen,
        });
    });
    if spawned.is_err() {
        let (question, mailbox) = fallback;
        mailbox.send(Action::TypePath(question));
    }
}

/// Returns whether the system has file dialogs. On Linux, a portal on the session bus provides them.
fn has_dialogs() -> bool {
    !cfg!(target_os = "linux") || std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some()
}

fn kind(question: &FileQuestion) -> Text {
    match question {
        FileQuestion::Open | FileQuestion::Restore(_) | FileQuestion::Compare(_) | FileQuestion::Save { .. } => {
            Text::new("file.profiles")
        }
        FileQuestion::OpenCapture => Text::new("file.captures"),
        FileQuestion::Recording | FileQuestion::Trace { .. } => Text::new("file.recordings"),
        FileQuestion::OfDevice(file) => file.kind().clone(),
        FileQuestion::Table { .. } => Text::new("file.tables"),
        FileQuestion::Picture { .. } | FileQuestion::Logo => Text::new("file.pictures"),
        FileQuestion::Report { .. } => Text::new("file.page_reports"),
    }
}

fn title(question: &FileQuestion) -> Text {
    match question {
        FileQuestion::Open => Text::new("file.open_title"),
        FileQuestion::Restore(_) => Text::new("file.restore_title"),
        FileQuestion::Compare(_) => Text::new("file.compare_title"),
        FileQuestion::OpenCapture => Text::new("file.capture_title"),
        FileQuestion::Recording => Text::new("file.recording_title"),
        FileQuestion::Save { .. } => Text::new("file.save_title"),
        FileQuestion::OfDevice(file) => file.title().clone(),
        FileQuestion::Table { .. } => Text::new("file.table_title"),
        FileQuestion::Picture { .. } => Text::new("file.picture_title"),
        FileQuestion::Trace { .. } => Text::new("file.trace_title"),
        FileQuestion::Report { .. } => Text::new("file.page_report_title"),
        FileQuestion::Logo => Text::new("file.logo_title"),
    }
}

impl FileView {
    /// Creates the state for typing a path. The path starts in the user's home folder unless the question specifies
    /// another folder.
    pub(in crate::ui) fn new(question: FileQuestion, folders: &BaseFolders) -> Self {
        let home = folders.home_folder().unwrap_or(Path::new(""));
        let path = home.join(question.suggested_path().unwrap_or(Path::new("")));
        let working = folders.working_folder().map(Path::to_owned);
        FileView { question, path: path.display().to_string(), working, fresh: true }
    }
}

/// Draws the dialog in which the user types a path. Returns `true` when the dialog is closed.
pub(in crate::ui) fn file_ui(
    ctx: &egui::Context,
    theme: &Theme,
    view: &mut FileView,
    actions: &mut Vec<Action>,
) -> bool {
    let (confirm, icon) = match view.question {
        FileQuestion::Recording => ("file.choose", icons::FOLDER_OPEN),
        _ if view.question.suggested_path().is_none() => ("file.open", icons::FOLDER_OPEN),
        _ => ("file.save", icons::FLOPPY_DISK),
    };
    let mut done = false;
    modal(ctx, theme, "file", 520.0, |ui| {
        ui.label(theme.heading(theme.format_text(&title(&view.question))));
        ui.add_space(theme.space.between);
        let response = text_entry(ui, &mut view.path, ui.available_width(), &theme.translate("file.path"), "");
        if std::mem::take(&mut view.fresh) {
            response.request_focus();
            // Select only the file name. Typing then keeps the folder.
            let name = view.path.rsplit(std::path::MAIN_SEPARATOR).next().unwrap_or_default().chars().count();
            let end = view.path.chars().count();
            let range =
                egui::text::CCursorRange::two(egui::text::CCursor::new(end - name), egui::text::CCursor::new(end));
            let mut state = egui::TextEdit::load_state(ui.ctx(), response.id).unwrap_or_default();
            state.cursor.set_char_range(Some(range));
            egui::TextEdit::store_state(ui.ctx(), response.id, state);
        }
        let enter = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        ui.label(theme.caption(theme.translate("file.hint")));
        if let Some(working) = &view.working {
            let rule = Text::new("file.rule").with("folder", working.display());
            ui.label(theme.caption(theme.format_text(&rule)));
        }
        theme.add_gap(ui);
        right_aligned(ui, |ui| {
            let named = !view.path.trim().is_empty();
            if primary_button(ui, theme, named, icon, &theme.translate(confirm)).clicked() || (enter && named) {
                actions.push(Action::Typed(view.question.clone(), PathBuf::from(view.path.trim())));
                done = true;
            }
            if labelled_button(ui, "", &theme.translate("file.cancel")).clicked() {
                done = true;
            }
        });
    });
    done
}
