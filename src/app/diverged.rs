//! Resolution of a conflict between an edited profile and its file, which another program has changed. The two versions
//! are compared entry by entry.

use super::KindRegistry;
use super::action::ReadError;
use super::documents::read_error;
use super::question::{FollowUpAction, Question};
use super::session::{DivergedFile, FileSnapshot, ProfileFile, SaveRequest, Source};
use super::studio::{SessionId, Studio};
use super::{DeviceCommand, Text};
use crate::profile::{Change, ChangedSide, ProfileDocument, ProfileError, diverging_changes};

/// A profile that differs between the window and its file.
#[derive(Debug)]
pub struct ProfileConflict {
    saving: SaveRequest,
    theirs: Result<Box<ProfileDocument>, ReadError>,
    text: String,
    rows: Vec<Row>,
    /// The reason why the last choice could not be carried out.
    problem: Option<Text>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    change: Change,
    pub changed: ChangedSide,
    /// Version chosen for the entry, if any.
    pub take: Option<Side>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Theirs,
    Mine,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConflictResolution {
    Reload,
    KeepMine,
    Take(usize, Side),
    /// Writes the chosen version of each entry.
    Merge,
    /// Closes the dialog without writing anything. The edits are kept.
    Close,
}

impl Row {
    /// Returns the location of the entry in the profile.
    pub fn location(&self) -> String {
        self.change.location()
    }

    /// Returns the value in one of the versions, or `None` if that version does not contain the entry.
    pub fn value(&self, side: Side) -> Option<&str> {
        match side {
            Side::Theirs => self.change.from.as_deref(),
            Side::Mine => self.change.to.as_deref(),
        }
    }
}

impl ProfileConflict {
    /// Compares a file with the profile that is to be written to it.
    pub(super) fn new(saving: SaveRequest, DivergedFile { text, document }: DivergedFile, kinds: KindRegistry) -> Self {
        let formats = kinds.formats;
        let kind = saving.document.body.kind();
        let is_of_kind = |found: Box<ProfileDocument>| match found.body.kind() == kind {
            true => Ok(found),
            false => Err(ReadError::Profile(found.body.wrong_kind_error(kind))),
        };
        let is_known = |found: Box<ProfileDocument>| found.check_schema().map(Box::new).map_err(ReadError::Profile);
        let document = document.and_then(is_of_kind).and_then(is_known);
        let base = saving.opened.as_ref().and_then(|opened| ProfileDocument::parse(&opened.text, formats).ok());
        let rows = match (&base, &document) {
            (Some(base), Ok(theirs)) => diverging_changes(base, theirs, &saving.document),
            _ => Vec::new(),
        };
        let take = |changed| match changed {
            ChangedSide::There => Some(Side::Theirs),
            ChangedSide::Here => Some(Side::Mine),
            ChangedSide::Both => None,
        };
        let row = |(change, changed)| Row { change, changed, take: take(changed) };
        let rows = rows.into_iter().map(row).collect();
        let problem = document.as_ref().err().map(|error| read_error(&saving.path, error, kinds));
        ProfileConflict { saving, theirs: document, text, rows, problem }
    }

    pub fn session(&self) -> SessionId {
        self.saving.session
    }

    pub fn path(&self) -> &std::path::Path {
        &self.saving.path
    }

    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub fn problem_text(&self) -> Option<Text> {
        self.problem.clone()
    }

    pub fn can_reload(&self) -> bool {
        self.theirs.is_ok()
    }

    /// Returns whether the file may be overwritten. A file from a newer version of the program may not, because content
    /// unknown to this version would be lost.
    pub fn can_overwrite_file(&self) -> bool {
        !matches!(self.theirs, Err(ReadError::Profile(ProfileError::Schema { .. })))
    }

    /// Returns whether a version has been chosen for each entry.
    pub fn can_merge(&self) -> bool {
        self.theirs.is_ok() && self.rows.iter().all(|row| row.take.is_some())
    }

