//! Drafts of layout changes that survive a crash. They are stored entry by entry, so that changes by others to the file
//! are preserved.

use super::design::Edit;
use super::encoder::Encoder;
use crate::app::session::{HasDraft, HasSession, ProfileFile, Session, Source};
use crate::app::{DeviceModel, PendingEdits};
use crate::devices::ssi::jobs::Ssi;
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::state::TEXTS;
use crate::profile::{Body, Change, Profile, ProfileDocument};
use crate::store::DeviceKey;

/// Changes to the layout, one for each changed entry. Earlier versions stored the complete profile as text.
pub(crate) type Drafts = Vec<String>;

impl HasSession for Encoder {
    type Device = Ssi;

    fn session(&self) -> &Session<Ssi> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Ssi> {
        &mut self.session
    }
}

impl HasDraft for Encoder {
    /// Returns `None`, because an SSI encoder does not report its identity.
    fn device_key(&self) -> Option<DeviceKey> {
        None
    }

    /// Returns `None` for a layout that does not belong to a link.
    ///
    /// SSI encoders do not report their identity, so a layout belongs to the link over which it was used. The link
    /// describes a virtual encoder completely.
    fn type_and_serial(&self) -> Option<(String, String)> {
        let Source::Link(url) = &self.session.source else { return None };
        let wire = if self.session.is_virtual() {
            self.session.data_source()
        } else {
            format!("{}:{}", url.scheme.keyword(), url.target)
        };
        Some(("link".to_owned(), wire))
    }

    fn current_edits(&self) -> Drafts {
        let changes = new_document(self.designer.saved()).changes_to(&new_document(&self.edited_profile()));
        changes.iter().filter_map(|change| ron::to_string(change).ok()).collect()
    }

    fn take_edits(&mut self, edits: Drafts) {
        let mut profiles = edits
            .iter()
            .filter_map(|text| ProfileDocument::parse(text, SsiProfile::FORMATS).ok()?.body.into_profile().ok());
        let whole = profiles.next_back().or_else(|| {
            let changes: Vec<Change> = edits.iter().filter_map(|text| ron::from_str(text).ok()).collect();
            let all = changes.len() == edits.len();
            let changed =
                new_document(self.designer.saved()).with_changes(&changes, SsiProfile::FORMATS).ok().filter(|_| all)?;
            changed.body.into_profile().ok()
        });
        match whole {
            Some(profile) => self.apply_edit(Edit::Whole(Box::new(profile))),
            None if edits.is_empty() => {}
            // With the current file, the edits do not result in a valid frame.
            None => self.designer.show_rejection(TEXTS.text("ssi.draft_unfit")),
        }
    }

    fn pending_edits(&self) -> &dyn PendingEdits {
        &self.designer
    }

    fn pending_mut(&mut self) -> &mut dyn PendingEdits {
        &mut self.designer
    }

    fn revert_edits(&mut self) {
        DeviceModel::apply_edit_step(self, |edits| edits.discard_all());
    }

    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument) {
        let Some(profile) = document.body.get::<SsiProfile>() else { return };
        let before = self.designer.layout().clone();
        // Undo steps are kept if the file has not changed. Otherwise, only the edits are kept.
        if self.designer.design().profile == *profile {
            self.designer.mark_saved(profile.clone());
        } else {
            let edits = self.current_edits();
            self.designer.open(profile.clone());
            self.take_edits(edits);
        }
        self.handle_layout_change(&before);
        self.session.apply_document(file, document);
    }

    fn handle_profile_saved(&mut self, document: ProfileDocument) {
        if let Ok(profile) = document.body.into_profile() {
            self.designer.mark_saved(profile);
        }
    }
}

/// Creates a document for a layout that is not stored in a file.
fn new_document(profile: &SsiProfile) -> ProfileDocument {
    ProfileDocument { saved: None, ..ProfileDocument::new(String::new(), Body::new(profile.clone())) }
}
