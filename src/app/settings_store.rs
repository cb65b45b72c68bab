//! Storage of the settings. Changes are written on a thread, one write at a time.
//!
//! Other windows write to the same file. Under a lock, a write merges the present content of the file with the changes
//! that this window has made since the last read or write. Changes made by other windows are adopted only if they lock
//! drives or concern devices that are not open here.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use crossbeam_channel::bounded;
use jiff::Zoned;

use super::action::{Action, TaskResult};
use super::kinds::KindRegistry;
use super::logbook_server::server_address;
use super::services::Services;
use super::{Settings, Severity, Text, explain};
use crate::profile::find_location;
use crate::store::{FileError, FileErrorKind, ServerAddress, ServerAddressError, read_text, update_text};

/// Maximum time to wait for the settings when the program starts.
const START_TIMEOUT: Duration = Duration::from_millis(300);

const SETTINGS_NOT_SAVED_ID: &str = "session.settings_not_kept";

/// Minimum time between a failed read of the settings and the next attempt.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub(crate) struct SettingsStore {
    /// Settings of this window when the file was last read or written.
    known: Settings,
    failed: Option<Settings>,
    writing: Option<Settings>,
    /// Whether the file may be overwritten, because it has been read or, if invalid, copied.
    may_write: bool,
    is_failure_reported: bool,
    reading_since: Option<Zoned>,
    last_read: Option<Zoned>,
    last_failed_read: Option<Zoned>,
}

#[derive(Debug)]
pub enum LoadedSettings {
    /// The file was valid and complete.
    Whole(Box<Settings>),
    Missing,
    /// The file is invalid. Contains its readable part and the copy that was made.
    Broken {
        settings: Box<Settings>,
        path: PathBuf,
        /// Path of the copy, or the reason why there is no copy.
        aside: Result<PathBuf, String>,
    },
    /// The file cannot be read at all.
    Unreadable(FileError),
}

/// Settings as read by a command. The file is never changed.
#[derive(Debug)]
pub struct CommandSettings {
    /// The readable settings. If the setting for the user name cannot be read, no name is used.
    pub settings: Settings,
    /// The logbook server. If its address cannot be read, the server counts as unreachable.
    pub server: Option<Result<ServerAddress, ServerAddressError>>,
    /// Reason why the file could not be read completely.
    pub problem: Option<Text>,
}

#[derive(Debug)]
pub struct SavedSettings {
    settings: Box<Settings>,
    /// Paths of an invalid file and of its copy.
    aside: Option<(PathBuf, PathBuf)>,
}

impl SettingsStore {
    /// Reads the settings. If the disk does not respond in time, the result arrives later as an action.
    pub(super) fn load(services: &mut Services) -> (Settings, Self) {
        let (path, kinds) = (services.world.store.settings_path(), services.world.kinds);
        let mailbox = services.tasks.mailbox();
        // The channel has no buffer. If nothing receives from it, the settings go to the mailbox.
        let (sender, receiver) = bounded(0);
        let _ = thread::Builder::new().name("settings".to_owned()).spawn(move || {
            if let Err(late) = sender.send(read(path, kinds)) {
                mailbox.send(Action::Done(TaskResult::SettingsRead(late.into_inner())));
            }
        });
        let mut settings = Settings::initial(kinds);
        let mut store = SettingsStore {
            known: settings.clone(),
            failed: None,
            writing: None,
            may_write: false,
            is_failure_reported: false,
            reading_since: None,
            last_read: None,
            last_failed_read: None,
        };
        match receiver.recv_timeout(START_TIMEOUT) {
            Ok(read) => store.adopt(read, &mut settings, services),
            Err(_) => {
                drop(receiver);
                apply_to_logbook(&Settings::unread(kinds), services);
                services.notify(Severity::Warning, vec![Text::new("session.settings_slow")], None);
            }
        }
        (settings, store)
    }

    /// Adopts settings that were read. Changes made by the user in the meantime are kept.
    pub(super) fn adopt(&mut self, read: LoadedSettings, settings: &mut Settings, services: &mut Services) {
        services.log.remove_from_window("session.settings_slow", None);
        let kinds = services.world.kinds;
        let found = match read {
            LoadedSettings::Whole(found) => {
                self.may_write = true;
                *found
            }
            LoadedSettings::Missing => {
                self.may_write = true;
                Settings::initial(kinds)
            }
            LoadedSettings::Broken { settings, path, aside } => {
                let text = match &aside {
                    Ok(aside) => Text::new("session.settings_broken").with("aside", aside.display()),
                    Err(why) => Text::new("session.settings_left").with("why", why),
                };
                services.notify(Severity::Warning, vec![text.with("path", path.display())], None);
                self.may_write = aside.is_ok();
                *settings
            }
            LoadedSettings::Unreadable(error) => {
                let text = Text::new("session.settings_unread").with_text("why", explain::file_error_text(&error));
                services.notify(Severity::Warning, vec![text], None);
                apply_to_logbook(&Settings::unread(kinds), services);
                return;
            }
        };
        *settings = found.clone().with_changes(&Settings::initial(kinds), settings);
        apply_to_logbook(settings, services);
        self.known = found;
    }

