//! Keeping the settings: written on a thread when they have changed, one write at a time.

use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use crossbeam_channel::bounded;

use super::action::{Action, Done};
use super::services::Services;
use super::{Settings, Severity, Text, explain};
use crate::store::{FileError, FileProblem, read_text, write_in_folder};

/// How long the start waits for the settings.
const PATIENCE: Duration = Duration::from_millis(300);

/// What is on disk, and whether a write is on its way.
#[derive(Debug)]
pub(super) struct Keeper {
    kept: Settings,
    /// The file has been read, or put aside: before that nothing is written over it.
    may_write: bool,
    busy: bool,
    told: bool,
}

/// What came of reading the settings.
#[derive(Debug)]
pub enum SettingsRead {
    /// They are as the program writes them.
    Whole(Box<Settings>),
    /// There are none yet.
    Missing,
    /// The file is broken: what could be read of it, and where it was put.
    Broken {
        /// What could be read.
        settings: Box<Settings>,
        /// The file.
        path: PathBuf,
        /// Where it is kept, or why it is not.
        aside: Result<PathBuf, String>,
    },
    /// The file cannot be read at all.
    Unreadable(FileError),
}

impl Keeper {
    /// Reads the settings. A disk that does not answer at once comes back as an action.
    pub(super) fn load(services: &mut Services) -> (Settings, Self) {
        let path = services.world.store.settings_path();
        let mailbox = services.tasks.mailbox();
        // Handed over from hand to hand: what nobody takes any more goes into the mailbox.
        let (sender, receiver) = bounded(0);
        let _ = thread::Builder::new().name("settings".to_owned()).spawn(move || {
            if let Err(late) = sender.send(read(path)) {
                mailbox.send(Action::Done(Done::SettingsRead(late.into_inner())));
            }
        });
        let mut settings = Settings::default();
        let mut keeper = Keeper { kept: settings.clone(), may_write: false, busy: false, told: false };
        match receiver.recv_timeout(PATIENCE) {
            Ok(read) => keeper.take(read, &mut settings, services),
            Err(_) => {
                drop(receiver);
                services.tell(Severity::Warning, vec![Text::new("session.settings_slow")], None);
            }
        }
        (settings, keeper)
    }

    /// Takes over what was read; what the user has set meanwhile stays.
    pub(super) fn take(&mut self, read: SettingsRead, settings: &mut Settings, services: &mut Services) {
        services.log.settle("session.settings_slow", None);
        let found = match read {
            SettingsRead::Whole(found) => {
                self.may_write = true;
                *found
            }
            SettingsRead::Missing => {
                self.may_write = true;
                Settings::default()
            }
            SettingsRead::Broken { settings, path, aside } => {
                let text = match &aside {
                    Ok(aside) => Text::new("session.settings_broken").with("aside", aside.display()),
                    Err(why) => Text::new("session.settings_left").with("why", why),
                };
                services.tell(Severity::Warning, vec![text.with("path", path.display())], None);
                self.may_write = aside.is_ok();
                *settings
            }
            SettingsRead::Unreadable(error) => {
                let text = Text::new("session.settings_unread").with_text("why", explain::file(&error));
                services.tell(Severity::Warning, vec![text], None);
                return;
            }
        };
        self.kept = found.clone();
        settings.stand_on(found);
    }

    pub(super) fn keep(&mut self, settings: &Settings, services: &Services) {
        if self.busy || !self.may_write || *settings == self.kept {
            return;
        }
        self.kept = settings.clone();
        self.busy = true;
        let (path, text) = (services.world.store.settings_path(), settings.emit());
        services.tasks.run("settings", move || {
            let result = write_in_folder(&path, text.as_bytes());
            Action::Done(Done::SettingsKept(result))
        });
    }

    /// What to tell of a write that failed; once is enough.
    pub(super) fn kept(&mut self, result: Result<(), FileError>) -> Option<Text> {
        self.busy = false;
        let error = result.err()?;
        if std::mem::replace(&mut self.told, true) {
            return None;
        }
        Some(Text::new("session.settings_not_kept").with_text("why", explain::file(&error)))
    }

    pub(super) fn is_idle(&self) -> bool {
        !self.busy
    }
}

/// Reads the settings, and puts a broken file aside: as it is, beside itself.
fn read(path: PathBuf) -> SettingsRead {
    let settings = match read_text(&path) {
        Ok(text) => match Settings::parse(&text) {
            Some(settings) => return SettingsRead::Whole(Box::new(settings)),
            None => Settings::salvage(&text),
        },
        Err(FileError { problem: FileProblem::NotFound, .. }) => return SettingsRead::Missing,
        Err(FileError { problem: FileProblem::NotUtf8 { .. } | FileProblem::TooLarge { .. }, .. }) => {
            Settings::default()
        }
        Err(error) => return SettingsRead::Unreadable(error),
    };
    let mut aside = path.clone().into_os_string();
    aside.push(".broken");
    let aside = PathBuf::from(aside);
    let copied = std::fs::copy(&path, &aside);
    let aside = copied.map(|_| aside).map_err(|error| error.to_string());
    SettingsRead::Broken { settings: Box::new(settings), path, aside }
}
