//! Keeping the settings: written on a thread when they have changed, one write at a time.

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
    busy: bool,
    told: bool,
}

impl Keeper {
    /// Reads the settings. A file that cannot be understood is told and left until something changes.
    pub(super) fn load(services: &mut Services) -> (Settings, Self) {
        let path = services.world.store.settings_path();
        let (sender, read) = bounded(1);
        // A disk that does not answer must not hold up the start; without a thread there is no answer either.
        let _ = thread::Builder::new().name("settings".to_owned()).spawn(move || sender.send(read_text(&path)));
        let Ok(read) = read.recv_timeout(PATIENCE) else {
            services.tell(Severity::Warning, vec![Text::new("session.settings_broken")], None);
            return (Settings::default(), Keeper { kept: Settings::default(), busy: false, told: false });
        };
        let settings = match read {
            Ok(text) => Settings::parse(&text).unwrap_or_else(|| {
                services.tell(Severity::Warning, vec![Text::new("session.settings_broken")], None);
                Settings::default()
            }),
            Err(FileError { problem: FileProblem::NotFound, .. }) => Settings::default(),
            Err(error) => {
                services.tell(Severity::Warning, vec![explain::file(&error)], None);
                Settings::default()
            }
        };
        (settings.clone(), Keeper { kept: settings, busy: false, told: false })
    }

    pub(super) fn keep(&mut self, settings: &Settings, services: &Services) {
        if self.busy || *settings == self.kept {
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