    pub(super) fn write_if_changed(&mut self, settings: &Settings, services: &Services) {
        let is_written = *settings == self.known || self.failed.as_ref() == Some(settings);
        if self.writing.is_some() || !self.may_write || is_written {
            return;
        }
        self.writing = Some(settings.clone());
        let (path, kinds) = (services.world.store.settings_path(), services.world.kinds);
        let (known, ours) = (self.known.clone(), settings.clone());
        services
            .tasks
            .run("settings", move || Action::Done(TaskResult::SettingsKept(write(&path, &known, &ours, kinds))));
    }

    /// Handles the result of a write. Only the first of several failures is reported.
    pub(super) fn finish_write(
        &mut self,
        result: Result<SavedSettings, FileError>,
        settings: &mut Settings,
        services: &mut Services,
    ) {
        let Some(written) = self.writing.take() else { return };
        match result {
            Ok(SavedSettings { settings: found, aside }) => {
                self.known = written;
                self.merge_drive_data(&found, settings);
                self.failed = None;
                if let Some((path, aside)) = aside {
                    let text = Text::new("session.settings_broken").with("aside", aside.display());
                    services.notify(Severity::Warning, vec![text.with("path", path.display())], None);
                }
                if std::mem::take(&mut self.is_failure_reported) {
                    services.log.remove_from_window(SETTINGS_NOT_SAVED_ID, None);
                }
            }
            Err(error) => {
                // If another program is using the file, the write is repeated later.
                self.failed = (error.problem != FileErrorKind::InUse).then_some(written);
                if !std::mem::replace(&mut self.is_failure_reported, true) {
                    let text = Text::new(SETTINGS_NOT_SAVED_ID).with_text("why", explain::file_error_text(&error));
                    services.notify(Severity::Warning, vec![text], None);
                }
            }
        }
    }

    /// Starts rereading the settings, because another window may have changed them. Returns whether a read has started.
    pub(crate) fn begin_read(&mut self, services: &Services) -> bool {
        let has_failed = |at: &Zoned| at.duration_until(&services.current_time()).unsigned_abs() < RETRY_INTERVAL;
        if self.reading_since.is_some() || self.last_failed_read.as_ref().is_some_and(has_failed) {
            return false;
        }
        self.reading_since = Some(services.current_time());
        let (path, kinds) = (services.world.store.settings_path(), services.world.kinds);
        services.tasks.run("settings", move || {
            let found = read_settings(&path, kinds).map(|found| found.map(Box::new));
            Action::Done(TaskResult::SettingsReread(found))
        });
        true
    }

    /// Handles a failed read. The settings count as unread, because they may contain locks.
    pub(crate) fn handle_read_failure(&mut self) {
        self.last_failed_read = self.reading_since.take();
    }

    /// Merges settings that were read. During a write they are returned instead, because the result of the write is
    /// merged later.
    pub(crate) fn merge_read_settings(&mut self, found: Option<Settings>, settings: &mut Settings) -> Option<Settings> {
        self.last_read = self.reading_since.take();
        if self.writing.is_some() {
            return found;
        }
        if let Some(found) = found {
            self.merge_drive_data(&found, settings);
        }
        None
    }

    /// Returns whether the settings were last read longer ago than `than`.
    pub(crate) fn is_last_read_older(&self, now: &Zoned, than: Duration) -> bool {
        // The clock of the system may be set back, so the difference has no sign.
        let age = self.last_read.as_ref().map(|looked| looked.duration_until(now).unsigned_abs());
        age.is_none_or(|age| age > than)
    }

    /// Adopts data about drives from other windows.
    fn merge_drive_data(&mut self, found: &Settings, settings: &mut Settings) {
        let ours = settings.clone();
        settings.adopt_drive_data(found);
        settings.apply_drive_changes(&self.known, &ours);
        self.known.adopt_drive_data(found);
    }

    pub(super) fn is_idle(&self) -> bool {
        self.writing.is_none()
    }
}

impl CommandSettings {
    /// Reads the settings for a command.
    pub fn read(path: &Path) -> Self {
        match read_text(path) {
            Ok(text) => Self::parse(path, &text),
            Err(FileError { problem: FileErrorKind::NotFound | FileErrorKind::NoFolder, .. }) => {
                let settings = Settings::default();
                CommandSettings { server: server_address(&settings), settings, problem: None }
            }
            Err(error) => {
                let settings = Settings::parse_partial("");
                let problem = Text::new("settings.unread").with_text("why", explain::file_error_text(&error));
                CommandSettings { server: server_address(&settings), settings, problem: Some(problem) }
            }
        }
    }

