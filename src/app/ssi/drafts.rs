//! Changes of a layout, kept over a crash: the whole of it as a profile.

use std::path::PathBuf;

use super::design::Edit;
use super::encoder::Encoder;
use crate::app::session::{Drafted, OnDesk, Session, Source};
use crate::profile::{Body, Document};
use crate::worker::ssi::Ssi;

/// The layout as a profile's text; none where it is as it was saved.
pub(in crate::app) type Drafts = Vec<String>;

impl OnDesk for Encoder {
    type Device = Ssi;

    fn session(&self) -> &Session<Ssi> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Ssi> {
        &mut self.session
    }
}

impl Drafted for Encoder {
    /// SSI encoders do not say who they are: a layout belongs to the wire at which it was used; a virtual encoder is the one
    /// that its link describes.
    fn type_and_serial(&self) -> Option<(String, String)> {
        let Source::Link(url) = &self.session.source else { return None };
        let wire = if self.session.is_virtual() {
            self.session.place()
        } else {
            format!("{}:{}", url.scheme.word(), url.target)
        };
        Some(("link".to_owned(), wire))
    }

    fn edited(&self) -> Drafts {
        if !self.designer.is_dirty() {
            return Vec::new();
        }
        let document = Document { saved: None, ..Document::new(String::new(), Body::Ssi(self.wanted_profile())) };
        vec![document.emit()]
    }

    fn take_edits(&mut self, edits: Drafts) {
        let mut profiles = edits.iter().filter_map(|text| Document::parse(text).ok()?.body.into_ssi().ok());
        if let Some(profile) = profiles.next_back() {
            self.edit(Edit::Whole(Box::new(profile)));
        }
    }

    fn take_document(&mut self, path: PathBuf, key: String, document: Document) {
        let Body::Ssi(profile) = &document.body else { return };
        let before = self.designer.layout().clone();
        // What was done and undone stays, unless the file holds something else by now.
        if self.designer.is_dirty() || self.designer.design().profile == *profile {
            self.designer.saved_as(profile.clone());
        } else {
            self.designer.open(profile.clone());
        }
        self.follow_layout(&before);
        self.session.take_document(path, key, document);
    }

    fn written_beside(&mut self, document: Document) {
        if let Body::Ssi(profile) = document.body {
            self.designer.saved_as(profile);
        }
    }
}
