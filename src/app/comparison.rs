//! Comparison of a device or an open profile with a profile on disk. The last reading is used; the device is not
//! accessed.

use std::path::{Path, PathBuf};

use super::action::{Action, ReadError, TaskResult};
use super::documents::{read_error, read_profile};
use super::studio::{SessionId, Studio};
use super::{Severity, Text};
use crate::profile::{Comparison, ProfileDocument};

#[derive(Debug)]
pub struct ProfileComparison {
    session: SessionId,
    path: PathBuf,
    comparison: Comparison,
}

impl ProfileComparison {
    /// Returns the session on the left side of the comparison.
    pub fn session(&self) -> SessionId {
        self.session
    }

    /// Returns the path of the profile on the right side of the comparison.
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn comparison(&self) -> &Comparison {
        &self.comparison
    }
}

impl Studio {
    pub fn comparison(&self) -> Option<&ProfileComparison> {
        self.comparison.as_ref().filter(|shown| self.device(shown.session).is_some())
    }

    pub(super) fn close_comparison(&mut self) -> bool {
        self.comparison.take().is_some()
    }

    /// Starts a task that reads a profile to compare it with a session.
    pub(super) fn compare_with(&mut self, session: SessionId, path: PathBuf) {
        let formats = self.services.world.kinds.formats;
        self.services.tasks.run("compare", move || {
            let result = read_profile(&path, formats).map(Box::new);
            Action::Done(TaskResult::Compare { session, path, result })
        });
    }

    pub(super) fn compare(
        &mut self,
        session: SessionId,
        path: PathBuf,
        result: Result<Box<ProfileDocument>, ReadError>,
    ) {
        let Some(device) = self.device(session) else { return };
        let (tab, name) = (device.tab(), device.name());
        let compared = match device.comparable_body() {
            None => Err(vec![Text::new("comparison.nothing_read")]),
            Some(Err(missing)) => Err(vec![Text::new("comparison.not_all_read").with_list("missing", missing)]),
            Some(Ok(body)) => {
                let compared = result.and_then(|document| body.compare(&document.body).map_err(ReadError::Profile));
                compared.map_err(|error| vec![read_error(&path, &error, self.services.world.kinds)])
            }
        };
        match compared {
            Ok(comparison) => {
                self.show(tab, session);
                self.comparison = Some(ProfileComparison { session, path, comparison });
            }
            Err(why) => self.services.notify(Severity::Error, why, Some(&name)),
        }
    }
}