    fn parse(path: &Path, text: &str) -> Self {
        let error = match Settings::parse(text) {
            Ok(settings) => {
                let problem = Settings::unknown_name(text).map(|name| {
                    let (line, column) = find_location(text, &name).unwrap_or((1, 1));
                    let why =
                        explain::syntax_error_text(line, column, Text::new("settings.unknown").with("name", name));
                    Text::new("settings.broken").with("path", path.display()).with_text("why", why)
                });
                return CommandSettings { server: server_address(&settings), settings, problem };
            }
            Err(error) => error,
        };
        let settings = Settings::parse_partial(text);
        let place = error.span.start;
        let why = explain::syntax_error_text(place.line, place.col, explain::literal_text(&error.code));
        let problem = Text::new("settings.broken").with("path", path.display()).with_text("why", why);
        CommandSettings { server: server_address(&settings), settings, problem: Some(problem) }
    }
}

/// Applies the settings that concern new entries of the logbook.
fn apply_to_logbook(settings: &Settings, services: &Services) {
    settings.user_name.apply();
    services.world.store.logbook_server().set_address(server_address(settings));
}

/// Reads the settings. An invalid file is copied to another name in the same folder.
fn read(path: PathBuf, kinds: KindRegistry) -> LoadedSettings {
    match parse_settings(read_text(&path), kinds) {
        Ok(Some((settings, true))) => LoadedSettings::Whole(Box::new(settings)),
        Ok(Some((settings, false))) => {
            let aside = broken_settings_path(&path);
            let copied = fs::copy(&path, &aside);
            let aside = copied.map(|_| aside).map_err(|error| error.to_string());
            LoadedSettings::Broken { settings: Box::new(settings), path, aside }
        }
        Ok(None) => LoadedSettings::Missing,
        Err(error) => LoadedSettings::Unreadable(error),
    }
}

/// Parses as many settings as possible, and returns whether they are complete. Returns `None` if there is no file.
fn parse_settings(text: Result<String, FileError>, kinds: KindRegistry) -> Result<Option<(Settings, bool)>, FileError> {
    match text {
        Ok(text) => {
            let (mut settings, is_whole) = match Settings::parse(&text) {
                Ok(settings) => (settings, true),
                Err(_) => (Settings::parse_partial(&text), false),
            };
            settings.replace_unknown_tab(kinds);
            Ok(Some((settings, is_whole)))
        }
        Err(FileError { problem: FileErrorKind::NotFound, .. }) => Ok(None),
        Err(FileError { problem: FileErrorKind::NotUtf8 { .. } | FileErrorKind::TooLarge { .. }, .. }) => {
            Ok(Some((Settings::unread(kinds), false)))
        }
        Err(error) => Err(error),
    }
}

/// Reads the settings. Returns `None` if there is no file that a window could have written.
fn read_settings(path: &Path, kinds: KindRegistry) -> Result<Option<Settings>, FileError> {
    use FileErrorKind::{IsFolder, NoFolder, NotAFile, NotFolder};
    match parse_settings(read_text(path), kinds) {
        Err(FileError { problem: NoFolder | NotFolder | IsFolder | NotAFile, .. }) => Ok(None),
        read => Ok(read?.map(|(settings, _)| settings)),
    }
}

fn broken_settings_path(path: &Path) -> PathBuf {
    let mut aside = path.to_owned().into_os_string();
    aside.push(".broken");
    PathBuf::from(aside)
}

/// Applies the changes from `known` to `ours` to the current file.
fn write(path: &Path, known: &Settings, ours: &Settings, kinds: KindRegistry) -> Result<SavedSettings, FileError> {
    update_text(path, |text| {
        let (there, is_whole) = match parse_settings(text, kinds)? {
            Some((found, is_whole)) => (Some(found), is_whole),
            None => (None, true),
        };
        let aside = if is_whole { None } else { back_up_broken_settings(path)? };
        // A deleted file has no changes of others.
        let merged = there.clone().map_or_else(|| ours.clone(), |there| there.with_changes(known, ours));
        let text = (there.as_ref() != Some(&merged) || !is_whole).then(|| merged.emit());
        Ok((text, SavedSettings { settings: Box::new(merged), aside }))
    })
}

/// Copies an invalid file unless an identical copy exists. Returns the paths of the file and the copy.
fn back_up_broken_settings(path: &Path) -> Result<Option<(PathBuf, PathBuf)>, FileError> {
    let aside = broken_settings_path(path);
    let is_there = fs::read(path).is_ok_and(|broken| fs::read(&aside).is_ok_and(|before| before == broken));
    if is_there {
        return Ok(None);
    }
    let failed = |error: std::io::Error| FileError {
        path: aside.clone(),
        task: crate::store::FileOperation::Write,
        problem: error.into(),
    };
    fs::copy(path, &aside).map_err(failed)?;
    Ok(Some((path.to_owned(), aside)))
}
