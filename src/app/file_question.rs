//! Questions that ask the user for a file.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::action::RecorderOwner;
use super::comparison::Side;
use super::payload::Payload;
use super::report::ReportFormat;
use super::studio::SessionId;
use super::{DeviceAction, Language, Picture, Text};

/// A request for a file, which the user answers in a system dialog or by typing a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileQuestion {
    Open,
    Restore(SessionId),
    Compare(Side),
    OpenCapture,
    /// The company logo for reports.
    Logo,
    Recording,
    Save {
        session: SessionId,
        suggested: PathBuf,
    },
    OfDevice(DeviceFile),
    Table {
        owner: RecorderOwner,
        visible: bool,
        suggested: PathBuf,
    },
    Picture {
        picture: Picture,
        suggested: PathBuf,
    },
    Trace {
        session: SessionId,
        suggested: PathBuf,
    },
    Report {
        owner: RecorderOwner,
        suggested: PathBuf,
    },
}

/// A file that a kind of device reads or writes, and the action to execute once it has been chosen.
#[derive(Clone)]
pub struct DeviceFile {
    session: SessionId,
    title: Text,
    kind: Text,
    endings: &'static [&'static str],
    suggested: Option<PathBuf>,
    then: Arc<dyn Fn(PathBuf, Language) -> Payload + Send + Sync>,
}

impl DeviceFile {
    /// Creates a request for a file to read. `title` is the title of the dialog, and `kind` is the name of the file
    /// type, followed by its extensions.
    pub fn to_read<A: DeviceAction>(
        session: SessionId,
        (title, kind): (Text, Text),
        endings: &'static [&'static str],
        then: impl Fn(PathBuf) -> A + Send + Sync + 'static,
    ) -> Self {
        let then = move |path, _| Payload::new(then(path));
        DeviceFile { session, title, kind, endings, suggested: None, then: Arc::new(then) }
    }

    /// Creates a request for a file to write, with a suggested name. The content may depend on the language of the
    /// window.
    pub fn write_question<A: DeviceAction>(
        session: SessionId,
        (title, kind): (Text, Text),
        endings: &'static [&'static str],
        suggested: PathBuf,
        then: impl Fn(PathBuf, Language) -> A + Send + Sync + 'static,
    ) -> Self {
        let then = move |path, language| Payload::new(then(path, language));
        DeviceFile { session, title, kind, endings, suggested: Some(suggested), then: Arc::new(then) }
    }

    pub(super) fn session(&self) -> SessionId {
        self.session
    }

    pub fn title(&self) -> &Text {
        &self.title
    }

    pub fn kind(&self) -> &Text {
        &self.kind
    }

    /// Returns the action to execute once a file has been chosen.
    pub(super) fn action_for_path(&self, path: PathBuf, language: Language) -> Payload {
        (self.then)(path, language)
    }
}

impl PartialEq for DeviceFile {
    fn eq(&self, other: &Self) -> bool {
        let facts = |own: &Self| (own.session, own.endings, own.title.clone(), own.kind.clone(), own.suggested.clone());
        facts(self) == facts(other) && Arc::ptr_eq(&self.then, &other.then)
    }
}

impl Eq for DeviceFile {}

impl fmt::Debug for DeviceFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DeviceFile").field("title", &self.title).field("suggested", &self.suggested).finish()
    }
}

impl FileQuestion {
    pub fn file_extensions(&self) -> &'static [&'static str] {
        match self {
            FileQuestion::Open | FileQuestion::Restore(_) | FileQuestion::Compare(_) | FileQuestion::Save { .. } => {
                &["ron"]
            }
            FileQuestion::OpenCapture => &["csv", "txt", "tsv", "dat"],
            FileQuestion::Recording | FileQuestion::Trace { .. } => &["trace", "txt"],
            FileQuestion::Table { .. } => &["csv"],
            FileQuestion::Picture { .. } | FileQuestion::Logo => &["png"],
            FileQuestion::Report { .. } => ReportFormat::EXTENSIONS,
            FileQuestion::OfDevice(file) => file.endings,
        }
    }

    pub fn suggested_path(&self) -> Option<&Path> {
        match self {
            FileQuestion::Open
            | FileQuestion::Restore(_)
            | FileQuestion::Compare(_)
            | FileQuestion::OpenCapture
            | FileQuestion::Logo
            | FileQuestion::Recording => None,
            FileQuestion::Save { suggested, .. }
            | FileQuestion::Table { suggested, .. }
            | FileQuestion::Picture { suggested, .. }
            | FileQuestion::Trace { suggested, .. }
            | FileQuestion::Report { suggested, .. } => Some(suggested),
            FileQuestion::OfDevice(file) => file.suggested.as_deref(),
        }
    }
}