    fn merged_document(&self, kinds: KindRegistry) -> Result<ProfileDocument, Text> {
        let Ok(theirs) = &self.theirs else { return Err(Text::new("diverged.unfit")) };
        let mine = self.rows.iter().filter(|row| row.take == Some(Side::Mine));
        let changes: Vec<Change> = mine.map(|row| row.change.clone()).collect();
        theirs.with_changes(&changes, kinds.formats).map_err(|error| match error {
            Some(error) => read_error(&self.saving.path, &ReadError::Profile(error), kinds),
            None => Text::new("diverged.unfit"),
        })
    }

    /// Returns a save operation that overwrites the file, unless the content of the file changes again.
    fn overwrite_file(self, document: Option<ProfileDocument>) -> SaveRequest {
        let ProfileConflict { mut saving, theirs, text, .. } = self;
        // A file that is no longer a profile has no content to preserve, and the user knows this.
        saving.may_lose = theirs.is_err();
        saving.opened = saving.opened.map(|opened| FileSnapshot { text, ..opened });
        if let Some(document) = document {
            (saving.document, saving.is_merged) = (Box::new(document), true);
        }
        saving
    }
}

impl Studio {
    /// Saves to the open file, or asks for a file if none is open.
    pub(super) fn save_in_place(&mut self, id: SessionId) {
        let Some(device) = self.device(id) else { return };
        match device.source() {
            Source::File { path, .. } => {
                let path = path.clone();
                self.save(id, path);
            }
            Source::Link(_) | Source::New { .. } => {
                let ask = device.command(DeviceCommand::AskSave);
                self.handle_action(ask);
            }
        }
    }

    pub(super) fn show_conflict(&mut self, diverged: ProfileConflict) {
        self.with_device(diverged.session(), |device, _| device.pause_save_for_question());
        if let Some(tab) = self.device(diverged.session()).map(|device| device.tab()) {
            self.show(tab, diverged.session());
            self.diverged = Some(diverged);
        }
    }

    /// Asks for confirmation before comments are lost.
    pub(super) fn confirm_comment_loss(&mut self, mut saving: SaveRequest, lost: &[String]) {
        self.with_device(saving.session, |device, _| device.pause_save_for_question());
        saving.may_lose = true;
        let text =
            Text::new("question.comments").with("path", saving.path.display()).with("comments", lost.join(" · "));
        let confirm = Text::new("question.comments_go");
        self.question = Some(Question::new(text, confirm, FollowUpAction::Save(Box::new(saving))));
    }

    pub(super) fn resolve_conflict(&mut self, resolve: ConflictResolution) {
        let Some(mut diverged) = self.diverged.take() else { return };
        let saving = match resolve {
            ConflictResolution::Close => return,
            ConflictResolution::Take(at, side) => {
                if let Some(row) = diverged.rows.get_mut(at) {
                    row.take = Some(side);
                }
                diverged.problem = None;
                self.diverged = Some(diverged);
                return;
            }
            ConflictResolution::Reload => return self.reload_profile(diverged),
            ConflictResolution::KeepMine if diverged.can_overwrite_file() => diverged.overwrite_file(None),
            ConflictResolution::Merge if diverged.can_merge() => {
                match diverged.merged_document(self.services.world.kinds) {
                    Ok(document) => diverged.overwrite_file(Some(document)),
                    Err(why) => {
                        diverged.problem = Some(why);
                        self.diverged = Some(diverged);
                        return;
                    }
                }
            }
            ConflictResolution::KeepMine | ConflictResolution::Merge => {
                self.diverged = Some(diverged);
                return;
            }
        };
        let (kinds, store) = (self.services.world.kinds, self.services.world.store.clone());
        self.services.tasks.run("save", move || saving.run(kinds, &store));
    }

    fn reload_profile(&mut self, diverged: ProfileConflict) {
        let ProfileConflict { saving, theirs, text, .. } = diverged;
        let (Ok(document), Some(opened)) = (theirs, saving.opened) else { return };
        let file = ProfileFile { path: saving.path, key: opened.key, text };
        self.with_device(saving.session, |device, _| {
            device.revert_edits();
            device.apply_document(file, *document);
        });
    }
}
